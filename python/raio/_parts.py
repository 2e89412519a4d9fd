"""The primitives of a scene: arrays that can be replaced, or changed in place."""

from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import numpy.typing as npt

from . import _raio
from ._annotations import Scale
from ._arrays import Floats, Strict, indices, numbers, per_row
from ._color import Painted, colormap, limits, paint
from ._material import Material, StandardMaterial, Surface

if TYPE_CHECKING:
    from ._scene import Scene


class Part(Strict):
    """The primitives that one call of a Scene added.

    Its arrays are attributes. Assign another array, or write into the existing one and then call
    `changed()`; the next picture shows it. Other colours and opacities are shown without building
    the acceleration structure again. Attributes that were borrowed from the caller are the caller's
    own arrays: writing to them is writing to the part.
    """

    # Names of arrays, with the length of their rows; None: plain numbers.
    _columns: ClassVar[dict[str, int | None]] = {}

    def __init__(self, scene: "Scene", count: int, material: Surface | None,
                 colors: Any, opacity: Any, cmap: Any, vmin: float | None, vmax: float | None):
        self._scene = scene
        self._count = count
        self._material: Surface | None = _checked_material(material)
        self._arrays: dict[str, Any] = {}
        self._map = (cmap, vmin, vmax)
        self._set_colors(colors)
        self._set_opacity(opacity)

    def __len__(self) -> int:
        return self._count

    def __repr__(self) -> str:
        return f"<raio.{type(self).__name__} of {self._count}>"

    def changed(self) -> None:
        """Tells that the contents of an array were changed in place."""
        self._scene._change(geometry=True)

    def remove(self) -> None:
        """Takes the primitives out of the scene."""
        self._scene._remove(self)

    @property
    def colors(self) -> Any:
        """Colours as given: None, one colour, (N, 3), (N, 4), or (N,) values, which keep map and `clim`."""
        return self._colors

    @colors.setter
    def colors(self, value: Any) -> None:
        are_values = not isinstance(value, str) and np.ndim(value) == 1 and (
            self._map[0] is not None and np.shape(value) == np.shape(self._colors))
        self.recolor(value, *(self._map if are_values else (None, None, None)))

    @property
    def clim(self) -> tuple[float, float] | None:
        """The values of the map's first and last colour; values beyond get these colours.

        As in matplotlib, the first values set what was not given, and later ones do not change it:
        pictures of a movie have one scale. Assign a pair to change it. None: there is no map, or all
        values have been equal so far.
        """
        _, vmin, vmax = self._map
        return None if vmin is None or vmax is None else (vmin, vmax)

    @clim.setter
    def clim(self, ends: tuple[float, float]) -> None:
        self.recolor(self._colors, self._map[0], *ends)

    @property
    def opacity(self) -> Any:
        """Opacities as given: None (opaque), a number, or (N,), 0 to 1."""
        return self._opacity

    @opacity.setter
    def opacity(self, value: Any) -> None:
        self._set_opacity(value)
        self._scene._change(geometry=True)  # transparent primitives have their own tree

    @property
    def material(self) -> Surface | None:
        """The surface; None: matt."""
        return self._material

    @material.setter
    def material(self, value: Surface | None) -> None:
        self._material = _checked_material(value)
        self._scene._change(geometry=True)

    def recolor(self, colors: Any, cmap: Any = None, vmin: float | None = None,
                vmax: float | None = None) -> None:
        """Other colours, perhaps with another map and range; arguments as for Scene.spheres()."""
        before, self._map = self._map, (cmap, vmin, vmax)
        try:
            self._set_colors(colors)
        except (TypeError, ValueError):
            self._map = before
            raise
        self._scene._change(geometry=False)

    def _rows_of(self, colors: Any) -> int:
        """The number of elements to which such colours belong."""
        return self._count

    def _set_colors(self, colors: Any) -> None:
        rows = self._rows_of(colors)
        paint(colors, rows, *self._map)  # reports errors now
        self._colors = _floats_of(colors)
        cmap, *ends = self._map
        if cmap is not None:
            least, most = limits(numbers("colors", colors, None, rows), *ends)
            if least < most:
                self._map = (cmap, least, most)

    def _set_opacity(self, opacity: Any) -> None:
        if opacity is not None:
            opacity = float(opacity) if np.ndim(opacity) == 0 else numbers(
                "opacity", opacity, None, self._count)
            if np.ndim(opacity) == 0 and not 0 <= opacity <= 1:
                raise ValueError(f"opacity: expected a number from 0 to 1, found {opacity}")
        self._opacity = opacity

    def _set(self, name: str, value: npt.ArrayLike) -> None:
        width = self._columns[name]
        if width is None:
            self._arrays[name] = per_row(name, value, self._count)
        else:
            self._arrays[name] = numbers(name, value, width, self._count)

    def _scales(self) -> list[Scale]:
        """The scales of the values that are shown as colours."""
        cmap, *ends = self._map
        if cmap is None:
            return []
        least, most = limits(numbers("colors", self._colors, None), *ends)
        return [("", least, most, colormap(cmap).ravel().tolist())]

    def _look(self, core: _raio.Scene) -> tuple[int, Floats | None, Floats | None]:
        """The number of the material in `core`, colours and opacities."""
        painted = paint(self._colors, self._count, *self._map)
        opacity = painted.opacity if self._opacity is None else self._opacity
        one = float(opacity) if isinstance(opacity, float) else 1.0
        each = None if opacity is None or isinstance(opacity, float) else opacity
        return self._number(core, painted, one), painted.each, each

    def _number(self, core: _raio.Scene, painted: Painted, opacity: float) -> int:
        material = self._material or Material()
        return material._add(core, painted.one, opacity)

    def _add(self, core: _raio.Scene) -> None:
        raise NotImplementedError

    def _rows_of_primitives(self, pool: str) -> npt.NDArray[np.int64] | None:
        """The rows of what _add() adds to a pool (see Spans), or None: in their order."""
        return None


