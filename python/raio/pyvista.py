"""`plotter.raio`: what a PyVista plotter shows, rendered by Raio (docs/programs.md).

PyVista 0.48 or newer finds this module by its entry point; `import raio.pyvista` registers it, too.
VTK maps scalars to colours, and draws what has no counterpart in a scene: scalar bars, axes and text.
"""

import math
import os
from typing import Any, NamedTuple, Unpack

import numpy as np
import numpy.typing as npt
import pyvista
from vtkmodules.vtkRenderingCore import vtkProperty

from ._color import linear
from ._film import Path
from ._material import Material
from ._options import pixel_size
from ._overlay import over, overlay_of
from ._render_options import RenderOptions
from ._scene import Scene
from ._vtk import RGBA, UV, attributes_of, leaves, map_scalars, visible_blocks
from .convert import Paint, add_surface, light_of, surface_of, warn

if not hasattr(pyvista, "register_plotter_component"):
    raise ImportError(f"plotter.raio needs PyVista 0.48 or newer; found {pyvista.__version__}")

Array = npt.NDArray[Any]
_POINTS, _EDGES = 0, 1  # vtkProperty.GetRepresentation()
_FLAT, _PBR = 0, 3  # vtkProperty.GetInterpolation()


@pyvista.register_plotter_component("raio")
class Component:
    """`plotter.raio` renders what the plotter shows.

    Kept: the camera; meshes, lines and points with VTK's colours, opacity, textures, edges, matrices
    and visibility; the background; and lights that stand in the scene. Points and lines are spheres
    and cylinders of the size in which they appear. Lights that follow the camera are replaced by
    Raio's own, which follows it as well. One SceneWarning names all that is left out.
    """

    def __init__(self, plotter: Any):
        self._plotter = plotter

    def scene(self) -> Scene:
        """A raio.Scene of the active renderer, with its camera, background and lights."""
        self._check_open()
        left_out: list[str] = []
        shown = _Shown(self._plotter, self._plotter.renderer, left_out)
        scene = shown.scene()
        if shown.renderer.GetGradientBackground():
            left_out.append("the upper colour of the background")
        _report(left_out)
        return scene

    def render(self, path: Path | None = None, *, overlay: bool = True,
               **options: Unpack[RenderOptions]) -> Any:
        """Renders the window with all its subplots.

        Args:
            path: where to write the picture, in any format of Pillow: .png, .jpg, .tif, .pdf.
                `plotter.raio.scene().render()` has light and channels, for .exr.
            overlay: lays scalar bars, axes, labels and text over the picture, as VTK draws them. This
                needs OpenGL.
            options: as for Scene.render(). `size` is that of the window, unless given.

        Returns:
            a PIL.Image.Image, which numpy.asarray() takes.

        Raises:
            RuntimeError: the plotter is closed.
            TypeError, ValueError: as for Scene.render(); or Pillow cannot write such a file.
        """
        from PIL import Image

        self._check_open()
        suffix = "" if path is None else os.path.splitext(os.fspath(path))[1].lower()
        if path is not None and suffix not in Image.registered_extensions():
            raise ValueError(f"path: Pillow cannot write {suffix!r}; .png is a format that it can, and "
                             "plotter.raio.scene().render(...).save(path) writes .exr")
        for name in ("width", "crop", "shard", "sample_range"):
            if name in options:
                raise TypeError(f"{name} is not for a window; plotter.raio.scene().render() takes it")
        size = options.pop("size", None) or self._plotter.window_size
        width, height = pixel_size(size)
        left_out: list[str] = []
        canvas = np.zeros((height, width, 4), np.float32)
        all_shown = [_Shown(self._plotter, r, left_out) for r in self._plotter.renderers]
        for shown in all_shown:
            x0, y0, x1, y1 = np.rint(np.multiply(shown.renderer.GetViewport(), (width, height) * 2)).astype(int)
            canvas[height - y1:height - y0, x0:x1] = shown.picture((x1 - x0, y1 - y0), dict(options))
        if overlay:
            canvas = over(overlay_of(self._plotter, all_shown, (width, height), left_out), canvas)
        _report(left_out)
        alpha = canvas[..., 3:]
        canvas[..., :3] /= np.maximum(alpha, 1e-6)
        pixels = np.rint(canvas.clip(0, 1) * 255).astype(np.uint8)
        image = Image.fromarray(pixels if (pixels[..., 3] < 255).any() else pixels[..., :3])
        if path is not None:
            dpi = options.get("dpi")
            image.save(path, **({} if dpi is None else {"dpi": (dpi, dpi)}))
        return image

    def show(self, **options: Any) -> Any:
        """A live picture of the active renderer in a notebook, else the window: Scene.view()."""
        return self.scene().view(**{"size": tuple(self._plotter.window_size), **options})

    def _check_open(self) -> None:
        if self._plotter.render_window is None:
            raise RuntimeError("the plotter is closed; use plotter.raio before plotter.show(), or "
                               "plotter.show(auto_close=False)")


