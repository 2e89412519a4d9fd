"""Videos and sequences of pictures."""

import os
import shutil
import subprocess
import tempfile
import warnings
from collections.abc import Callable, Iterable, Sized
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ._film import Image, Path as AnyPath
from ._progress import Progress, Reporter
from ._scene import Scene

if TYPE_CHECKING:
    from ._render_options import RenderOptions

Frame = Scene | Image

# Of each suffix: H.264 and VP9 with a quality at which no loss is seen.
_CODECS = {".mp4": ("-c:v", "libx264", "-crf", "17", "-movflags", "+faststart"),
           ".webm": ("-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0")}


def movie(frames: Iterable[Frame] | Callable[[int], Frame], path: AnyPath, fps: float = 30, *,
          count: int | None = None, progress: Progress = False,
          **options: "Unpack[RenderOptions]") -> list[Path]:
    """Renders frames and writes a video, or a numbered sequence of pictures.

    frames: Scenes, which are rendered with the options of Scene.render(), or finished Images; or a
    function of the index, from 0, with `count`. A generator is advanced after each frame, so it may
    change one scene and yield it again. path: .mp4 or .webm, which need the program ffmpeg; or a
    pattern such as "out/frame-{:04d}.png", with any suffix of Image.save(). fps: frames per second of
    the video. progress: as for Scene.render(), of all frames.

    All frames must have the same size, for video without transparency; an odd width or height gets a
    further row or column of the border's colour, with a warning. Files of the same names are
    replaced when all frames are finished; after an error or Ctrl-C they are unchanged. Returns the
    paths written.

    Raises ValueError, and RuntimeError if ffmpeg is missing or fails.
    """
    target = os.fspath(path)
    suffix = Path(target).suffix.lower()
    is_video = suffix in _CODECS
    if not is_video:
        check_pattern(target, ".mp4, .webm, or ")
    if not fps > 0:
        raise ValueError(f"fps: expected a number above 0, found {fps}")
    program = shutil.which("ffmpeg") if is_video else None
    if is_video and program is None:
        raise RuntimeError(
            "a video needs the program ffmpeg, which is not installed (apt install ffmpeg, brew "
            "install ffmpeg, conda install ffmpeg); or write pictures, to frame-{:04d}.png")
    if callable(frames):
        if count is None:
            raise ValueError("count: expected the number of frames, since frames is a function")
        make = frames
        frames = (make(index) for index in range(count))
    elif count is None and isinstance(frames, Sized):
        count = len(frames)
    folder = Path(target).absolute().parent
    folder.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        # In the same folder, so that a finished file can be moved to its place at once.
        draft = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix=".movie-", dir=folder)))
        reporter = stack.enter_context(Reporter(progress))
        video = stack.enter_context(_Video(program, draft / f"video{suffix}", suffix, fps)) \
            if program else None
        drafts, size = [], None
        for index, frame in enumerate(frames):
            if count is not None and index >= count:
                break
            image = frame.render(**options) if isinstance(frame, Scene) else frame
            if not isinstance(image, Image):
                raise TypeError(f"frame {index}: expected a Scene or an Image, found "
                                f"{type(frame).__name__}")
            if size not in (None, image.size):
                raise ValueError(f"frame {index} has the size {image.size}, the others {size}")
            size = image.size
            if video:
                video.add(image, index)
            else:
                drafts.append((draft / f"{index}{suffix}", Path(target.format(index))))
                image.save(drafts[-1][0])
            if reporter.report and count:
                reporter.report("frames", (index + 1) / count, 0)
        if size is None:
            raise ValueError("frames: expected at least one")
        if video:
            drafts.append((video.finish(), Path(target)))
        for made, final in drafts:
            final.parent.mkdir(parents=True, exist_ok=True)
            os.replace(made, final)
    return [final for _, final in drafts]


def check_pattern(path: str, or_else: str = "") -> None:
    """Raises ValueError if the path is not a pattern of the frame's number; `or_else` tells what else is possible."""
    expected = f"path: expected {or_else}a pattern such as frame-{{:04d}}.png; found {path!r}"
    if "{" not in path:
        raise ValueError(expected)
    try:
        names = path.format(0), path.format(1)
    except (IndexError, KeyError, ValueError):
        raise ValueError(expected) from None
    if names[0] == names[1]:
        raise ValueError(f"path: {path!r} has the same name for all frames")


class _Video:
    """ffmpeg, which is stopped on exit."""

    def __init__(self, program: str, path: Path, suffix: str, fps: float):
        self._program, self._path, self._suffix, self._fps = program, path, suffix, fps
        self._process: subprocess.Popen[bytes] | None = None
        self._messages: Any = None

    def __enter__(self) -> "_Video":
        return self

    def add(self, image: Image, index: int) -> None:
        pixels = image.display()
        if (pixels[..., 3] < 255).any():
            raise ValueError(f"frame {index} is transparent; give the frames a background")
        if self._process is None:
            self._start(image.size)
        assert self._process and self._process.stdin
        try:
            self._process.stdin.write(pixels[..., :3].tobytes())
        except BrokenPipeError:
            self._fail()

    def _start(self, size: tuple[int, int]) -> None:
        width, height = size
        filters = []
        if width % 2 or height % 2:
            warnings.warn(f"videos have even sizes; {width} x {height} becomes "
                          f"{width + width % 2} x {height + height % 2}", stacklevel=4)
            # Repeats the last column and row.
            filters.append(f"pad={width + width % 2}:{height + height % 2}")
            filters.append(f"fillborders=right={width % 2}:bottom={height % 2}:mode=smear")
        filters.append("scale=out_color_matrix=bt709:out_range=tv")
        self._messages = tempfile.TemporaryFile()
        # A group of its own: Ctrl-C reaches only Python, which then stops ffmpeg.
        self._process = subprocess.Popen(
            [self._program, "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
             "-s", f"{width}x{height}", "-r", repr(float(self._fps)), "-i", "-",
             "-vf", ",".join(filters), *_CODECS[self._suffix], "-pix_fmt", "yuv420p",
             "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1",
             "-y", str(self._path)],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._messages,
            start_new_session=True)

    def finish(self) -> Path:
        assert self._process and self._process.stdin
        try:
            self._process.stdin.close()
        except BrokenPipeError:
            self._fail()
        if self._process.wait() != 0:
            self._fail()
        return self._path

    def _fail(self) -> None:
        assert self._process
        self._process.wait()
        self._messages.seek(0)
        lines = self._messages.read().decode(errors="replace").strip().splitlines()
        raise RuntimeError(f"ffmpeg failed: {lines[-1] if lines else self._process.returncode}")

    def __exit__(self, *_: object) -> None:
        if self._process is not None:
            if self._process.poll() is None:
                self._process.kill()
                self._process.wait()
            try:
                if self._process.stdin:
                    self._process.stdin.close()
            except BrokenPipeError:
                pass
            self._messages.close()