def _checked_material(material: Any) -> Any:
    if material is not None and not isinstance(material, (Material, StandardMaterial)):
        raise TypeError(
            f"material: expected a raio.Material or raio.StandardMaterial, found {material!r}")
    return material


def _floats_of(colors: Any) -> Any:
    # So that `part.colors[...] = x` writes to what the next picture shows. As for other arrays, only
    # those of float32 are the caller's.
    if colors is None or isinstance(colors, (str, tuple)):
        return colors
    array = np.asarray(colors)
    if array.dtype == np.float32 and array.dtype.isnative:
        return array
    return array.astype(np.float32) if array.dtype.kind == "f" else array.copy()


def _array(name: str, doc: str) -> Any:
    def get(part: Part) -> Any:
        return part._arrays[name]

    def put(part: Part, value: npt.ArrayLike) -> None:
        part._set(name, value)
        part._scene._change(geometry=True)

    return property(get, put, doc=doc)


class Spheres(Part):
    """Spheres, by Scene.spheres()."""

    _columns = {"centers": 3, "radii": None}
    centers: Floats = _array("centers", "(N, 3), scene units.")
    radii: Floats = _array("radii", "(N,), scene units.")

    def _add(self, core: _raio.Scene) -> None:
        core.add_spheres(self.centers, self.radii, *self._look(core))


class Cones(Part):
    """Cones and cylinders without caps, by Scene.cones() and Scene.cylinders()."""

    _columns = {"starts": 3, "ends": 3, "start_radii": None, "end_radii": None}
    starts: Floats = _array("starts", "Centres of the first circles, (N, 3).")
    ends: Floats = _array("ends", "Centres of the second circles, (N, 3).")
    start_radii: Floats = _array("start_radii", "(N,).")
    end_radii: Floats = _array("end_radii", "(N,).")

    def _add(self, core: _raio.Scene) -> None:
        core.add_cones(self.starts, self.ends, self.start_radii, self.end_radii, *self._look(core))


class Lines(Part):
    """A polyline, by Scene.lines()."""

    _columns = {"points": 3, "radius": None}
    points: Floats = _array("points", "(N, 3), scene units.")
    radius: Floats = _array("radius", "(N,), scene units.")

    def _add(self, core: _raio.Scene) -> None:
        number, colors, opacity = self._look(core)
        core.add_spheres(self.points, self.radius, number, colors, opacity)
        starts = self._starts()
        if self._map[0] is not None:
            values = numbers("colors", self._colors, None, self._count)
            segments = paint(_between(values, starts), len(starts), *self._map).each
        else:
            segments = _between(colors, starts)
        core.add_cones(self.points[starts], self.points[starts + 1], self.radius[starts],
                       self.radius[starts + 1], number, segments, _between(opacity, starts))

    def _starts(self) -> npt.NDArray[np.int64]:
        # A segment needs a length.
        return np.flatnonzero((self.points[1:] != self.points[:-1]).any(axis=1))

    def _rows_of_primitives(self, pool: str) -> npt.NDArray[np.int64] | None:
        return self._starts() if pool == "cone" else None


def _between(rows: Floats | None, starts: npt.NDArray[np.int64]) -> Any:
    return None if rows is None else (rows[starts] + rows[starts + 1]) / np.float32(2)


class Ellipsoids(Part):
    """Ellipsoids, by Scene.ellipsoids()."""

    _columns = {"centers": 3, "axes": 9}
    centers: Floats = _array("centers", "(N, 3).")
    axes: Floats = _array("axes", "Three perpendicular half axes each, (N, 9).")

    def _add(self, core: _raio.Scene) -> None:
        core.add_ellipsoids(self.centers, self.axes, *self._look(core))


class Discs(Part):
    """Flat discs and rings, by Scene.discs()."""

    _columns = {"centers": 3, "normals": 3, "radii": None, "inner_radii": None}
    centers: Floats = _array("centers", "(N, 3).")
    normals: Floats = _array("normals", "(N, 3), of any length.")
    radii: Floats = _array("radii", "(N,).")
    inner_radii: Floats = _array("inner_radii", "(N,); 0: no hole.")

    def _add(self, core: _raio.Scene) -> None:
        core.add_discs(self.centers, self.normals, self.radii, self.inner_radii, *self._look(core))


