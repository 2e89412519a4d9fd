"""Arrays of callers: their shapes and types are checked, and float32 is passed on without a copy."""

import difflib
from collections.abc import Iterable
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
FloatsLike = npt.ArrayLike

_MOST = 2**31 - 1  # primitives of one call


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name; empty if none of the known ones is alike."""
    near = difflib.get_close_matches(name, known, 1)
    return f"; did you mean {near[0]}?" if near else ""


class Strict:
    """Refuses to set public attributes that the class has not: they are misspelt."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            near = did_you_mean(name, [n for n in dir(type(self)) if n[0] != "_"])
            raise AttributeError(f"raio.{type(self).__name__} has no attribute {name!r}{near}")
        super().__setattr__(name, value)


def _shape_text(width: int | None, count: int | None) -> str:
    rows = "N" if count is None else str(count)
    return f"({rows},)" if width is None else f"({rows}, {width})"


def numbers(name: str, value: Any, width: int | None, count: int | None = None) -> Floats:
    """`value` as float32 of shape (N, width), or (N,) without a width; N is `count` if given.

    Arrays of float32 whose rows are contiguous are returned as they are; others are copied. Raises
    TypeError for values that are not real numbers, ValueError for other shapes.
    """
    if np.ma.is_masked(value):
        raise ValueError(f"{name}: some values are masked; fill or remove them")
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name}: expected real numbers, found an array of {array.dtype}")
    if width == 3 and count is None and array.shape == (3,):
        array = array[np.newaxis]
    if array.ndim != (1 if width is None else 2) or (width and array.shape[1] != width):
        raise ValueError(
            f"{name}: expected the shape {_shape_text(width, count)}, found {array.shape}")
    if count is not None and array.shape[0] != count:
        raise ValueError(
            f"{name}: expected the shape {_shape_text(width, count)}, found {array.shape}")
    if array.shape[0] > _MOST:
        raise ValueError(f"{name}: expected at most {_MOST} rows, found {array.shape[0]}")
    if array.dtype == np.float32 and array.dtype.isnative and _is_plain(array):
        plain: Floats = array
        return plain
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array, dtype=np.float32)


def _is_plain(array: npt.NDArray[Any]) -> bool:
    inner = array.ndim < 2 or array.shape[1] < 2 or array.strides[1] == 4
    return inner and (array.shape[0] < 2 or array.strides[0] % 4 == 0)


def per_row(name: str, value: Any, count: int) -> Floats:
    """A number for all rows (which is not repeated in memory), or one for each."""
    if np.ndim(value) == 0:
        one = numbers(name, np.reshape(np.asarray(value), 1), None)
        return np.broadcast_to(one, (count,))
    return numbers(name, value, None, count)


def indices(name: str, value: Any, width: Literal[2, 3, 4], limit: int) -> npt.NDArray[np.uint32]:
    """A copy of integers of shape (N, width) from 0 to limit - 1."""
    array = np.asarray(value)
    if array.dtype.kind not in "iu":
        raise TypeError(f"{name}: expected integers, found an array of {array.dtype}")
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{name}: expected the shape (N, {width}), found {array.shape}")
    if array.size and (array.min() < 0 or array.max() >= limit):
        row = int(np.argmax(((array < 0) | (array >= limit)).any(axis=1)))
        raise ValueError(
            f"{name}[{row}] is {array[row].tolist()}, expected indices from 0 to {limit - 1}")
    return np.array(array, dtype=np.uint32, order="C")


def number(name: str, value: Any, is_whole: bool = False) -> float:
    """One real number, perhaps a whole one. Raises TypeError for anything else."""
    array = np.asarray(value)
    if array.shape or array.dtype.kind not in ("iu" if is_whole else "fiu"):
        raise TypeError(f"{name}: expected a {'whole ' if is_whole else ''}number, found {value!r}")
    found: float = array.item()
    return found


def triple(name: str, value: Any) -> tuple[float, float, float]:
    """Three finite numbers."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected three numbers, found {value!r}")
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name}: expected three finite numbers, found {value!r}")
    x, y, z = (float(v) for v in array)
    return x, y, z
