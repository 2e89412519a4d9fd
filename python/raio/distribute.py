"""Pictures and movies on many machines, by the workers of dask.distributed (`pip install distributed`).

The bytes are those of one process, for any workers, in any order, and whatever is lost on the way.
"""

import json
import os
import re
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Unpack

try:
    import cloudpickle
    import distributed
except ImportError as error:
    raise ImportError("raio.distribute needs dask.distributed: pip install distributed") from error

from . import _raio
from ._annotations import Annotations, split as split_annotations
from ._arrays import number
from ._files import load
from ._film import Image, Path as AnyPath
from ._options import settings, split as split_read, table, texts
from ._portions import Portion, Portions
from ._progress import Progress, Reporter
from ._render_options import FileOptions
from ._scene import Scene, SceneWarning, structure_options
from ._tasks import Killed, Lost, Tasks, key_of
from .movies import check_pattern

Frame = Scene | AnyPath
Preview = bool | AnyPath | Callable[[Image], None]

# A scheduler with 1,000 workers needs about 3 ms for a task (bench/distribute_scaling.py).
_TASKS_PER_S = 250


def render(scene: Scene | AnyPath, *, client: distributed.Client | None = None, progress: Progress = False,
           preview: Preview = False, task_seconds: float | None = None, **options: Unpack[FileOptions]) -> Image:
    """Renders a picture on all workers of a cluster: the bytes of Scene.render().

    Each worker gets the scene once and builds its structure once. The picture is rendered in passes of more and
    more samples, and each pass in portions. Work that is lost with a worker is done again by another. Ctrl-C
    stops the workers within a second.

    Args:
        scene: a Scene, which travels to the workers; or the path of a file, which the workers read themselves.
        client: of a cluster: LocalCluster, SLURMCluster, KubeCluster; None: the current one.
        progress: as for Scene.render(), over all workers.
        preview: True shows the picture in a notebook while it refines; or a path, whose file is replaced every few
            seconds; or a function of the picture so far.
        task_seconds: the longest portion; None: 4, and more from 1,000 cores on.
        options: of Scene.render(), and of raio.load() for a file. `checkpoint` names a file that this process
            writes every `checkpoint_interval` seconds, and at the end; with `resume`, it continues from there.

    Raises:
        ValueError, TypeError: an argument does not fit, or there is no client.
        RuntimeError: a worker has no raio, or another version.
        MemoryError: the scene does not fit into a worker's memory limit, or workers ended again and again.
        ConnectionError: the scheduler is gone.

    Examples:
        >>> import raio
        >>> from dask.distributed import Client
        >>> client = Client(processes=False, dashboard_address=":0")
        >>> scene = raio.Scene()
        >>> ball = scene.spheres([[0, 0, 0]], 1)
        >>> raio.distribute.render(scene, client=client, size=(64, 48))
        <raio.Image of 64 x 48>
        >>> client.shutdown()
    """
    if task_seconds is not None and not number("task_seconds", task_seconds) > 0:
        raise ValueError(f"task_seconds: expected a number above 0, found {task_seconds}")
    picture = _Picture(scene, dict(options), preview)
    with Reporter(progress) as reporter, Tasks(client, f"raio-portion-{os.urandom(8).hex()}") as tasks:
        try:
            picture.run(tasks, reporter, task_seconds)
        finally:
            picture.keep()
    return Image(picture.film)


