"""Arrays of callers: their shapes and types are checked, and float32 is passed on without a copy."""

import warnings
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float32]
FloatsLike = npt.ArrayLike

_MOST = 2**31 - 1  # primitives of one call


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
    if array.dtype.kind == "f" and array.dtype.itemsize > 4:
        _warn_if_far(name, array)
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(array, dtype=np.float32)


def _is_plain(array: npt.NDArray[Any]) -> bool:
    inner = array.ndim < 2 or array.shape[1] < 2 or array.strides[1] == 4
    return inner and (array.shape[0] < 2 or array.strides[0] % 4 == 0)


def _warn_if_far(name: str, array: npt.NDArray[Any]) -> None:
    if array.ndim != 2 or array.shape[0] < 2:
        return
    with np.errstate(invalid="ignore"):
        least, most = array.min(axis=0), array.max(axis=0)
        extent, farthest = (most - least).max(), max(abs(least).max(), abs(most).max())
    if np.isfinite(farthest) and farthest > 1e5 * extent > 0:
        warnings.warn(
            f"{name} are {farthest:g} away from 0 but only {extent:g} wide; single precision keeps "
            f"steps of {np.spacing(np.float32(farthest)):g}. Subtract their centre first",
            stacklevel=5)


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


def triple(name: str, value: Any) -> tuple[float, float, float]:
    """Three finite numbers."""
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name}: expected three numbers, found {value!r}")
    if array.shape != (3,) or not np.isfinite(array).all():
        raise ValueError(f"{name}: expected three finite numbers, found {value!r}")
    x, y, z = (float(v) for v in array)
    return x, y, z
