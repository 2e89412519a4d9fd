"""Pictures that are rendered again and again for a front end, on a thread of their own."""

import struct
import threading
import time
import zlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _raio
from ._turntable import Camera

if TYPE_CHECKING:
    from ._scene import Scene

# Sends a message with binary buffers to the front end.
Send = Callable[[dict[str, Any], list[bytes]], None]

_FRAME_S = 0.06  # for a picture while it moves; its way to the screen takes some more
_PORTION_S = 0.08  # for the samples between two pictures that stand still: a gesture waits for it
_REST_S = 0.2  # without a gesture: the picture stands still
_LEAST_SCALE = 1 / 6


def png(pixels: npt.NDArray[np.uint8]) -> bytes:
    """(height, width, 4), compressed little but fast: Film.encode() takes twice as long."""
    height, width, _ = pixels.shape
    if (pixels[:, :, 3] == 255).all():
        pixels = pixels[:, :, :3]
    depth = pixels.shape[2]
    lines = np.empty((height, 1 + width * depth), np.uint8)
    lines[:, 0] = 2  # each line minus the one above
    lines[:, 1:] = pixels.reshape(height, -1)
    lines[1:, 1:] -= pixels[:-1].reshape(height - 1, -1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(
            ">I", zlib.crc32(data, zlib.crc32(kind)))

    header = struct.pack(">IIBBBBB", width, height, 8, 6 if depth == 4 else 2, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
            + chunk(b"IDAT", zlib.compress(lines.tobytes(), 1)) + chunk(b"IEND", b""))


class _Stale(Exception):
    """Nobody wants this picture any more."""


class Pace:
    """The scale of pictures that move, from the time that others took."""

    def __init__(self) -> None:
        self.scale = 0.5
        self._least = float("inf")  # the time of any picture, however small

    def measure(self, scale: float, seconds: float) -> None:
        # A part of the time may not depend on the size: smaller pictures would not be faster.
        if scale <= 0.25:
            self._least = min(self._least, seconds)
        if seconds > 1.1 * _FRAME_S or (seconds < 0.8 * _FRAME_S and scale < 1):
            wanted = scale * min(2.0, max(0.4, (_FRAME_S / seconds) ** 0.5))
            floor = 0.25 if self._least > _FRAME_S and self._least != float("inf") else _LEAST_SCALE
            self.scale = min(1.0, max(floor, wanted))


class Live:
    """The pictures of a scene for one front end, which sends gestures and acknowledges frames.

    Messages in: {"type": "hello"}, {"type": "ack", "frame", "gestures"}, {"type": "turn" or "pan", "dx", "dy",
    "height"}, {"type": "zoom", "x", "y", "steps"}, {"type": "reset"}. Out: {"type": "frame",
    "frame", "samples", "of", "moving"} with a PNG, {"type": "stage", "text"} and {"type": "error",
    "text"}. Without acknowledgements nothing is rendered: front ends that are gone cost nothing.
    """

    def __init__(self, scene: "Scene", options: dict[str, Any], send: Send):
        self._scene = scene
        self._options = {name: value for name, value in options.items() if value is not None}
        aa = int(self._options.pop("aa", 8))
        self.samples = int(self._options.pop("samples", aa * aa))
        asked = ("size", "width", "dpi")
        self._asked_size: dict[str, Any] = {
            name: self._options.pop(name) for name in asked if name in self._options}
        self._asked_size = self._asked_size or {"size": (640, 480)}
        self.size = 640, 480  # until there is a picture
        self._send = send
        self._news = threading.Condition()
        self._gestures: list[dict[str, Any]] = []
        self._last_gesture = float("-inf")
        self._portion = 1  # samples between two pictures
        self._is_greeted = self._is_greeted_again = False
        self._sent = self._acknowledged = 0
        self._closed = False
        self._is_again = False  # render from the first sample on
        self._thread: threading.Thread | None = None
        self._pace = Pace()
        self._core: Any = None  # the scene as it was rendered
        self._home: Camera | None = None
        self.camera: Camera | None = None
        self.film: _raio.Film | None = None  # of the full size

    # --- from the kernel's main thread; all return at once

    def receive(self, message: dict[str, Any]) -> None:
        """A message of the front end."""
        kind = message.get("type")
        with self._news:
            if kind == "ack":
                self._acknowledged = max(self._acknowledged, int(message.get("frame", 0)))
                if gestures := message.get("gestures"):
                    self._gestures += gestures
                    self._last_gesture = time.monotonic()
            elif kind == "hello":
                self._is_greeted = self._is_greeted_again = True
                self._acknowledged = self._sent
            elif kind in ("turn", "pan", "zoom", "reset"):
                self._gestures.append(message)
                self._last_gesture = time.monotonic()
            self._news.notify_all()
            if self._thread is None and self._is_greeted and not self._closed:
                self._thread = threading.Thread(target=self._work, name="raio view", daemon=True)
                self._thread.start()

    def refresh(self) -> None:
        """Renders again: the scene has changed."""
        with self._news:
            self._is_again = True
            self._news.notify_all()

    def close(self) -> None:
        """Ends the thread soon."""
        with self._news:
            self._closed = True
            self._news.notify_all()

    def join(self, timeout: float | None = None) -> bool:
        """Waits for the thread's end; whether it came."""
        thread = self._thread
        if thread is None or thread is threading.current_thread():
            return True
        thread.join(timeout)
        return not thread.is_alive()

    def still(self, seconds: float = 0.3) -> bytes:
        """A first picture, which need not be complete, for notebooks that are shown without Python.

        Called before the front end's first message. Ctrl-C stops.
        """
        end = time.monotonic() + seconds
        while self.film is None or (self.film.samples()[0] < self.samples
                                    and time.monotonic() < end):
            self._refine(1, None)
        return png(self.film.display())

    # --- on the thread

    def _work(self) -> None:
        is_failed = False
        while True:
            with self._news:
                while not (self._closed or self._gestures or self._is_again
                           or self._is_greeted_again or (not is_failed and self._has_work())):
                    self._news.wait()
                if self._closed:
                    return
                gestures, self._gestures = self._gestures, []
                if self._is_again:
                    self._is_again, self.film = False, None
                greets, self._is_greeted_again = self._is_greeted_again, False
            try:
                is_failed = False
                self._follow_scene()
                if greets:
                    self._show()
                for gesture in gestures:
                    self._apply(gesture)
                if self.camera is not None and self._is_moving():
                    self._move() if gestures else self._rest()
                elif not self._is_complete():
                    self._still()
            except _Stale:
                pass
            except BaseException as error:  # the front end shows it, the thread lives on
                is_failed = True
                self._tell({"type": "error", "text": f"{type(error).__name__}: {error}"}, [])

    def _follow_scene(self) -> None:
        """Drops what is of the scene before it changed."""
        core = self._scene._core()
        if core is self._core:
            return
        self._core, self.film = core, None
        if not self._is_turned():
            self._home = self.camera = None

    def _is_complete(self) -> bool:
        return self.film is not None and self.film.samples()[0] >= self.samples

    def _has_work(self) -> bool:
        return self._sent == self._acknowledged and not self._is_complete()

    def _is_moving(self) -> bool:
        return time.monotonic() < self._last_gesture + _REST_S

    def _rest(self) -> None:
        with self._news:
            self._news.wait_for(lambda: self._closed or self._gestures,
                                max(0.0, self._last_gesture + _REST_S - time.monotonic()))

    def _check(self, stage: str, share: float) -> None:
        if self._closed or self._gestures or self._is_again:
            raise _Stale
        self._report(stage, share)

    def _report(self, stage: str, share: float) -> None:
        if self._closed:
            raise _Stale
        if self.film is None and self.camera is None:
            self._tell({"type": "stage", "text": f"{stage} {share:.0%}"}, [])

    def _render(self, size: dict[str, Any], samples: int, begun: _raio.Film | None,
                progress: Any) -> _raio.Film:
        camera: dict[str, Any] = {}
        if self.camera is not None and self._is_turned():
            camera = {"fit": None, **self.camera.options()}
        wanted = {**self._options, **camera, **size, "samples": samples}
        return self._scene._render(wanted, progress or False, begun=begun)

    def _is_turned(self) -> bool:
        return self.camera is not self._home

    def _refine(self, samples: int, progress: Any) -> None:
        self._follow_scene()
        done = 0 if self.film is None else int(self.film.samples()[0])
        # A render that is cancelled leaves the film that it began with.
        samples = min(self.samples, done + samples)
        film = self._render(self._asked_size, samples, self.film, progress)
        width, height = film.size()
        self.film, self.size = film, (width, height)
        if self._home is None:
            self._home = self.camera = self._fitted(film)

    def _fitted(self, film: _raio.Film) -> Camera:
        """The camera of a picture: the scene's, with what the options and the shape change."""
        used = film.settings()
        from_, at, up, _, is_parallel = self._scene._core().camera()
        numbers = [np.array([float(v) for v in text.split(",")]) if text else np.array(own, float)
                   for text, own in ((used.get("from"), from_), (used.get("at"), at),
                                     (used.get("up"), up))]
        projection = used.get("projection")
        return Camera(numbers[0], numbers[1], numbers[2], float(used.get("fov")),
                      projection == "orthographic" if projection else bool(is_parallel))

    def _pivot(self) -> npt.NDArray[np.float64]:
        box = self._scene._core().bounds()
        assert self.camera is not None
        return self.camera.at if box is None else (np.array(box[0], float) + box[1]) / 2

    def _apply(self, gesture: dict[str, Any]) -> None:
        if self.camera is None or self._home is None:
            return
        kind = gesture["type"]
        if kind == "reset":
            moved = self._home
            self._last_gesture = float("-inf")
        elif kind == "zoom":
            moved = self.camera.zoomed(self._under(float(gesture["x"]), float(gesture["y"])),
                                       float(gesture["steps"]))
        else:
            move = self.camera.turned if kind == "turn" else self.camera.panned
            moved = move(self._pivot(), float(gesture["dx"]), float(gesture["dy"]),
                         max(1.0, float(gesture["height"])))
        if all(np.isfinite(v).all() for v in (moved.from_, moved.at)):
            self.camera, self.film = moved, None

    def _under(self, x: float, y: float) -> npt.NDArray[np.float64]:
        """The point under the mouse; where nothing is hit, one as far as that looked at."""
        assert self.camera is not None
        start, direction = self.camera.ray(x, y, self.size[0] / self.size[1])
        accel, _ = self._scene._accel(self._options, None)
        hit = accel.closest(np.array([start], np.float32), np.array([direction], np.float32), None,
                            True)
        if hit["distance"][0] < np.inf:
            return np.array(hit["position"][0], float)
        return start + direction

    def _move(self) -> None:
        """One picture while the mouse moves. Newer gestures do not stop it: others would never
        finish."""
        begin = time.monotonic()
        scale = self._pace.scale
        size = (max(1, round(self.size[0] * scale)), max(1, round(self.size[1] * scale)))
        pixels = png(self._render({"size": size}, 1, None, self._report).display())
        self._pace.measure(scale, time.monotonic() - begin)
        self._post(pixels, 1, True)

    def _still(self) -> None:
        """Some more samples of the picture that stands still."""
        done = 0 if self.film is None else int(self.film.samples()[0])
        part = self._portion if done else 1
        begin = time.monotonic()
        self._refine(part, self._check)
        seconds = time.monotonic() - begin
        self._portion = max(1, min(16, round(part * _PORTION_S / max(seconds, 1e-3))))
        if not self._gestures:
            self._show()

    def _show(self) -> None:
        if self.film is not None:
            self._post(png(self.film.display()), int(self.film.samples()[0]), False)

    def _post(self, picture: bytes, samples: int, moving: bool) -> None:
        """Sends a frame as soon as the one before has arrived."""
        with self._news:
            self._news.wait_for(lambda: self._closed or self._acknowledged >= self._sent)
            if self._closed:
                return
            self._sent += 1
            frame = self._sent
        self._tell({"type": "frame", "frame": frame, "samples": samples, "of": self.samples,
                    "moving": moving}, [picture])

    def _tell(self, message: dict[str, Any], buffers: list[bytes]) -> None:
        if not self._closed:
            self._send(message, buffers)