class _Picture:
    """A picture that workers render."""

    def __init__(self, scene: Scene | AnyPath, options: dict[str, Any], preview: Preview):
        read, others = split_read(options)
        if not isinstance(scene, (Scene, str, os.PathLike)):
            raise TypeError(f"scene: expected a Scene or the path of a scene file, found {scene!r}")
        if isinstance(scene, Scene) and read:
            raise TypeError(f"{next(iter(read))} is an option for reading a file")
        own = _own(others)
        self._checkpoint = texts(own).get("checkpoint", "")
        self._interval_s = float(own.get("checkpoint_interval", 60))
        marks, others = split_annotations(others)
        self._shown = _Shown(preview)
        settings(others)  # reports errors before a file is read
        self._data: bytes | None = None
        self._source: tuple[Any, ...]
        if isinstance(scene, Scene):
            core = scene._core()
            self._data = core.to_bytes()
            self._source = (key_of(self._data),)
        else:
            path, read = os.path.abspath(scene), _found_by_all(read)
            scene = load(path, **read)
            core, reader = scene._core(), tuple(texts(read).items())
            self._source = (key_of(reader, *_files(path, read)), path, reader)
        annotations = Annotations(scene, marks)
        wanted = scene._with_defaults(others)
        self.film = _raio.begin(core, settings(wanted))
        missing = self.film.missing(0, 1)
        samples = missing[0][1] if missing else 0
        if own:
            self.film = _raio.begin(core, settings({**wanted, **own}))  # with what the checkpoint has
        if annotations:
            annotations.put_on(self.film)
        self._portions = Portions(self.film, samples)
        self._structure, self._texts = texts(structure_options(wanted)), self._settings()
        self._on_workers: Any = None
        self._kept_at = time.monotonic()
        self._is_kept = True

    def _settings(self) -> dict[str, str]:
        known, all_settings = table().values(), self.film.settings()
        values = {o["name"]: all_settings.get(o["name"]) for o in known if not o["of_reader"]}
        values["background"] = _absolute(values["background"])
        return {name: value for name, value in values.items()
                if value and name not in ("threads", "shard", "sample-range")}

    def run(self, tasks: Tasks, reporter: Reporter, longest_s: float | None) -> None:
        while self._portions or len(tasks) > 0:
            cores = tasks.cores()
            while self._portions and len(tasks) < tasks.enough():
                portion = self._portions.take(max(cores, 1), longest_s or max(4, cores / _TASKS_PER_S))
                tasks.submit(portion, "portion", self._source, self._structure, self._texts, *portion,
                             data=self._scene_data(tasks))
            for portion, result in tasks.ended(0.2):
                self._take(portion, result)
            if reporter.report:
                stage = "rendering" if cores else "waiting for workers"
                reporter.report(stage, 1 - self._portions.left / self._portions.all, 0)
            self._shown.update(self.film)
            if time.monotonic() - self._kept_at > self._interval_s:
                self.keep()
        self._shown.update(self.film, is_last=True)

    def _scene_data(self, tasks: Tasks) -> Any:
        """The scene's bytes as data of the cluster, to which they travel again if all holders are lost."""
        if self._data is None:
            return None
        if self._on_workers is None or self._on_workers.status not in ("pending", "finished"):
            self._on_workers = tasks.data(self._data)
        return self._on_workers

    def _take(self, portion: Portion, result: Any) -> None:
        if isinstance(result, Lost):
            self._portions.put_back(portion)
        elif isinstance(result, Killed):
            if portion.end - portion.first == 1 or not self._portions.halve(portion):
                raise MemoryError(str(result))
        elif isinstance(result, BaseException):
            raise result
        else:
            part, seconds = result
            begin = time.perf_counter()
            try:
                self.film.add(part)
            except ValueError as error:
                raise ValueError(f"a worker's part does not fit: {error}. Do all machines see the same files?") \
                    from None
            self._portions.done(portion, seconds, time.perf_counter() - begin)
            self._is_kept = False

    def keep(self) -> None:
        """Writes the checkpoint. A failure does not stop the work."""
        if not self._checkpoint or self._is_kept:
            return
        begin = time.monotonic()
        try:
            self.film.write(self._checkpoint)
            self._is_kept = True
        except OSError as error:
            warnings.warn(f"the checkpoint is not written: {error}", RuntimeWarning, stacklevel=4)
        self._kept_at = time.monotonic()
        self._interval_s = max(self._interval_s, 10 * (self._kept_at - begin))


