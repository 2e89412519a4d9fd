"""The options of the command line as keyword arguments."""

import functools
import os
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _raio
from ._arrays import did_you_mean


@functools.cache
def table() -> dict[str, dict[str, Any]]:
    """All options by the names of their keyword arguments."""
    return {_keyword(option["name"]): option for option in _raio.options()}


def _keyword(name: str) -> str:
    return "from_" if name == "from" else name.replace("-", "_")


@functools.cache
def _names() -> re.Pattern[str]:
    dashed = sorted((o["name"] for o in table().values() if "-" in o["name"]), key=len, reverse=True)
    return re.compile(rf"(?<![\w./-])(?:{'|'.join(dashed)})(?![\w/-]|\.\w)|^from(?=: )")


def with_keywords(text: str) -> str:
    """A text of the library, which names options as the command line does, with their keywords."""
    return _names().sub(lambda name: _keyword(name[0]), text)


def _text(keyword: str, option: Mapping[str, Any], value: Any) -> str:
    """The value as the command line has it."""
    if isinstance(value, (bool, np.bool_)):
        words = option["words"]
        if option["type"] == "switch" or not words:
            return "true" if value else "false"
        if "on" in words:
            return "on" if value else "off"
        raise TypeError(f"{keyword}: expected {' or '.join(words)}, found {value}")
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (list, tuple, set, np.ndarray)):
        between = "x" if "x" in option["value_name"] else ":" if ":" in option["value_name"] else ","
        return between.join(_text(keyword, {"words": [], "type": "", "value_name": ""}, v)
                            for v in value)
    raise TypeError(f"{keyword}: expected {option['value_name'] or 'True or False'}, found {value!r}")


def texts(options: Mapping[str, Any]) -> dict[str, str]:
    """The options that are not None, as the command line names and writes them."""
    known = table()
    all_texts = {}
    for keyword, value in options.items():
        if keyword not in known:
            near = did_you_mean(keyword, known) or "; help(raio.RenderOptions) lists them"
            raise TypeError(f"unknown option {keyword!r}{near}")
        if value is not None:
            all_texts[known[keyword]["name"]] = _text(keyword, known[keyword], value)
    return all_texts


def settings(options: Mapping[str, Any]) -> _raio.Settings:
    """The options that are not None."""
    all_settings = _raio.Settings()
    for name, text in texts(options).items():
        all_settings.set(name, text)
    return all_settings


def split(options: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Those for reading a file, and the others. A background that lights the scene is for reading."""
    known = table()
    read = {k: v for k, v in options.items() if k in known and known[k]["of_reader"]}
    others = {k: v for k, v in options.items() if k not in read}
    if is_light(others.get("background")):
        light = others.pop("background")
        read["background" if light == "sky" or "environment" in read else "environment"] = light
    return read, others


def is_light(background: Any) -> bool:
    """Whether it lights the scene: the sky, or a picture of all directions."""
    if not isinstance(background, (str, os.PathLike)):
        return False
    name = str(os.fspath(background))
    return (name == "sky" or name.lower().endswith((".exr", ".hdr"))) and not os.path.isdir(name)


def pixel_size(size: Any) -> tuple[int, int]:
    """The option `size` where a printed size, such as "88x66mm", does not fit."""
    if np.shape(size) != (2,) or np.asarray(size).dtype.kind not in "iu" or min(size) < 1:
        raise ValueError(f"size: expected two whole numbers of pixels, found {size!r}")
    return int(size[0]), int(size[1])
