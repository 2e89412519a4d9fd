"""Scenes: files, arrays, lights and a camera, and how they are rendered."""

import os
import threading
import warnings
from collections.abc import Mapping
from typing import Any, TypeVar, Unpack

import numpy as np
import numpy.typing as npt

from . import _raio
from ._annotations import Annotations, Scale, split
from ._arrays import FloatsLike, Strict, numbers, per_row, triple
from ._color import ColorsLike, one_color
from ._film import Film, Image, Path
from ._material import Surface
from ._options import settings
from ._parts import Cones, Discs, Ellipsoids, Instances, Lines, Mesh, Part, Spheres
from ._progress import Progress, Reporter
from ._rays import KINDS, Hits
from ._render_options import RenderOptions

AnyPart = TypeVar("AnyPart", bound=Part)

# The primitives of a part in each pool of the library's scene: the first, the one behind the last,
# and the rows of the part's arrays to which they belong; None: in order.
Spans = dict[str, tuple[int, int, npt.NDArray[np.int64] | None]]


class SceneError(ValueError):
    """A file cannot be read. `file`, `line` and `column` tell where; 0: unknown."""

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0):
        super().__init__(message)
        self.file, self.line, self.column = file, line, column

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.file, self.line, self.column)


class SceneWarning(UserWarning):
    """Something in a file was guessed or left out."""


_raio.set_scene_error(SceneError)


