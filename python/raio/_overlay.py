"""What VTK draws over a picture of Raio: scalar bars, axes, labels and text."""

import subprocess
import sys
from contextlib import ExitStack
from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista
from pyvista.plotting.background_renderer import BackgroundRenderer
from vtkmodules.vtkRenderingCore import (
    vtkCompositeDataDisplayAttributes,
    vtkProperty,
    vtkWindowToImageFilter,
)

from ._vtk import attributes_of
from .convert import blocks_of

Array = npt.NDArray[Any]


def over(front: Array, back: Array) -> Array:
    """A picture over another one, both premultiplied."""
    out: Array = front + (1 - front[..., 3:]) * back
    return out


def overlay_of(plotter: Any, all_shown: list[Any], size: tuple[int, int], left_out: list[str]) -> Array:
    """What VTK draws in front of Raio's objects: display values and opacity, premultiplied.

    It is drawn twice: on black, with Raio's objects in black, and on white, with them in white. The
    difference is what shows through.
    """
    window = plotter.render_window
    renderers = [r for r in window.GetRenderers() if r.GetDraw() and r not in plotter.renderers]
    backgrounds = [r for r in renderers if isinstance(r, BackgroundRenderer)]
    if backgrounds:
        left_out.append("background images")
    is_empty = len(renderers) == len(backgrounds) and not any(shown.others for shown in all_shown)
    if not is_empty and not has_opengl(window):
        left_out.append("scalar bars, axes and text, which need OpenGL")
        is_empty = True
    if is_empty:
        return np.zeros((size[1], size[0], 4), np.float32)
    with ExitStack() as undo:
        if not window.GetNeverRendered():  # shows what it did
            undo.callback(window.Render)

        def put(target: Any, name: str, *values: Any) -> None:
            before = getattr(target, "Get" + name)()
            undo.callback(getattr(target, "Set" + name), *(before if type(before) is tuple else (before,)))
            getattr(target, "Set" + name)(*values)

        put(window, "ShowWindow", False)
        put(window, "UseOffScreenBuffers", True)
        put(window, "DPI", round(window.GetDPI() * size[1] / plotter.window_size[1]))
        put(window, "Size", *size)
        for renderer in backgrounds:
            put(renderer, "Draw", False)
        actors = []
        for shown in all_shown:
            if all(map(_is_in_front, shown.others)):
                shown.hidden += shown.mattes  # which may take long to draw
            else:
                actors += shown.mattes
            put(shown.renderer, "Background", 0, 0, 0)
            put(shown.renderer, "GradientBackground", False)
            put(shown.renderer, "Pass", None)
            for actor in shown.hidden:
                put(actor, "Visibility", False)
        for actor in actors:
            mapper, matte = actor.GetMapper(), vtkProperty()
            matte.DeepCopy(actor.GetProperty())
            matte.RemoveAllTextures()
            matte.LightingOff()
            put(actor, "Property", matte)
            put(actor, "BackfaceProperty", None)
            put(actor, "Texture", None)
            put(mapper, "ScalarVisibility", False)
            looks = attributes_of(mapper)
            if looks is not None:
                own = vtkCompositeDataDisplayAttributes()
                for block in blocks_of(pyvista.wrap(mapper.GetInputDataObject(0, 0))):
                    if looks.HasBlockVisibility(block):
                        own.SetBlockVisibility(block, looks.GetBlockVisibility(block))
                put(mapper, "CompositeDataDisplayAttributes", own)

        def drawn_on(level: float) -> Array:
            for shown in all_shown:
                shown.renderer.SetBackground(level, level, level)
            for actor in actors:
                actor.GetProperty().SetColor(level, level, level)
                actor.GetProperty().SetEdgeColor(level, level, level)
            window.Render()
            grabbed = vtkWindowToImageFilter()
            grabbed.SetInput(window)
            grabbed.ReadFrontBufferOff()
            grabbed.Update()
            pixels = pyvista.wrap(grabbed.GetOutput()).active_scalars
            return np.asarray(pixels.reshape(size[1], size[0], 3)[::-1], np.float32) / 255

        black, white = drawn_on(0), drawn_on(1)
    alpha = 1 - (white - black).mean(axis=2, keepdims=True)
    return np.concatenate((black, alpha), axis=2).clip(0, 1)


def _is_in_front(prop: Any) -> bool:
    """Whether nothing hides it; labels may be hidden by what is before their points."""
    mapper = prop.GetMapper() if prop.IsA("vtkActor2D") else None
    return bool(prop.IsA("vtkActor2D")) and not (mapper and mapper.IsA("vtkLabelPlacementMapper"))


def has_opengl(window: Any) -> bool:
    # VTK's last resort is OSMesa, whether it is there or not; without it, drawing ends the program.
    if window.GetClassName() != "vtkOSOpenGLRenderWindow":
        return bool(window.SupportsOpenGL())
    code = "from vtkmodules.vtkRenderingOpenGL2 import vtkOSOpenGLRenderWindow as W; W().Render()"
    return subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == 0