class Mesh(Part):
    """Triangles with common vertices, by Scene.mesh(). `len()` counts faces as given."""

    _columns = {"vertices": 3, "normals": 3, "uv": 2}
    vertices: Floats = _array("vertices", "(V, 3), scene units.")
    normals: Floats = _array("normals", "(V, 3), or None: flat triangles.")

    def __init__(self, scene: "Scene", vertices: npt.ArrayLike, faces: npt.ArrayLike,
                 normals: npt.ArrayLike | None, uv: npt.ArrayLike | None,
                 material: Surface | None, colors: Any, opacity: Any, cmap: Any,
                 vmin: float | None, vmax: float | None):
        points = numbers("vertices", vertices, 3)
        shape = np.shape(faces)
        self._are_quads = len(shape) == 2 and shape[1] == 4
        corners = indices("faces", faces, 4 if self._are_quads else 3, len(points))
        self._triangles = np.concatenate(
            (corners[:, :3], corners[:, [0, 2, 3]])) if self._are_quads else corners
        self._vertex_count = len(points)
        super().__init__(scene, len(corners), material, colors, opacity, cmap, vmin, vmax)
        self._arrays = {"vertices": points, "normals": None, "uv": None}
        if normals is not None:
            self._arrays["normals"] = numbers("normals", normals, 3, len(points))
        if uv is not None:
            self._arrays["uv"] = numbers("uv", uv, 2, len(points))

    def _set(self, name: str, value: npt.ArrayLike) -> None:
        self._arrays[name] = numbers(name, value, self._columns[name], self._vertex_count)

    def _rows_of(self, colors: Any) -> int:
        """Colours belong to vertices, or to faces if their number fits only these."""
        is_by_face = colors is not None and np.shape(colors)[:1] == (self._count,)
        return self._count if is_by_face else self._vertex_count

    def _add(self, core: _raio.Scene) -> None:
        rows = self._rows_of(self._colors)
        painted = paint(self._colors, rows, *self._map)
        is_by_face = painted.each is not None and rows != self._vertex_count
        opacity = self._opacity
        if painted.opacity is not None:
            if not is_by_face:
                raise ValueError("colors: opacities of vertices are not supported; give opacity")
            opacity = painted.opacity if opacity is None else opacity
        one = float(opacity) if isinstance(opacity, float) else 1.0
        each = None if opacity is None or isinstance(opacity, float) else self._per_triangle(opacity)
        uv = self._arrays["uv"]
        if each is not None or is_by_face or (painted.each is None and uv is None):
            if uv is not None or (painted.each is not None and not is_by_face):
                raise ValueError(
                    "opacity: one per face cannot be combined with uv or colours of vertices")
            colors = None if painted.each is None else self._per_triangle(painted.each)
            core.add_triangles(self.vertices, self._triangles, self.normals,
                               self._number(core, painted, one), colors, each)
        else:
            if painted.each is not None:
                painted = Painted(one=(1.0, 1.0, 1.0), each=painted.each)
            core.add_mesh(self.vertices, self._triangles, self.normals, uv, painted.each,
                          self._number(core, painted, one))

    def _rows_of_primitives(self, pool: str) -> npt.NDArray[np.int64] | None:
        return np.tile(np.arange(self._count), 2) if self._are_quads else None

    def _per_triangle(self, of_faces: Floats) -> Floats:
        return np.concatenate((of_faces, of_faces)) if self._are_quads else of_faces


class Instances(Part):
    """Copies of another scene, by Scene.instances(). Their looks are those of its parts."""

    _columns = {"transforms": 12}
    transforms: Floats = _array("transforms", "Matrices, (N, 12): three rows of four numbers each.")

    def __init__(self, scene: "Scene", object: "Scene", transforms: npt.ArrayLike):
        rows = self._rows(transforms)
        super().__init__(scene, len(rows), None, None, None, None, None, None)
        self._object = object
        self._set("transforms", rows)

    @staticmethod
    def _rows(transforms: npt.ArrayLike) -> npt.NDArray[Any]:
        rows = np.asarray(transforms)
        if rows.ndim == 3 and rows.shape[1:] in ((3, 4), (4, 4)):
            if rows.shape[1] == 4 and not np.allclose(rows[:, 3], (0, 0, 0, 1)):
                raise ValueError("transforms: the last rows must be 0, 0, 0, 1")
            return rows[:, :3].reshape(-1, 12)
        if rows.ndim != 2 or rows.shape[1] != 12:
            raise ValueError(
                f"transforms: expected the shape (N, 4, 4) or (N, 3, 4), found {rows.shape}")
        return rows

    def _set(self, name: str, value: npt.ArrayLike) -> None:
        super()._set(name, self._rows(value))

    def _set_colors(self, colors: Any) -> None:
        if colors is not None:
            raise ValueError("colors: instances have those of their object; change that")
        self._colors = None

    def _scales(self) -> list[Scale]:
        return self._object._scales()

    def _add(self, core: _raio.Scene) -> None:
        core.add_instances(core.add_prototype(self._object._core()), self.transforms)