class Scene(Strict):
    """Primitives from arrays, files or both, with lights and a camera.

    Without lights a scene is a figure, lit from everywhere. With lights, `integrator="classic"` is
    the default, with the tone curve "srgb"; with a StandardMaterial, `integrator="path"`. The camera
    shows everything unless camera() or look() is called. A scene may be changed at any time. Arrays
    of float32 are not copied: they are kept alive, and must not be written to while a picture is
    rendered (its pixels would be undefined, though nothing crashes); changed() tells of changes.

    Args:
        background: a name, "#rrggbb", three numbers of light, "transparent", or None: that of the
            look, or white in a scene with lights.

    Examples:
        >>> import raio
        >>> scene = raio.Scene(background="transparent")
        >>> ball = scene.spheres([[0, 0, 0]], 1, colors="orange")
        >>> scene.render(size=(32, 24), samples=4)
        <raio.Image of 32 x 24>
    """

    def __init__(self, background: str | npt.ArrayLike | None = None):
        self._base: _raio.Scene | None = None
        self._parts: list[Part] = []
        self._lights: list[tuple[Any, ...]] = []
        self._camera: dict[str, Any] = {}
        self._look: tuple[Any, ...] = (None, (0.0, 0.0, 1.0), 0.0)
        self.background = background
        self._start_caches()

    def _start_caches(self) -> None:
        self._lock = threading.RLock()
        self._primitives: _raio.Scene | None = None  # without camera and lights
        self._spans: dict[Part, Spans] = {}  # those of the parts in _primitives
        self._built: _raio.Scene | None = None
        self._geometry = 0  # counts changes of primitives
        self._accels: dict[tuple[Any, ...], tuple[_raio.Scene, int, _raio.Accel]] = {}

    @property
    def background(self) -> str | npt.ArrayLike | None:
        """As in the constructor."""
        return self._background

    @background.setter
    def background(self, value: str | npt.ArrayLike | None) -> None:
        if value is not None and not isinstance(value, str):
            one_color("background", value)
        self._background = value

    # --- primitives

    def spheres(self, centers: FloatsLike, radii: FloatsLike, *, colors: Any = None,
                opacity: FloatsLike | None = None, material: Surface | None = None,
                cmap: Any = None, vmin: float | None = None, vmax: float | None = None) -> Spheres:
        """Adds spheres. float32 arrays are borrowed, others are copied.

        Args:
            centers: (N, 3), scene units.
            radii: a number or (N,), above 0.
            colors: one colour for all (a name, "#rrggbb" or three numbers), (N, 3), or (N, 4) with
                opacities. Floats are light, 0 to 1 (raio.linear() converts display values); uint8 is
                as displayed, 0 to 255. Or (N,) values for `cmap`.
            opacity: a number or (N,), 0 to 1.
            material: the surface; None: matt.
            cmap: a colour map, see raio.colormap().
            vmin: the value of its first colour; None: the smallest of the first `colors` (Part.clim).
            vmax: the value of its last colour; None: the largest of the first `colors`.

        Raises:
            TypeError: an argument is not numeric.
            ValueError: a shape or a number does not fit; the message names the argument.

        Examples:
            >>> import raio
            >>> raio.Scene().spheres([[0, 0, 0], [1, 0, 0]], 0.5, colors=[1, 2], cmap="viridis")
            <raio.Spheres of 2>
        """
        points = numbers("centers", centers, 3)
        part = Spheres(self, len(points), material, colors, opacity, cmap, vmin, vmax)
        part._arrays = {"centers": points, "radii": per_row("radii", radii, len(points))}
        return self._append(part)

    def points(self, positions: FloatsLike, radius: float | None = None, **look: Any) -> Spheres:
        """Adds small spheres of one size.

        Args:
            positions: (N, 3), scene units.
            radius: None: half the mean spacing of the points.
            look: colours and opacity as for spheres().
        """
        points = numbers("positions", positions, 3)
        if radius is None:
            with np.errstate(invalid="ignore", over="ignore"):
                sides = np.ptp(points.astype(np.float64), axis=0) if len(points) else np.zeros(3)
            used = sides[sides > 1e-6 * sides.max()] if len(points) else sides[:0]
            radius = float((used.prod() / len(points)) ** (1 / len(used)) / 2) if len(used) else 0.5
        return self.spheres(points, radius, **look)

    def cones(self, starts: FloatsLike, ends: FloatsLike, start_radii: FloatsLike,
              end_radii: FloatsLike, *, colors: Any = None, opacity: FloatsLike | None = None,
              material: Surface | None = None, cmap: Any = None, vmin: float | None = None,
              vmax: float | None = None) -> Cones:
        """Adds cones without caps, from one circle to another. Looks as for spheres().

        Args:
            starts: centres of the first circles, (N, 3), scene units.
            ends: centres of the second circles, (N, 3).
            start_radii: a number or (N,).
            end_radii: a number or (N,); 0 is a tip.
        """
        first, second = _pairs(starts, ends)
        part = Cones(self, len(first), material, colors, opacity, cmap, vmin, vmax)
        part._arrays = {"starts": first, "ends": second,
                        "start_radii": per_row("start_radii", start_radii, len(first)),
                        "end_radii": per_row("end_radii", end_radii, len(first))}
        return self._append(part)

    def cylinders(self, starts: FloatsLike, ends: FloatsLike, radii: FloatsLike, *,
                  colors: Any = None, opacity: FloatsLike | None = None,
                  material: Surface | None = None, cmap: Any = None, vmin: float | None = None,
                  vmax: float | None = None) -> Cones:
        """Adds cylinders without caps. Looks as for spheres().

        Args:
            starts: centres of the first circles, (N, 3), scene units.
            ends: centres of the second circles, (N, 3).
            radii: a number or (N,).
        """
        first, second = _pairs(starts, ends)
        radius = per_row("radii", radii, len(first))
        part = Cones(self, len(first), material, colors, opacity, cmap, vmin, vmax)
        part._arrays = {"starts": first, "ends": second, "start_radii": radius, "end_radii": radius}
        return self._append(part)

    def lines(self, points: FloatsLike, radius: FloatsLike, *, colors: Any = None,
              opacity: FloatsLike | None = None, material: Surface | None = None, cmap: Any = None,
              vmin: float | None = None, vmax: float | None = None) -> Lines:
        """Adds a polyline of round segments with round joints. Looks as for spheres(), per point.

        Args:
            points: (N, 3), at least two, scene units.
            radius: a number or (N,), scene units.
            colors: as for spheres(); a segment has the mean of its ends, or the colour of their mean value.

        Examples:
            >>> import raio
            >>> raio.Scene().lines([[0, 0, 0], [1, 0, 0], [1, 2, 0]], 0.1, colors=[0, 1, 3], cmap="plasma")
            <raio.Lines of 3>
        """
        path = numbers("points", points, 3)
        if len(path) < 2:
            raise ValueError(f"points: expected at least two, found {len(path)}")
        part = Lines(self, len(path), material, colors, opacity, cmap, vmin, vmax)
        part._arrays = {"points": path, "radius": per_row("radius", radius, len(path))}
        return self._append(part)

    def ellipsoids(self, centers: FloatsLike, axes: FloatsLike, *, colors: Any = None,
                   opacity: FloatsLike | None = None, material: Surface | None = None,
                   cmap: Any = None, vmin: float | None = None,
                   vmax: float | None = None) -> Ellipsoids:
        """Adds ellipsoids. Looks as for spheres().

        Args:
            centers: (N, 3), scene units.
            axes: (N, 3, 3) or (N, 9): three perpendicular vectors each, from the centre to the surface.
        """
        points = numbers("centers", centers, 3)
        half = np.asarray(axes)
        half = half.reshape(len(half), 9) if half.ndim == 3 and half.shape[1:] == (3, 3) else half
        part = Ellipsoids(self, len(points), material, colors, opacity, cmap, vmin, vmax)
        part._arrays = {"centers": points, "axes": numbers("axes", half, 9, len(points))}
        return self._append(part)

    def discs(self, centers: FloatsLike, normals: FloatsLike, radii: FloatsLike,
              inner_radii: FloatsLike = 0, *, colors: Any = None,
              opacity: FloatsLike | None = None, material: Surface | None = None, cmap: Any = None,
              vmin: float | None = None, vmax: float | None = None) -> Discs:
        """Adds flat discs, or rings. Looks as for spheres().

        Args:
            centers: (N, 3), scene units.
            normals: (N, 3), of any length but 0.
            radii: a number or (N,).
            inner_radii: a number or (N,); 0: no hole.
        """
        points = numbers("centers", centers, 3)
        part = Discs(self, len(points), material, colors, opacity, cmap, vmin, vmax)
        part._arrays = {"centers": points, "normals": numbers("normals", normals, 3, len(points)),
                        "radii": per_row("radii", radii, len(points)),
                        "inner_radii": per_row("inner_radii", inner_radii, len(points))}
        return self._append(part)

    def mesh(self, vertices: FloatsLike, faces: npt.ArrayLike, *, normals: FloatsLike | None = None,
             colors: Any = None, uv: FloatsLike | None = None,
             opacity: FloatsLike | None = None, material: Surface | None = None, cmap: Any = None,
             vmin: float | None = None, vmax: float | None = None) -> Mesh:
        """Adds triangles with common vertices.

        Args:
            vertices: (V, 3), scene units.
            faces: integers, (F, 3), or (F, 4) for quadrilaterals; copied.
            normals: (V, 3) for smooth triangles; None: flat.
            colors: as for spheres(), per vertex, or per face if their number fits only the faces.
            uv: (V, 2), for the texture of the material; (0, 0) is its lower left corner.
            opacity: a number, or (F,).
        """
        return self._append(Mesh(self, vertices, faces, normals, uv, material, colors, opacity, cmap,
                                 vmin, vmax))

    def instances(self, object: "Scene", transforms: FloatsLike) -> Instances:
        """Adds copies of all primitives of another scene, which are stored once.

        Args:
            object: its later changes are not shown.
            transforms: (N, 4, 4) or (N, 3, 4): matrices for column vectors; the translation is the last
                column.
        """
        if object is self:
            raise ValueError("object: a scene cannot contain itself")
        return self._append(Instances(self, object, transforms))

    def _append(self, part: AnyPart) -> AnyPart:
        with self._lock:
            core = self._all_primitives()
            self._primitives = None  # a failure leaves half of the part
            self._add(part, core)  # reports invalid numbers now
            self._parts.append(part)
            self._change(geometry=True)
            self._primitives = core
        return part

    def _add(self, part: Part, core: _raio.Scene) -> None:
        before = _counts(core)
        if len(part):
            part._add(core)
        self._spans[part] = {pool: (before[pool], last, part._rows_of_primitives(pool))
                             for pool, last in _counts(core).items() if last > before[pool]}

    def _remove(self, part: Part) -> None:
        with self._lock:
            if part not in self._parts:
                raise ValueError(f"{part!r} is no longer in the scene")
            self._parts.remove(part)
            self._change(geometry=True)

    def _change(self, geometry: bool) -> None:
        with self._lock:
            self._primitives = self._built = None
            if geometry:
                self._geometry += 1

    # --- light and camera

    def light(self, position: FloatsLike | None = None, direction: FloatsLike | None = None,
              color: ColorsLike | None = None, size: float = 0) -> None:
        """Adds a light at a position, or a distant one that shines in a direction.

        Args:
            position: three numbers, scene units.
            direction: three numbers, instead of a position.
            color: None: white, so bright that all such lights together suit; else light, 1 being white.
            size: the side of the square that `soft_shadows` makes of it; 0: the option's.
        """
        if (position is None) == (direction is None):
            raise ValueError("light: give position or direction")
        where = triple("position", position) if position is not None else triple(
            "direction", direction)
        if direction is not None and where == (0, 0, 0):
            raise ValueError("direction: expected a direction other than zero")
        if not size >= 0:
            raise ValueError(f"size: expected a number from 0 on, found {size}")
        hue = None if color is None else one_color("color", color)
        self._lights.append((where, position is None, hue, float(size)))
        self._change(geometry=False)

    def camera(self, from_: FloatsLike, at: FloatsLike, up: FloatsLike = (0, 0, 1),
               fov: float | None = None, aperture: float | None = None, focus: float | None = None,
               projection: str | None = None) -> None:
        """Places the camera.

        Args:
            from_: where it is, three numbers, scene units.
            at: the point in the middle of the picture.
            up: the direction that is up in the picture.
            fov: the vertical angle, degrees.
            aperture: the radius of a lens, which blurs, scene units.
            focus: the distance that is then sharp; None: that of `at`.
            projection: "perspective" or "orthographic".
        """
        view = {"from_": triple("from_", from_), "at": triple("at", at), "up": triple("up", up),
                "fov": fov, "projection": projection}
        if view["from_"] == view["at"]:
            raise ValueError("from_ and at are the same point")
        if aperture is not None:
            view.update(dof=True, aperture=aperture, focus=focus)
        elif focus is not None:
            raise ValueError("focus has an effect only with an aperture")
        settings(view)  # reports errors now
        self._camera = {name: value for name, value in view.items() if value is not None}

    def look(self, direction: FloatsLike | None = None, up: FloatsLike = (0, 0, 1),
             margin: float = 0) -> None:
        """Places the camera so that it shows everything.

        Args:
            direction: that of sight, from the camera on; None: at an angle from above.
            up: the direction that is up in the picture; if it is that of sight, y, else z.
            margin: free space on each side, as a part of the picture, below 0.5.
        """
        towards = None if direction is None else triple("direction", direction)
        if towards == (0, 0, 0) or triple("up", up) == (0, 0, 0):
            raise ValueError("direction and up must not be zero")
        if not 0 <= margin < 0.5:
            raise ValueError(f"margin: expected a number from 0 up to 0.5, found {margin}")
        self._camera = {}
        self._look = (towards, triple("up", up), float(margin))
        self._is_fitted = True
        self._change(geometry=False)

    _is_fitted = False

    # --- pictures

    def render(self, *, progress: Progress = False, **options: Unpack[RenderOptions]) -> Image:
        """Renders a picture.

        Ctrl-C stops it.

        Args:
            progress: True shows a bar; or a function of the stage and its share, 0 to 1.
            options: every rendering option of the command line is a keyword: `size=(1920, 1080)`,
                `samples=64`, `channels=["depth", "id"]`, `soft_shadows=True`; raio.RenderOptions lists
                them. `color_bar`, `legend` and `scale_bar` are those of raio.AnnotationOptions.

        Raises:
            TypeError: an option is unknown.
            ValueError: a value does not fit.
            MemoryError: the scene is too large.
            RuntimeError: something is to be drawn on the picture, but Cairo is missing.
        """
        return Image(self._render(dict(options), progress))

    def start(self, **options: Unpack[RenderOptions]) -> Film:
        """A picture to be refined with Film.add(); options as for render(), without `samples`."""
        for name in ("samples", "noise", "aa", "lens_samples", "sample_range"):
            if name in options:
                raise TypeError(f"{name} is not for start(): Film.add() takes the samples, and "
                                "render() makes parts with sample_range")
        marks, others = split(options)
        Annotations(self, marks)
        settings(others)
        return Film(None, self, dict(options))

    def save(self, path: Path) -> None:
        """Writes the scene: .raio keeps everything but the background, which is an option of pictures;
        .nff, .ply, .gltf and .pov keep what they can."""
        if self._background is not None:
            warnings.warn("the background is not stored; give it again when the scene is loaded",
                          SceneWarning, stacklevel=2)
        self._core().write(os.fspath(path))

    def view(self, **options: Any) -> Any:
        """A live picture in a notebook, which the mouse turns; else the window, where there is one."""
        from .views import view

        return view(self, options)

    @property
    def parts(self) -> tuple[Part, ...]:
        """What was added, in this order; without the primitives of a file."""
        return tuple(self._parts)

    @property
    def bounds(self) -> tuple[tuple[float, float, float], tuple[float, float, float]] | None:
        """The lowest and the highest corner of all primitives; None if there are none."""
        box = self._core().bounds()
        if box is None:
            return None
        (x0, y0, z0), (x1, y1, z1) = box
        return (x0, y0, z0), (x1, y1, z1)

    def __len__(self) -> int:
        """The number of primitives, including those of instances."""
        return int(self._core().primitive_count())

    def __repr__(self) -> str:
        return f"<raio.Scene of {len(self)} primitives>"

    def _repr_png_(self) -> bytes:
        return self.render(size=(640, 480), samples=16)._repr_png_()

    # --- rays

    def intersect(self, origins: FloatsLike, directions: FloatsLike,
                  lengths: FloatsLike | None = None) -> Hits:
        """The nearest hits of rays.

        Args:
            origins: (N, 3), scene units.
            directions: (N, 3), of any length but 0.
            lengths: the farthest distance, a number or (N,); None: infinite.

        Examples:
            >>> import raio
            >>> scene = raio.Scene()
            >>> _ = scene.spheres([[0, 0, 0]], 1)
            >>> float(scene.intersect([[0, 0, 5]], [[0, 0, -1]]).distance[0])
            4.0
        """
        starts, towards, limits = self._rays(origins, directions, lengths)
        with self._lock:
            accel, core = self._accel({}, None)
            spans, own_triangles = self._spans.copy(), core.count(KINDS.index("triangle"))
        return Hits(**accel.closest(starts, towards, limits, True), _spans=spans,
                    _own_triangles=own_triangles)

    def occluded(self, origins: FloatsLike, directions: FloatsLike,
                 lengths: FloatsLike | None = None) -> npt.NDArray[np.bool_]:
        """Whether anything is hit, (N,) bool; arguments as for intersect(). Faster than that."""
        hit = self._accel({}, None)[0].occluded(*self._rays(origins, directions, lengths))
        return hit.view(np.bool_)

    @staticmethod
    def _rays(origins: FloatsLike, directions: FloatsLike, lengths: FloatsLike | None) -> Any:
        starts = numbers("origins", origins, 3)
        towards = numbers("directions", directions, 3, len(starts))
        return starts, towards, None if lengths is None else per_row("lengths", lengths, len(starts))

    # --- the library's scene

    def _core(self) -> _raio.Scene:
        with self._lock:
            if self._built is None:
                self._built = self._make_core()
            return self._built

    def _all_primitives(self) -> _raio.Scene:
        if self._primitives is None:
            core = _raio.Scene() if self._base is None else _raio.Scene(self._base)
            self._spans = {}
            for part in self._parts:
                self._add(part, core)
            self._primitives = core
        return self._primitives

    @staticmethod
    def _check_range(core: _raio.Scene) -> None:
        box = core.bounds()
        if box is None:
            return
        farthest, extent = np.abs(box).max(), np.subtract(box[1], box[0]).max()
        if farthest > 1e18 or 0 < extent < 1e-18:
            raise ValueError(f"positions reach {farthest:g} and are {extent:g} wide; expected at most "
                             "1e18 and at least 1e-18: use other units")
        if farthest > 4000 * extent > 0:
            warnings.warn(f"positions are {farthest:g} away from 0 but only {extent:g} wide: single "
                          f"precision keeps steps of {np.spacing(np.float32(farthest)):g}, and shadows "
                          "may have spots. Subtract their centre first", stacklevel=5)

    def _make_core(self) -> _raio.Scene:
        core = _raio.Scene(self._all_primitives())
        if self._base is None:
            core.set_figure(not self._lights)
            if self._lights:
                core.set_background((1.0, 1.0, 1.0))
            self._check_range(core)
        if self._base is None or self._is_fitted:
            if core.bounds() is not None:
                core.fit_camera(*self._look)
        box = core.bounds()
        for where, is_distant, color, size in self._lights:
            if is_distant:
                low, high = box or ((0, 0, 0), (1, 1, 1))
                middle, reach = (np.add(low, high) / 2, np.linalg.norm(np.subtract(high, low)))
                where = tuple(middle - np.asarray(where) / np.linalg.norm(where) * 1e3 * (reach or 1))
            core.add_light(where, color, size)
        if self._camera:
            view = self._camera
            _, _, _, fov, parallel = core.camera()
            core.set_camera(view["from_"], view["at"], view["up"], view.get("fov", fov),
                            view.get("projection", parallel) in (True, "orthographic"))
        return core

    def _accel(self, options: dict[str, Any], report: Any) -> tuple[_raio.Accel, _raio.Scene]:
        of_structure = structure_options(options)
        key = tuple((name, str(value)) for name, value in of_structure.items() if name != "threads")
        with self._lock:
            core = self._core()
            held = self._accels.get(key)
            if held is not None and held[0] is core:
                return held[2], core
            like = held[2] if held is not None and held[1] == self._geometry else None
            # Frees the structures of earlier primitives before the new one is built.
            self._accels = {k: v for k, v in self._accels.items() if v[1] == self._geometry}
            held = None
            accel = _raio.Accel(core, settings(of_structure), like, report)
            self._accels[key] = (core, self._geometry, accel)
            return accel, core

    def _with_defaults(self, options: dict[str, Any]) -> dict[str, Any]:
        """The options of a picture, with camera and background of the scene."""
        wanted = {name: value for name, value in options.items() if value is not None}
        if self._camera and not ({"from_", "at", "side", "fit"} & wanted.keys()):
            wanted = {**self._camera, **wanted}
        if self._background is not None and "background" not in wanted:
            wanted["background"] = self._background
        if self._base is None:
            if self._lights:
                wanted.setdefault("tone", "srgb")  # colours are light
            elif wanted.get("integrator") == "classic":
                warnings.warn("the scene has no lights, without which `classic` is nearly black; add "
                              "some with light()", stacklevel=4)
        return wanted

    def _render(self, options: dict[str, Any], progress: Progress,
                begun: "_raio.Film | None" = None) -> _raio.Film:
        marks, options = split(options)
        annotations = Annotations(self, marks)
        wanted = self._with_defaults(options)
        all_settings = settings(wanted)
        with Reporter(progress) as reporter:
            accel, _ = self._accel(wanted, reporter.report)
            film = _raio.render(accel, all_settings, begun, reporter.report)
        if annotations:
            annotations.put_on(film)
        return film

    def _scales(self) -> list[Scale]:
        """The scales of all values that are shown as colours."""
        of_file = None if self._base is None else self._base.color_scale()
        own = [] if of_file is None else [of_file]
        return own + [scale for part in self._parts for scale in part._scales()]

    def __getstate__(self) -> dict[str, Any]:
        state = {name: value for name, value in self.__dict__.items()
                 if name not in ("_lock", "_primitives", "_spans", "_built", "_accels", "_geometry")}
        state["_base"] = None if self._base is None else self._base.to_bytes()
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        if state["_base"] is not None:
            self._base = _raio.Scene.from_bytes(state["_base"])
            for text in self._base.warnings():
                warnings.warn(text, SceneWarning, stacklevel=2)
        self._start_caches()


_STRUCTURE = ("accel", "grid_factor", "grid_resolution", "one_sided", "opacity", "counters", "threads")


def structure_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Those of the structure. Pictures of its work need one with counters."""
    found = {name: options[name] for name in _STRUCTURE if name in options}
    channels = options.get("channels") or ()
    shown = {options.get("view"), *(channels.split(",") if isinstance(channels, str) else channels)}
    if shown & {"steps", "tests"}:
        found["counters"] = True
    return found


def _counts(core: _raio.Scene) -> dict[str, int]:
    counts = {kind: core.count(k) for k, kind in enumerate(KINDS)}
    return {**counts, "mesh": core.mesh_triangle_count(), "instance": core.instance_count()}


def _pairs(starts: FloatsLike, ends: FloatsLike) -> Any:
    first = numbers("starts", starts, 3)
    second = numbers("ends", ends, 3)
    if first.shape != second.shape:
        raise ValueError(f"starts and ends: expected equal shapes, found {first.shape} and "
                         f"{second.shape}")
    return first, second