def _absolute(background: Any) -> Any:
    """The folder or file of a background, as all workers find it."""
    is_path = isinstance(background, (str, os.PathLike)) and os.path.exists(background)
    return os.path.abspath(background) if is_path else background


def _found_by_all(options: dict[str, Any]) -> dict[str, Any]:
    """The options, with paths that all workers find."""
    return {name: _absolute(value) if name in ("background", "environment") else value
            for name, value in options.items()}


def _files(path: AnyPath, read: dict[str, Any]) -> list[Any]:
    """The files that are read for a scene, and what changes with their contents."""
    found: list[Any] = []
    for file in (path, read.get("environment")):
        if file is not None:
            stat = os.stat(file)
            found += os.path.abspath(file), stat.st_size, stat.st_mtime_ns
    return found


def _own(options: dict[str, Any]) -> dict[str, Any]:
    """Removes and returns the options of this process: checkpoint, its interval, resume; those that are not None."""
    for name, why in (("threads", "the workers have as many threads as the cluster gave them"),
                      ("shard", "workers share the whole picture"), ("sample_range", "workers share all samples"),
                      ("noise", "workers share the samples of all pixels; use Scene.render() with shard"),
                      ("time_limit", "use Scene.render()")):
        if options.pop(name, None) is not None:
            raise TypeError(f"{name} is not for raio.distribute: {why}")
    names = ("checkpoint", "resume", "checkpoint_interval")
    given = {name: options.pop(name, None) for name in names}
    own = {name: value for name, value in given.items() if value is not None and value is not False}
    settings(own)  # reports errors
    checkpoint = texts(own).get("checkpoint")
    if own and checkpoint is None:
        raise TypeError(f"{next(iter(own))} has no effect without checkpoint")
    if checkpoint is not None and not checkpoint.endswith(".raio"):
        raise ValueError(f"checkpoint: expected a name that ends in .raio, found {checkpoint!r}")
    return own


class _Shown:
    """The picture so far, where somebody looks at it."""

    PAUSE_S = 2.0

    def __init__(self, preview: Preview):
        self._show: Callable[[Image], Any] | None = None
        if callable(preview):
            self._show = preview
        elif preview is True:
            self._show = _in_notebook()
        elif isinstance(preview, (str, os.PathLike)):
            path = Path(preview)
            suffix = path.suffix.lower()
            if suffix not in (".png", ".ppm"):
                raise ValueError(f"preview: expected a name that ends in .png or .ppm, found {str(path)!r}")
            if not os.access(path.parent, os.W_OK):
                raise OSError(f"preview: the folder {path.parent} is missing or cannot be written")
            self._show = lambda image: _replace(path, image._film.encode(suffix))
        elif preview not in (None, False):
            raise TypeError(f"preview: expected True, False, a path or a function, found {preview!r}")
        self._next = time.monotonic() + self.PAUSE_S

    def update(self, film: _raio.Film, is_last: bool = False) -> None:
        """Shows it, if enough time has passed that showing takes little of it."""
        begin = time.monotonic()
        if self._show and (is_last or begin > self._next):
            self._show(Image(film))
            end = time.monotonic()
            self._next = end + max(self.PAUSE_S, 10 * (end - begin))


def _in_notebook() -> Callable[[Image], None]:
    try:
        from IPython import get_ipython
        from IPython.display import display
    except ImportError:
        get_ipython = lambda: None  # noqa: E731
    if get_ipython() is None:
        raise ValueError("preview=True needs a notebook; elsewhere, give a path or a function")
    handle: list[Any] = []

    def show(image: Image) -> None:
        if handle:
            handle[0].update(image)
        else:
            handle.append(display(image, display_id=True))

    return show


