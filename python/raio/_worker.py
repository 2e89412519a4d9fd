"""What workers of raio.distribute do. They may have another version of this package: see checked()."""

import os
import pickle
import sys
import threading
import time
import warnings
from collections import OrderedDict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import dask
from distributed import get_worker

from . import _raio

DEFAULT_CACHE = "1 GiB"


class Cancelled(Exception):
    """Nobody waits for this task any more."""


def checked(version: str, work: str, arguments: bytes, data: bytes | None = None) -> Any:
    """Does this work, if the client has the version of this package.

    Args:
        arguments: of the work, pickled.
        data: of a portion's scene.

    Raises:
        RuntimeError: it has another.
    """
    if version != _raio.version():
        raise RuntimeError(f"the client has raio {version}, but the worker {get_worker().name} has raio "
                           f"{_raio.version()}; install the same version on both")
    if work == "portion":
        return portion(data, *pickle.loads(arguments))
    return frame(*pickle.loads(arguments))


def _stop_if_cancelled() -> Callable[..., None]:
    """A function that raises Cancelled once the scheduler has withdrawn this task."""
    worker = get_worker()
    key = worker.get_current_task()

    def check(*_: object) -> None:
        task = worker.state.tasks.get(key)
        if task is None or task.state in ("cancelled", "resumed"):
            raise Cancelled

    return check


_limiting = threading.Lock()


@contextmanager
def _memory_limit() -> Iterator[None]:
    """What is left to the worker's limit, which its nanny enforces by killing it, as a limit of this process.

    The library asks for it before it allocates much. Only on Linux, and for one thread at a time.
    """
    limit = get_worker().memory_manager.memory_limit
    if not limit or not sys.platform.startswith("linux"):
        yield
        return
    import resource

    with open("/proc/self/statm") as file:
        pages = [int(number) for number in file.read().split()]
    resident, data = (count * resource.getpagesize() for count in (pages[1], pages[5]))
    kind = resource.RLIMIT_DATA
    before = resource.getrlimit(kind)
    # Dask kills at 95 % of the limit.
    soft = data + max(int(0.9 * limit) - resident, 0)
    if before[0] != resource.RLIM_INFINITY:
        soft = min(soft, before[0])
    resource.setrlimit(kind, (soft, before[1]))
    try:
        yield
    except MemoryError as error:
        raise MemoryError(f"the scene does not fit into the worker {get_worker().name}, whose memory limit is "
                          f"{dask.utils.format_bytes(limit)} ({error}); give workers more memory") from None
    finally:
        resource.setrlimit(kind, before)


class _Structures:
    """Scenes with their structures, which the tasks of a worker share; the newest stay."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._held: OrderedDict[Any, dict[str, Any]] = OrderedDict()

    def get(self, key: Any, make: Callable[[], tuple[_raio.Accel, int]]) -> _raio.Accel:
        """That of this key; tasks that ask for it while it is made wait."""
        with self._lock:
            entry = self._held.setdefault(key, {"lock": threading.Lock(), "bytes": 0})
            self._held.move_to_end(key)
        with entry["lock"]:
            if "accel" not in entry:
                try:
                    with _limiting, _memory_limit():
                        entry["accel"], entry["bytes"] = make()
                except BaseException:
                    with self._lock:
                        self._held.pop(key, None)
                    raise
        most = dask.utils.parse_bytes(dask.config.get("raio.scene-cache", DEFAULT_CACHE))
        with self._lock:
            while len(self._held) > 1 and sum(e["bytes"] for e in self._held.values()) > most:
                self._held.popitem(last=False)
        accel: _raio.Accel = entry["accel"]
        return accel


_structures = _Structures()


def _settings(texts: dict[str, str]) -> _raio.Settings:
    settings = _raio.Settings()
    for name, text in texts.items():
        settings.set(name, text)
    return settings


def _check_sky(core: _raio.Scene, has_background: bool) -> None:
    """Scenes that travelled as bytes may have lost their sky, which stays in files of its own."""
    if core.warnings() and not has_background:
        raise ValueError("the scene's sky is in files of its own, which do not travel with the scene; give the path "
                         "of the scene's file instead, or a background")


def _check_is_there(path: str | os.PathLike[str]) -> None:
    if not os.path.exists(path):
        where = "" if os.path.isabs(path) else f" in {os.getcwd()}"
        raise FileNotFoundError(f"the worker {get_worker().name} has no file {os.fspath(path)}{where}; put it where "
                                "all workers find it, or load it first: raio.load()")


def portion(data: bytes | None, source: tuple[Any, ...], structure: dict[str, str], texts: dict[str, str],
            shard: int, shards: int, first: int, end: int) -> tuple[bytes, float]:
    """Renders a portion of a picture: the bytes of a part, and the seconds for its samples.

    Args:
        data: of a scene without a file.
        source: a key of the scene; for a file, its path and the options for reading it follow.
        structure: the settings of the structure.
        texts: the settings of the picture.
    """
    check = _stop_if_cancelled()
    threads = str(get_worker().state.nthreads)

    def make() -> tuple[_raio.Accel, int]:
        if data is None:
            _, path, read = source
            for file in path, dict(read).get("environment", path):
                _check_is_there(file)
            core = _raio.Scene.read(path, _settings({**dict(read), "threads": threads}))
        else:
            core = _raio.Scene.from_bytes(data)
            _check_sky(core, "background" in texts)
        accel = _raio.Accel(core, _settings({**structure, "threads": threads}))
        size = accel.info()["bytes"] + (len(data) if data is not None else os.path.getsize(source[1]))
        return accel, size

    accel = _structures.get((source, tuple(sorted(structure.items()))), make)
    check()
    settings = _settings({**texts, "threads": "1", "sample-range": f"{first}:{end}"})
    if shards > 1:
        settings.set("shard", f"{shard + 1}/{shards}")
    begin = time.perf_counter()
    film = _raio.render(accel, settings, None, check)
    return film.to_bytes(), time.perf_counter() - begin


# A worker makes one frame at a time, on all its threads: warnings are recorded for the process, and few functions
# that read data may run in two threads.
_framing = threading.Lock()


def frame(make: Any, index: int, options: dict[str, Any], suffix: str) -> tuple[bytes, list[str]]:
    """Renders a picture: the bytes of its file, and what was reported meanwhile.

    Args:
        make: a scene, the path of a file, or a function of the index that returns one of these or an image.
    """
    with _framing:
        return _frame(make, index, options, suffix)


def _frame(make: Any, index: int, options: dict[str, Any], suffix: str) -> tuple[bytes, list[str]]:
    from ._files import render
    from ._film import Image
    from ._options import split
    from ._scene import Scene

    check = _stop_if_cancelled()
    check()
    with warnings.catch_warnings(record=True) as reported:
        warnings.simplefilter("always")
        made = make(index) if callable(make) else make
        read, others = split(options)
        if read and not isinstance(made, (str, os.PathLike)):
            raise TypeError(f"{next(iter(read))} is an option for reading a file, but the frame is no path")
        others["threads"] = get_worker().state.nthreads
        if isinstance(made, (str, os.PathLike)):
            _check_is_there(made)
            made = render(made, progress=check, **read, **others)
        elif isinstance(made, Scene):
            if made is make and made._base is not None:
                _check_sky(made._base, not (made._background is None and others.get("background") is None))
            made = made.render(progress=check, **others)
    if not isinstance(made, Image):
        raise TypeError(f"expected a Scene, an Image or the path of a scene file, found {type(made).__name__}")
    return made._film.encode(suffix), [str(w.message) for w in reported]