def _report(left_out: list[str]) -> None:
    if left_out:
        warn(f"left out: {', '.join(dict.fromkeys(left_out))}")


class _View(NamedTuple):
    """A camera of VTK, for pictures of `height` pixels."""

    position: Array
    towards: Array  # the unit vector of sight
    half: float  # the tangent of half the vertical angle; half the visible height if parallel
    is_parallel: bool
    height: float

    def pixel(self, points: Any) -> Array:
        """The size of a pixel at each point, in scene units."""
        depth = (np.asarray(points) - self.position) @ self.towards
        near = 1e-6 * np.abs(depth).max(initial=1e-30)
        scale = np.ones(len(depth)) if self.is_parallel else np.maximum(depth, near)
        return 2 * self.half / self.height * scale

    def fronts(self, surface: Any) -> Array:
        """Which faces turn their front to the camera, (N,) bool."""
        normals = surface.compute_normals(
            point_normals=False, consistent_normals=False, split_vertices=False,
            auto_orient_normals=False).cell_data["Normals"]
        sight = self.towards if self.is_parallel else surface.cell_centers().points - self.position
        return np.asarray((np.asarray(normals) * sight).sum(axis=1) < 0)


class _Look(NamedTuple):
    """How a mapper and a property show a surface that has the arrays RGBA or UV."""

    mapper: Any
    prop: Any
    material: Material | None

    def paint(self, surface: Any) -> Paint:
        opacity = self.prop.GetOpacity()
        of_faces = None if self.material is None else {
            "uv": surface.point_data[UV], "material": self.material, "opacity": opacity}
        for data, by_cell in ((surface.point_data, False), (surface.cell_data, True)):
            if RGBA in data:
                return Paint(light_of(np.asarray(data[RGBA]), opacity), by_cell, {}, of_faces)
        return Paint(None, False, {"colors": _light(self.prop.GetColor()), "opacity": opacity}, of_faces)


