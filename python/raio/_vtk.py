"""What VTK knows about actors and their mappers: parts, blocks, and colours of scalars."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pyvista
from vtkmodules.vtkCommonCore import reference
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import vtkPolyDataMapper

from ._material import Material
from .convert import blocks_of

# Arrays that filters carry along with a surface.
RGBA, UV = "raio: colours", "raio: texture"
_TEXTURE_SIDE = 16384  # the most texels of one side in Raio


def leaves(prop: Any) -> Iterator[tuple[Any, vtkMatrix4x4]]:
    """The actors of an actor or an assembly, with their matrices."""
    prop.InitPathTraversal()
    while (path := prop.GetNextPath()) is not None:
        node, matrix = path.GetLastNode(), vtkMatrix4x4()
        if node.GetMatrix() is not None:
            matrix.DeepCopy(node.GetMatrix())
        yield node.GetViewProp(), matrix


def attributes_of(mapper: Any) -> Any:
    """The looks of blocks, where a mapper has such."""
    get = getattr(mapper, "GetCompositeDataDisplayAttributes", None)
    return None if get is None else get()


def visible_blocks(mapper: Any) -> Iterator[Any]:
    """The visible datasets of a mapper."""
    attributes, data = attributes_of(mapper), mapper.GetInputDataObject(0, 0)
    for block in () if data is None else blocks_of(pyvista.wrap(data)):
        if attributes is None or not attributes.HasBlockVisibility(block) or (
                attributes.GetBlockVisibility(block)):
            yield block


def map_scalars(surface: Any, mapper: Any) -> Material | None:
    """Attaches the colours that VTK maps scalars to; returns the colour map as a texture if VTK maps
    what it has interpolated between points."""
    own, by_cell = vtkPolyDataMapper(), reference(0)
    own.ShallowCopy(mapper)
    own.InterpolateScalarsBeforeMappingOff()
    colors = own.MapScalars(surface, 1, by_cell)
    if colors is None:
        return None
    rgba = np.array(pyvista.convert_array(colors))
    (surface.cell_data if by_cell == 1 else surface.point_data)[RGBA] = rgba
    own.SetInterpolateScalarsBeforeMapping(mapper.GetInterpolateScalarsBeforeMapping())
    if (rgba[:, 3] < 255).any() or own.MapScalars(surface, 1, by_cell) is not None:
        return None
    uv = np.array(pyvista.convert_array(own.GetColorCoordinates()))
    image = pyvista.wrap(own.GetColorTextureMap())
    texels = image.active_scalars.reshape(2, image.dimensions[0], -1)[..., :3]
    # VTK takes the nearest texel, and the last ones for all values beyond; Raio interpolates and
    # repeats. So there are many texels, and as many spans of the map on both sides as values need.
    most = _TEXTURE_SIDE // texels.shape[1]
    if most == 0:
        return None
    beyond = min(math.ceil(max(-uv[:, 0].min(), uv[:, 0].max() - 1, 0)), (most - 1) // 2)
    spans = 2 * beyond + 1
    numbers, nan = np.repeat(texels, most // spans, axis=1)
    is_nan = uv[:, 1] > 0.5
    rows = [nan] * 10 + [numbers] * 10 if is_nan.any() else [numbers]
    surface.point_data[UV] = np.stack((
        (uv[:, 0].clip(-beyond, beyond + 1) + beyond) / spans, np.where(is_nan, 0.97, 0.45)), axis=1)
    return Material(texture=np.pad(rows, ((0, 0), (beyond * len(numbers),) * 2, (0, 0)), mode="edge"))
