"""Scenes from files."""

import errno
import os
import warnings
from collections.abc import Callable, Mapping
from typing import Any, Unpack

from . import _annotations as annotations, _raio
from ._film import Image, Path
from ._options import settings, split, with_keywords
from ._progress import Progress, Reporter
from ._render_options import FileOptions, ReadOptions
from ._scene import Scene, SceneWarning


def load(path: Path, *, progress: Progress = False, **options: Unpack[ReadOptions]) -> Scene:
    """Reads a scene file of any format that the program reads (docs/files.md).

    Args:
        path: the file, perhaps compressed by gzip.
        progress: True shows a bar; or a function of the stage and its share, 0 to 1.
        options: every reading option of the command line is a keyword: `style="sticks"`,
            `color_by="chain"`, `frame=3`; raio.ReadOptions lists them.

    Raises:
        FileNotFoundError: there is no such file.
        SceneError: it cannot be read; with line and column.

    What is guessed or left out is a SceneWarning.
    """
    return _load(path, progress, options, 4)


def render(path: Path, *, progress: Progress = False, **options: Unpack[FileOptions]) -> Image:
    """Reads a scene file and renders it: options as for load() and Scene.render()."""
    read, others = split(options)
    settings(annotations.split(others)[1])  # reports errors before the file is read
    return _load(path, progress, read, 4).render(progress=progress, **others)


def _load(path: Path, progress: Progress, options: Mapping[str, Any], stacklevel: int) -> Scene:
    wanted = read_settings(options)
    name = os.fspath(path)
    if name != "-" and not os.path.exists(name):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), name)
    with Reporter(progress) as reporter:
        core = _raio.Scene.read(name, wanted, reporter.report)
    return scene_of(core, stacklevel)


def read_settings(options: Mapping[str, Any]) -> _raio.Settings:
    """The reader's options, and no others."""
    read, others = split(options)
    if others:
        settings(others)  # reports unknown ones
        raise TypeError(f"{next(iter(others))} is an option of render(), not for reading")
    return settings(read)


def scene_of(core: _raio.Scene, stacklevel: int,
             worded: Callable[[str], str] = with_keywords) -> Scene:
    """A scene of what was read; its warnings name the caller that many levels up."""
    for text in core.warnings():
        warnings.warn(worded(text), SceneWarning, stacklevel=stacklevel)
    scene = Scene(background=None)
    scene._base = core
    return scene