class _Shown:
    """What a renderer of a plotter shows."""

    def __init__(self, plotter: Any, renderer: Any, left_out: list[str]):
        self.renderer = renderer
        self.left_out = left_out
        self.mattes: list[Any] = []  # actors of Raio, behind which VTK's are hidden
        self.hidden: list[Any] = []  # those that VTK must not draw
        self.others: list[Any] = []  # those that VTK draws
        self._plotter = plotter
        if not renderer.camera.is_set:  # as PyVista does when it first shows a plotter
            renderer.camera_position = renderer.get_default_cam_pos()
            renderer.ResetCamera()
            renderer.camera.is_set = False

    def picture(self, size: tuple[int, int], options: dict[str, Any]) -> Array:
        """Display values and opacity, (height, width, 4) float32, premultiplied."""
        scene = self.scene()
        is_gradient = self.renderer.GetGradientBackground() and (
            scene.background != "transparent" and "background" not in options)
        if is_gradient:
            options = {**options, "background": "transparent"}
        out: Array = scene.render(size=size, **options).display().astype(np.float32) / 255
        out[..., :3] *= out[..., 3:]
        if not is_gradient:
            return out
        ends = np.array([self.renderer.GetBackground2(), self.renderer.GetBackground()])
        share = (np.arange(size[1])[:, None, None] + 0.5) / size[1]
        rows = ends[0] * (1 - share) + ends[1] * share
        return over(out, np.concatenate((rows, np.ones_like(share)), axis=2))

    def scene(self) -> Scene:
        is_transparent = self._plotter.theme.transparent_background
        scene = Scene("transparent" if is_transparent else _light(self.renderer.GetBackground()))
        view = self._place_camera(scene)
        for prop in self.renderer.GetViewProps():
            if prop.GetVisibility():
                for actor, matrix in leaves(prop):
                    self._add(scene, actor, matrix, view)
        self._add_lights(scene)
        if self.renderer.GetPass() is not None:
            self.left_out.append("render passes")
        return scene

    def _place_camera(self, scene: Scene) -> _View:
        camera, (_, bottom, _, top) = self.renderer.camera, self.renderer.GetViewport()
        matrix = camera.GetProjectionTransformMatrix(self.renderer.GetTiledAspectRatio(), -1, 1)
        half, is_parallel = 1 / matrix.GetElement(1, 1), bool(camera.GetParallelProjection())
        position, focal = np.array(camera.GetPosition()), np.array(camera.GetFocalPoint())
        towards, tangent = np.array(camera.GetDirectionOfProjection()), half
        if is_parallel:  # VTK also shows what is behind such a camera
            low, high = np.reshape(self.renderer.ComputeVisiblePropBounds(), (3, 2)).T
            behind = np.linalg.norm(high - low) + np.linalg.norm(focal - (low + high) / 2)
            distance = camera.GetDistance() + (float(behind) if low[0] <= high[0] else 0)
            position, tangent = focal - towards * distance, half / distance
        if camera.GetWindowCenter() != (0, 0) or camera.GetViewShear() != (0, 0, 1):
            self.left_out.append("shift and shear of the camera")
        scene.camera(position, focal, camera.GetViewUp(), math.degrees(2 * math.atan(tangent)),
                     projection="orthographic" if is_parallel else "perspective")
        return _View(position, towards, half, is_parallel, self._plotter.window_size[1] * (top - bottom))

    def _add_lights(self, scene: Scene) -> None:
        lights = [light for light in self.renderer.lights if light.GetSwitch()]
        if not any(light.LightTypeIsSceneLight() for light in lights):
            return
        self.renderer.UpdateLightsGeometryToFollowCamera()
        for light in lights:
            color = linear(light.GetDiffuseColor()) * light.GetIntensity()
            position = np.array(light.GetTransformedPosition())
            if light.GetPositional():
                scene.light(position, color=color)
                if light.GetConeAngle() < 90:
                    self.left_out.append("cones of lights")
                if light.GetAttenuationValues() != (1, 0, 0):
                    self.left_out.append("attenuation of lights")
            else:
                scene.light(direction=light.GetTransformedFocalPoint() - position, color=color)

    def _add(self, scene: Scene, actor: Any, matrix: Any, view: _View) -> None:
        mapper = actor.GetMapper() if actor.IsA("vtkActor") else None
        for kind, plural in (("vtkVolume", "volumes"), ("vtkSkybox", "skyboxes"),
                             ("vtkGlyph3DMapper", "glyphs that VTK makes while it draws")):
            if actor.IsA(kind) or (mapper is not None and mapper.IsA(kind)):
                self.hidden.append(actor)
                self.left_out.append(plural)
                return
        if mapper is None or actor.IsA("vtkCubeAxesActor"):
            self.others.append(actor)
            return
        (self.hidden if mapper.IsA("vtkPointGaussianMapper") else self.mattes).append(actor)
        mapper.Update()
        attributes = attributes_of(mapper)
        for block in visible_blocks(mapper):
            prop = vtkProperty()
            prop.DeepCopy(actor.GetProperty())
            if attributes is not None and attributes.HasBlockColor(block):
                prop.SetColor(attributes.GetBlockColor(block))
            if attributes is not None and attributes.HasBlockOpacity(block):
                prop.SetOpacity(attributes.GetBlockOpacity(block))
            surface = surface_of(block).copy(deep=False)
            look = _Look(mapper, prop, self._attach_colors(surface, mapper, actor))
            if not matrix.IsIdentity():
                surface = surface.transform(matrix, inplace=False)
            for plane in mapper.GetClippingPlanes() or ():
                surface = surface.clip(normal=plane.GetNormal(), origin=plane.GetOrigin(), invert=False)
            self._add_sides(scene, surface, look, actor.GetBackfaceProperty(), view)

    def _attach_colors(self, surface: Any, mapper: Any, actor: Any) -> Material | None:
        """Gives the surface arrays of its colours, and returns the material with its texture."""
        material = map_scalars(surface, mapper) if mapper.GetScalarVisibility() else None
        texture = actor.GetTexture() or actor.GetProperty().GetTexture("albedoTex")
        coordinates = surface.active_texture_coordinates
        if texture is None or coordinates is None:
            return material
        texture.Update()
        image = pyvista.wrap(texture.GetInput())
        texels = image.active_scalars.reshape(*image.dimensions[1::-1], -1)[::-1]
        if texels.dtype != np.uint8:
            self.left_out.append(f"textures of {texels.dtype}")
            return material
        if texels.shape[2] in (2, 4):
            self.left_out.append("opacity of textures")
        surface.point_data[UV] = coordinates if texture.GetRepeat() else coordinates.clip(0, 1)
        return Material(texture=texels[..., :3] if texels.shape[2] > 2 else texels[..., [0, 0, 0]])

    def _add_sides(self, scene: Scene, surface: Any, look: _Look, back: Any, view: _View) -> None:
        prop = look.prop
        if not prop.GetLighting() and surface.GetNumberOfPolys():
            self.left_out.append("surfaces without shading, which are lit")
        if prop.GetInterpolation() == _PBR:
            self.left_out.append("metal and roughness")
        culls, culls_front = prop.GetBackfaceCulling(), prop.GetFrontfaceCulling()
        if surface.GetNumberOfPolys() == surface.n_cells and (back is not None or culls or culls_front):
            is_front = view.fronts(surface)
            if not culls:
                behind = surface.remove_cells(is_front)
                self._add_cells(scene, behind, look._replace(prop=back or prop), view)
            if culls_front:
                return
            surface = surface.remove_cells(~is_front)
        self._add_cells(scene, surface, look, view)

    def _add_cells(self, scene: Scene, surface: Any, look: _Look, view: _View) -> None:
        mapper, prop = look.mapper, look.prop
        is_gaussian = mapper.IsA("vtkPointGaussianMapper")
        style = _POINTS if is_gaussian else prop.GetRepresentation()
        if style not in (_POINTS, _EDGES) and prop.GetEdgeVisibility():
            edges = surface.extract_all_edges()
            is_line = prop.GetUseLineWidthForEdgeThickness()
            radii = view.pixel(edges.points) * (prop.GetLineWidth() if is_line else prop.GetEdgeWidth()) / 2
            ink = {"colors": _light(prop.GetEdgeColor()), "opacity": prop.GetEdgeOpacity()}
            add_surface(scene, edges, Paint(None, False, ink), False, radii, radii)
        if style == _POINTS:
            points = pyvista.PolyData(surface.points)
            points.point_data.update(surface.point_data)
            if RGBA in surface.cell_data:
                self.left_out.append("colours of cells on points")
            surface = points
        elif style == _EDGES:
            surface = surface.extract_all_edges()
        pixel = view.pixel(surface.points)
        radii = pixel * prop.GetPointSize() / 2
        if is_gaussian:
            scales = mapper.GetScaleArray()
            radii = mapper.GetScaleFactor() * np.asarray(
                surface.point_data[scales] if scales else np.ones(surface.n_points))
            if mapper.GetEmissive():
                self.left_out.append("the glow of Gaussian points")
        add_surface(scene, surface, look.paint(surface), False if prop.GetInterpolation() == _FLAT else None,
                    radii, pixel * prop.GetLineWidth() / 2)


def _light(color: Any) -> tuple[float, ...]:
    return tuple(linear(color).tolist())