def _replace(path: Path, data: bytes) -> None:
    """Writes the file whole, or not at all."""
    draft = path.with_name(f".raio-{os.urandom(8).hex()}.tmp")
    try:
        draft.write_bytes(data)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def animate(frames: Sequence[Frame] | Callable[[int], Frame], path: AnyPath, *,
            client: distributed.Client | None = None, count: int | None = None, progress: Progress = False,
            **options: Unpack[FileOptions]) -> list[Path]:
    """Renders frames on all workers of a cluster, each as one task, and writes a numbered sequence of pictures.

    A frame is written as soon as it is finished. A second call, after Ctrl-C or an error for instance, renders
    what is missing, and the frames whose scenes or files have changed since: a file beside the pictures, with
    `all` instead of the number and the suffix .json, records how they were made. A changed function is not
    noticed: a warning tells how many pictures are kept.

    Args:
        frames: scenes, or paths of files, which the workers read themselves; or a function of the index, from 0,
            that returns one of these, or an Image, for which the options do not count. It runs on the workers, so
            it should read its data there; in each worker one frame is made at a time, on all its threads.
        path: a pattern such as "out/frame-{:04d}.png", with any suffix of Image.save() but .raio.
        client: of a cluster; None: the current one.
        count: the number of frames, if `frames` is a function.
        progress: as for Scene.render(), of all frames.
        options: of Scene.render(), and of raio.load() for files.

    Returns:
        The paths of all frames.

    Raises:
        ValueError, TypeError: an argument does not fit, there is no client, or the pictures that exist were made
            with other options.
        RuntimeError, MemoryError, ConnectionError: as for render().

    Examples:
        >>> import raio
        >>> def frame(i):
        ...     scene = raio.Scene()
        ...     scene.spheres([[0, 0, 0], [1 + i, 0, 0]], 1)
        ...     return scene
        >>> raio.distribute.animate(frame, "out/frame-{:04d}.png", client=client, count=100)  # doctest: +SKIP
    """
    movie = _Movie(frames, os.fspath(path), count, dict(options))
    with Reporter(progress) as reporter, Tasks(client, f"raio-frame-{os.urandom(8).hex()}") as tasks:
        movie.run(tasks, reporter)
    return movie.paths


