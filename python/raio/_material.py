"""Surfaces."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from . import _raio
from ._color import ColorsLike, one_color


@dataclass(frozen=True)
class Material:
    """A surface. The defaults are matt; figures lit from everywhere (`ambient`) use only colour,
    texture and opacity, `classic` pictures the rest (docs/shading.md).

    Attributes:
        color: a name, "#rrggbb", or three numbers of light.
        kd: diffuse part.
        ks: mirror part.
        shine: exponent of the highlight.
        transmission: part of the refracted ray.
        ior: index of refraction.
        specular: colour of highlights and mirrors.
        roughness: spread of mirrored rays.
        opacity: 0 to 1.
        texture: (height, width, 3) uint8, top row first, for meshes with uv; replaces the colour.
    """

    color: ColorsLike = (0.8, 0.8, 0.8)
    kd: float = 1
    ks: float = 0
    shine: float = 1
    transmission: float = 0
    ior: float = 1
    specular: ColorsLike = (1.0, 1.0, 1.0)
    roughness: float = 0
    opacity: float = 1
    texture: npt.NDArray[np.uint8] | None = None

    def _add(self, core: _raio.Scene, color: tuple[float, float, float] | None,
             opacity: float) -> int:
        texture = None
        if self.texture is not None:
            texels = np.ascontiguousarray(self.texture)
            if texels.dtype != np.uint8 or texels.ndim != 3 or texels.shape[2] != 3:
                raise ValueError(f"texture: expected (height, width, 3) uint8, found {texels.shape} "
                                 f"{texels.dtype}")
            texture = core.add_texture(texels)
        own = one_color("color", (1.0, 1.0, 1.0) if texture is not None else self.color)
        return core.add_material(color or own, self.kd, self.ks, self.shine, self.transmission,
                                 self.ior, one_color("specular", self.specular), self.roughness,
                                 self.opacity * opacity, texture)
