"""Colours: names, numbers, and values through colour maps."""

import warnings
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _raio
from ._arrays import Floats, did_you_mean, numbers
from ._options import table

# "white", "#ff8800", (r, g, b), (N, 3), (N, 4), or (N,) values for a colour map.
ColorsLike = str | npt.ArrayLike


def linear(colors: npt.ArrayLike) -> Floats:
    """Converts display values (sRGB, as matplotlib has them) to light, which Raio computes with.

    Args:
        colors: any shape, 0 to 1, or uint8. The curve is that of IEC 61966-2-1.

    Examples:
        >>> import raio
        >>> round(float(raio.linear(0.5)), 3)
        0.214
    """
    array = _light_or_bytes("colors", colors)
    shown = array / np.float32(255) if array.dtype == np.uint8 else array
    light = np.array(shown, dtype=np.float32, order="C")
    _raio.to_linear(light.reshape(-1))
    return light


def _light_or_bytes(name: str, colors: npt.ArrayLike) -> npt.NDArray[Any]:
    array = np.asarray(colors)
    if array.dtype.kind in "iu" and array.dtype != np.uint8 and array.size and array.max() > 1:
        raise TypeError(
            f"{name}: integers of {array.dtype} are not 0 to 1; use uint8 for 0 to 255, or floats")
    return array


def colormap(cmap: Any) -> Floats:
    """The colours of a map as light, (256, 3).

    Args:
        cmap: "viridis", "plasma", "cividis" or "coolwarm"; with matplotlib, the name of any of its maps
            or one of its Colormap objects.

    Examples:
        >>> import raio
        >>> raio.colormap("viridis").shape
        (256, 3)
    """
    if isinstance(cmap, str):
        own = table()["colormap"]["words"]
        if cmap in own:
            return _raio.colormap(cmap)
        others = _matplotlib_maps()
        if cmap not in others:
            raise ValueError(f"cmap: expected {', '.join(own)} or, with matplotlib installed, a name in "
                             f"matplotlib.colormaps; found {cmap!r}{did_you_mean(cmap, [*own, *others])}")
        cmap = others[cmap]
    if not callable(cmap):
        raise TypeError(f"cmap: expected a name or a matplotlib Colormap, found {cmap!r}")
    return linear(np.asarray(cmap(np.linspace(0, 1, 256)))[:, :3])


def _matplotlib_maps() -> Any:
    try:
        from matplotlib import colormaps
    except ImportError:
        return {}
    return colormaps


def one_color(name: str, value: Any) -> tuple[float, float, float]:
    """A colour for all, as light: a name, "#rrggbb", or three numbers."""
    if isinstance(value, str):
        try:
            r, g, b = _raio.parse_color(value)
        except ValueError as error:
            other = _matplotlib_color(value)
            if other is None:
                raise ValueError(f"{name}: {error}") from None
            return other
        return r, g, b
    row = numbers(name, _light_or_bytes(name, value), 3)[0]
    if np.asarray(value).dtype == np.uint8:
        row = linear(np.asarray(value))
    if not (np.isfinite(row).all() and (row >= 0).all()):
        raise ValueError(f"{name}: expected numbers that are finite and not negative, found {value!r}")
    return float(row[0]), float(row[1]), float(row[2])


def _matplotlib_color(name: str) -> tuple[float, float, float] | None:
    try:
        from matplotlib.colors import to_rgb
        r, g, b = linear(to_rgb(name))
    except (ImportError, ValueError):
        return None
    return float(r), float(g), float(b)


class Painted(NamedTuple):
    """Colours of primitives: one for all, or one each, perhaps with opacities."""

    one: tuple[float, float, float] | None = None
    each: Floats | None = None
    opacity: Floats | None = None


def paint(colors: Any, count: int, cmap: Any, vmin: float | None, vmax: float | None) -> Painted:
    """The argument `colors` of `count` primitives."""
    if cmap is None and (vmin is not None or vmax is not None):
        raise ValueError("vmin and vmax are the ends of a colour map; give cmap, too")
    if not isinstance(colors, str) and np.asarray(colors).dtype.kind in "US":
        raise TypeError("colors: a list of names is not accepted; give (N, 3) numbers")
    if colors is None:
        if cmap is not None:
            raise ValueError("cmap colours values; give them as colors, with the shape (N,)")
        return Painted()
    if cmap is not None:
        return Painted(each=_mapped(numbers("colors", colors, None, count), cmap, vmin, vmax))
    if isinstance(colors, str) or np.shape(colors) == (3,):
        return Painted(one=one_color("colors", colors))
    array = np.asarray(colors)
    if array.ndim == 1 and array.shape[0] == count:
        raise ValueError(
            f"colors: {array.shape} are values; give a colour map with cmap, or the shape "
            f"({count}, 3)")
    if array.ndim != 2 or array.shape[1] not in (3, 4) or array.shape[0] != count:
        raise ValueError(
            f"colors: expected the shape (3,), ({count}, 3) or ({count}, 4), found {array.shape}")
    if array.dtype == np.uint8:
        light = linear(array[:, :3])
        opacity = (array[:, 3] / np.float32(255)).astype(np.float32) if array.shape[1] == 4 else None
        return Painted(each=light, opacity=opacity)
    array = _light_or_bytes("colors", array)
    all_columns = numbers("colors", array, array.shape[1], count)
    opacity = all_columns[:, 3] if array.shape[1] == 4 else None
    return Painted(each=all_columns[:, :3], opacity=opacity)


def limits(values: Floats, vmin: float | None, vmax: float | None) -> tuple[float, float]:
    """The values of a map's first and last colour: those given, else of the smallest and the largest value."""
    if vmin is not None and vmax is not None:
        if not vmin < vmax:
            raise ValueError(f"vmin must be below vmax; found {vmin:g} and {vmax:g}")
        return float(vmin), float(vmax)
    finite: Any = values[np.isfinite(values)]
    if not len(finite):
        finite = [end for end in (vmin, vmax) if end is not None] or [0]
    least = float(np.min(finite) if vmin is None else vmin)
    most = float(np.max(finite) if vmax is None else vmax)
    if least > most:
        raise ValueError(f"the values are from {np.min(finite):g} to {np.max(finite):g}, beyond the end given: "
                         "vmin must be below vmax; give both")
    return least, most


def _mapped(values: Floats, cmap: Any, vmin: float | None, vmax: float | None) -> Floats:
    bad = np.count_nonzero(~np.isfinite(values))
    if bad:
        warnings.warn(f"colors: {bad} values are not finite; they get the map's first colour",
                      stacklevel=5)
    least, most = limits(values, vmin, vmax)
    span = most - least
    share = (values - np.float32(least)) / np.float32(span) if span > 0 else np.full_like(values, 0.5)
    places = np.nan_to_num(share, nan=0, posinf=1, neginf=0).clip(0, 1) * np.float32(255)
    table: Floats = colormap(cmap)[np.rint(places).astype(np.intp)]
    return table
