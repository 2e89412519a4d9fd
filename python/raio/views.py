"""Scene.view(): a live picture in a notebook, else the program's window."""

import functools
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import weakref
from typing import TYPE_CHECKING, Any

from ._annotations import split
from ._film import Image
from ._live import Live
from ._options import _text, settings, table

if TYPE_CHECKING:
    from ._scene import Scene


def view(scene: "Scene", options: dict[str, Any]) -> Any:
    """Scene.view(). In a notebook with anywidget: a LiveView; without it: an Image. Elsewhere: opens
    the window and returns None when it is closed; RuntimeError if there is none."""
    if annotations := split(options)[0]:
        raise TypeError(f"{next(iter(annotations))} is for render(); views have no annotations")
    settings(options)  # reports errors now
    if not _is_in_notebook():
        _open_window(scene, options)
        return None
    try:
        live_view = _live_view()
    except ImportError:
        wanted = {"size": (640, 480), "samples": 64, **options}
        return Image(scene._render(wanted, False))
    return live_view(scene, options)


def _is_in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None


_STYLE = """
.raio-view { position: relative; width: fit-content; max-width: 100%; line-height: 0; }
.raio-view canvas { max-width: 100%; height: auto; cursor: grab; touch-action: none; }
.raio-view canvas:active { cursor: grabbing; }
.raio-bar { position: absolute; left: 0; bottom: 0; height: 2px; background: #8888; }
.raio-text { position: absolute; left: 8px; bottom: 8px; max-width: calc(100% - 32px);
  padding: 2px 8px; border-radius: 4px; font: 12px/1.5 system-ui, sans-serif; color: #fff;
  background: #333c; pointer-events: none; }
.raio-text:empty { display: none; }
.raio-text.raio-error { background: #a00; pointer-events: auto; white-space: pre-wrap; }
"""


@functools.cache
def _live_view() -> Any:
    """The class of the widget; anywidget is imported only when it is needed."""
    import anywidget
    import traitlets

    class LiveView(anywidget.AnyWidget):  # type: ignore[misc, unused-ignore]
        """A live picture. Drag turns, the wheel zooms, right or shift-drag moves, a double click
        resets. close() ends it."""

        # As text: anywidget would watch a file, and keep all widgets alive for that.
        _esm = pathlib.Path(__file__).with_name("view.js").read_text(encoding="utf-8")
        _css = _STYLE
        _size = traitlets.Tuple((640, 480)).tag(sync=True)
        _still = traitlets.Bytes(b"").tag(sync=True)

        def __init__(self, scene: "Scene", options: dict[str, Any]):
            super().__init__()
            # The thread must not keep the widget alive.
            itself = weakref.ref(self)

            def send(message: dict[str, Any], buffers: list[bytes]) -> None:
                widget = itself()
                if widget is not None:
                    widget.send(message, buffers)

            self._live = Live(scene, options, send)
            # Also at the end of Python, which must not come while the library works.
            self._end = weakref.finalize(self, _finish, self._live)
            self.on_msg(_received)

        @property
        def camera(self) -> dict[str, Any]:
            """What is seen now: `scene.camera(**view.camera)` keeps it for other pictures."""
            seen = self._live.camera
            return {} if seen is None else seen.options()

        @property
        def image(self) -> Image | None:
            """The picture so far."""
            return None if self._live.film is None else Image(self._live.film)

        def refresh(self) -> None:
            """Renders again, after the scene was changed."""
            self._live.refresh()

        def close(self) -> None:
            if hasattr(self, "_live"):
                self._live.close()
            super().close()

        def _repr_mimebundle_(self, **more: Any) -> Any:
            # Notebooks without widgets (GitHub, nbconvert) show the still picture.
            if not self._still:
                self._still = self._live.still()
                self._size = self._live.size
            bundle = super()._repr_mimebundle_(**more)
            data, about = bundle if isinstance(bundle, tuple) else (bundle, {})
            return {**(data or {}), "image/png": self._still}, about

        def __repr__(self) -> str:
            width, height = self._live.size
            return f"<raio.LiveView of {width} x {height}>"

    return LiveView


def _received(widget: Any, message: dict[str, Any], buffers: Any) -> None:
    widget._live.receive(message)


def _finish(live: Live) -> None:
    live.close()
    live.join(1)


def _open_window(scene: "Scene", options: dict[str, Any]) -> None:
    program = _program()
    if program is None:
        raise RuntimeError(
            "view() needs a notebook, or the program raio with its window on PATH; "
            "render() makes pictures without either")
    if sys.platform.startswith("linux") and not (
            os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise RuntimeError(
            "view() needs a display, and neither DISPLAY nor WAYLAND_DISPLAY is set; use a "
            "notebook, or render() and Image.save()")
    wanted = scene._with_defaults(options)
    with tempfile.TemporaryDirectory(prefix="raio-") as folder:
        path = os.path.join(folder, "scene.raio")
        scene._core().write(path)  # the background is an argument
        done = subprocess.run([program, "view", path, *_arguments(wanted)])
    if done.returncode != 0:
        raise RuntimeError(f"{program} view ended with {done.returncode}; its messages are above")


def _program() -> str | None:
    """A program raio that has a window: beside Python, else on PATH."""
    beside = os.path.dirname(sys.executable)
    for where in (beside, None):
        found = shutil.which("raio", path=where)
        if found is not None and _has_window(found):
            return found
    return None


def _has_window(program: str) -> bool:
    try:
        told = subprocess.run([program, "--help"], capture_output=True, text=True, timeout=20)
    except (OSError, subprocess.SubprocessError):
        return False
    return any(line.split()[:1] == ["view"] for line in told.stdout.splitlines())


def _arguments(options: dict[str, Any]) -> list[str]:
    """Options as the command line has them."""
    arguments = []
    for keyword, value in options.items():
        option = table()[keyword]
        if value is None:
            continue
        words = _text(keyword, option, value)
        if option["type"] == "switch":
            arguments.append(f"--{option['name']}" if words == "true" else f"--no-{option['name']}")
        else:
            arguments.append(f"--{option['name']}={words}")
    return arguments