class _Movie:
    """Frames that workers render."""

    def __init__(self, frames: Any, pattern: str, count: int | None, options: dict[str, Any]):
        read, others = split_read(options)
        if _own(others):
            raise TypeError("checkpoint is not for animate(), whose frames are kept as they are")
        marks, plain = split_annotations(others)
        settings(plain), settings(read)  # report errors
        self._options = _found_by_all({**read, **others})
        self._suffix = Path(pattern).suffix.lower()
        if self._suffix not in (".png", ".ppm", ".pfm", ".exr", ".npz", ".npy"):
            raise ValueError("path: expected a pattern such as frame-{:04d}.png, with the suffix of a picture; found "
                             f"{pattern!r}. ffmpeg makes a video of the pictures")
        check_pattern(pattern)
        if callable(frames):
            if count is None or number("count", count, is_whole=True) < 1:
                raise ValueError(f"count: expected the number of frames, since frames is a function; found {count}")
            try:
                cloudpickle.dumps(frames)
            except Exception as error:
                raise TypeError(f"frames: the function cannot be sent to workers ({error}); make what it needs inside "
                                "it") from error
            self._count = count
        elif not isinstance(frames, Sequence) or isinstance(frames, (str, bytes)):
            raise TypeError(f"frames: expected a list of scenes or paths, or a function; found {frames!r}")
        elif not frames:
            raise ValueError("frames: expected at least one")
        elif count is not None:
            raise TypeError(f"count: only for a function; frames is a list of {len(frames)}")
        else:
            self._count = len(frames)
        self._frames = frames
        self.paths = [Path(pattern.format(index)) for index in range(self._count)]
        # In the folder of the pattern, with its letters.
        self._record = Path(re.sub(r"\{[^}]*\}", "all", pattern)).with_suffix(".json")
        self._sources = {} if callable(frames) else {str(i): self._source(i) for i in range(self._count)}
        self._missing = self._find(marks)
        self._said: set[str] = set()

    def _source(self, index: int) -> str:
        """What a frame depends on."""
        frame = self._frames[index]
        if isinstance(frame, (str, os.PathLike)):
            return key_of(*_files(frame, self._options))
        if isinstance(frame, Scene):
            return key_of(frame._core().to_bytes(), repr(frame._camera), repr(frame._background))
        raise TypeError(f"frames: expected Scenes or paths of scene files, found {type(frame).__name__} for frame "
                        f"{index}")

    def _find(self, marks: dict[str, Any]) -> list[int]:
        """The frames that must be rendered; the record is then valid for those that are there."""
        _, plain = split_annotations(self._options)
        made = {"version": _raio.version(), **texts(plain), **{name: repr(value) for name, value in marks.items()}}
        there = [index for index in range(self._count) if self.paths[index].exists()]
        old: dict[str, Any] = {}
        kept: dict[str, Any] = {}
        try:
            before = json.loads(self._record.read_text())
            old, kept = dict(before["options"]), dict(before["frames"])
        except FileNotFoundError:
            if there:
                raise ValueError(f"path: {self.paths[there[0]]} already exists, without {self._record.name}, which "
                                 "would tell how it was made; delete the pictures or choose another name") from None
        except (ValueError, TypeError, KeyError):
            raise ValueError(f"path: {self._record}, which tells how the pictures were made, is damaged; delete it "
                             "with the pictures") from None
        if there and old != made:
            differ = [f"{name} {old.get(name, 'not given')}, not {made.get(name, 'given')}"
                      for name in sorted({*old, *made}) if old.get(name) != made.get(name)]
            raise ValueError(f"path: the pictures in {self._record.parent} were made with other options "
                             f"({', '.join(differ)}); delete them or choose another name")
        if there and callable(self._frames):
            warnings.warn(f"path: {len(there)} of {self._count} pictures exist and are kept; delete them if the "
                          "function has changed", RuntimeWarning, stacklevel=5)
        missing = [i for i in range(self._count) if i not in set(there)
                   or kept.get(str(i)) != self._sources.get(str(i))]
        for index in missing:  # a changed frame: no old picture may look finished
            self.paths[index].unlink(missing_ok=True)
        self._record.parent.mkdir(parents=True, exist_ok=True)
        _replace(self._record, json.dumps({"options": made, "frames": self._sources}, indent=1).encode())
        return missing[::-1]

    def run(self, tasks: Tasks, reporter: Reporter) -> None:
        killed: set[int] = set()
        while self._missing or len(tasks) > 0:
            cores = tasks.cores()
            while self._missing and len(tasks) < tasks.enough():
                index = self._missing.pop()
                made = self._frames if callable(self._frames) else self._frames[index]
                if isinstance(made, (str, os.PathLike)):
                    made = os.path.abspath(made)
                tasks.submit(index, "frame", made, index, self._options, self._suffix)
            for index, result in tasks.ended(0.2):
                if isinstance(result, Killed):
                    if index in killed:
                        raise MemoryError(f"frame {index}: {result}")
                    killed.add(index)
                    warnings.warn(f"frame {index} is tried once more: {result}", RuntimeWarning, stacklevel=4)
                if isinstance(result, (Lost, Killed)):
                    self._missing.append(index)
                elif isinstance(result, BaseException):
                    result.add_note(f"while frame {index} was made")
                    raise result
                else:
                    self._take(index, *result)
            if reporter.report:
                stage = "frames" if cores else "waiting for workers"
                reporter.report(stage, 1 - (len(self._missing) + len(tasks)) / self._count, 0)

    def _take(self, index: int, picture: bytes, reported: list[str]) -> None:
        for text in reported:
            if text not in self._said:
                self._said.add(text)
                warnings.warn(f"frame {index}: {text}", SceneWarning, stacklevel=4)
        self.paths[index].parent.mkdir(parents=True, exist_ok=True)
        _replace(self.paths[index], picture)
