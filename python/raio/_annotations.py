"""Colour bars, legends and scale bars, which are drawn on pictures."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from . import _raio
from ._color import ColorsLike, one_color

if TYPE_CHECKING:
    from ._scene import Scene

# The name of the numbers, those of the first and the last colour, and 256 colours, light.
Scale = tuple[str, float, float, list[float]]


class AnnotationOptions(TypedDict, total=False):
    """What is drawn on a picture beside the scene; it needs the library Cairo (Debian's libcairo2).

    It is part of display() and of saved pictures, not of numpy(), and .raio files do not store it.

    Attributes:
        color_bar: A colour bar of the values that `cmap` or `color_by` colours; a text is its title
        color_bar_side: Side of the colour bar; the legend takes the other one (default: right)
        legend: True: names of elements, types, chains or residues of a file. Or names and their colours
        scale_bar: A bar of a round length, valid at the distance of the point looked at; a text is the
            unit of the scene's lengths
    """

    color_bar: bool | str | None
    color_bar_side: Literal["right", "left"] | None
    legend: bool | Mapping[str, ColorsLike] | None
    scale_bar: bool | str | None


def split(options: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Those of annotations, as far as they ask for something, and the others."""
    names = AnnotationOptions.__annotations__
    wanted = {name: v for name, v in options.items() if name in names and v not in (None, False)}
    return wanted, {name: v for name, v in options.items() if name not in names}


class Annotations:
    """The annotations of a scene's pictures. Raises ValueError for those that it cannot have."""

    def __init__(self, scene: "Scene", wanted: Mapping[str, Any]):
        self._bar = self._legend = self._unit = None
        side = wanted.get("color_bar_side", "right")
        if side not in ("left", "right"):
            raise ValueError(f"color_bar_side: expected left or right, found {side!r}")
        self._at_left = side == "left"
        if "color_bar" in wanted:
            self._bar = _scale(scene, wanted["color_bar"])
        if "legend" in wanted:
            self._legend = _legend(scene, wanted["legend"])
        if "scale_bar" in wanted:
            unit = wanted["scale_bar"]
            self._unit = unit if isinstance(unit, str) else "" if scene._base is None else scene._base.unit()
        if problem := bool(self) and _raio.drawing_problem():
            raise RuntimeError(f"{', '.join(wanted)}: {problem}")

    def __bool__(self) -> bool:
        return not (self._bar is None and self._legend is None and self._unit is None)

    def put_on(self, film: _raio.Film) -> None:
        """Draws them on the film's pictures."""
        scale_bar = None if self._unit is None else (film.pixels_per_unit(), self._unit)
        film.annotate((self._bar, self._at_left, self._legend or [], scale_bar))


def _scale(scene: "Scene", title: bool | str) -> Scale:
    scales = scene._scales()
    if not scales:
        raise ValueError("color_bar: nothing is coloured by values; give colors and cmap, or color_by "
                         "for a file")
    name, least, most, colors = scales[0]
    if any(scale[1:] != scales[0][1:] for scale in scales):
        ranges = ", ".join(f"{low:g} to {high:g}" for _, low, high, _ in scales)
        raise ValueError(f"color_bar: one bar cannot show maps that differ ({ranges}); give all parts "
                         "the same cmap, vmin and vmax")
    return title if isinstance(title, str) else name, least, most, colors


def _legend(scene: "Scene", wanted: Any) -> list[tuple[str, tuple[float, float, float]]]:
    if isinstance(wanted, Mapping):
        return [(str(name), one_color(f"legend[{name!r}]", color)) for name, color in wanted.items()]
    entries = [] if scene._base is None else scene._base.legend()
    if not entries:
        raise ValueError("legend: the colours have no names; give them as a dict of names and colours")
    return [(name, (r, g, b)) for name, (r, g, b) in entries]
