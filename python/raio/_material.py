"""Surfaces."""

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from . import _raio
from ._arrays import number
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
        texture = _add_texture(core, "texture", self.texture, (3,))
        own = one_color("color", (1.0, 1.0, 1.0) if texture is not None else self.color)
        return core.add_material(color or own, self.kd, self.ks, self.shine, self.transmission,
                                 self.ior, one_color("specular", self.specular), self.roughness,
                                 self.opacity * opacity, texture)


AlphaMode = Literal["opaque", "mask", "blend"]


@dataclass(frozen=True)
class StandardMaterial:
    """A surface of metal, plastic, glass, cloth or lacquer, with the parameters of glTF 2.0
    (docs/materials.md), for `integrator="path"`, the default of scenes with such a material. Others
    show its colour, texture and opacity, matt.

    Textures are (height, width, 3) or (height, width, 4) uint8, top row first, for meshes with uv, and
    are multiplied by their number. Those of colours have display values.

    Attributes:
        color: base colour, of metals' reflection, else diffuse: a name, "#rrggbb", or three numbers of
            light, 0 to 1; None: grey, or white with a texture.
        metallic: 0 dielectric to 1 metal; None: 0, or 1 with a texture.
        roughness: 0 smooth to 1; None: 0.5, or 1 with a texture.
        ior: index of refraction inside, above 0.
        specular: scales the reflection of dielectrics, 0 to 1.
        specular_color: the same, coloured.
        transmission: 0 to 1: the refracted part of the light that is not reflected.
        thin: a sheet, which does not bend light; else the surface of a solid.
        attenuation_color: of white light after the distance in a solid.
        attenuation_distance: scene units, above 0.
        emission: emitted radiance, W/sr/m^2; white paper in full light has 1. Triangles are sampled as
            lights; other primitives light with more noise. None: none, or 1 with a texture.
        clearcoat: a layer of lacquer above everything, 0 to 1.
        clearcoat_roughness: 0 to 1.
        sheen_color: of fibres seen from the side; black: none.
        sheen_roughness: 0 to 1.
        two_sided: whether the back emits, too.
        unlit: shows colour and texture as they are, without light.
        opacity: 0 to 1, times that of the primitives' `opacity`.
        alpha_mode: what the alpha of the texture means: "opaque", nothing; "mask", all or nothing by
            `alpha_cutoff`, of its product with the opacity; "blend", a part of the light.
        alpha_cutoff: the least alpha that "mask" shows.
        normal_scale: scales the slopes of the normal map.
        texture: of the base colour, with alpha if it has four columns.
        metallic_roughness_texture: roughness in green, metallic in blue.
        normal_texture: normals, 0 to 255 for -1 to 1.
        emission_texture: a colour.
        transmission_texture: in red.

    Examples:
        >>> import raio
        >>> gold = raio.StandardMaterial(color=(1, 0.7, 0.3), metallic=1, roughness=0.2)
        >>> raio.Scene().spheres([[0, 0, 0]], 1, material=gold)
        <raio.Spheres of 1>
    """

    color: ColorsLike | None = None
    metallic: float | None = None
    roughness: float | None = None
    ior: float = 1.5
    specular: float = 1
    specular_color: ColorsLike = (1.0, 1.0, 1.0)
    transmission: float = 0
    thin: bool = False
    attenuation_color: ColorsLike = (1.0, 1.0, 1.0)
    attenuation_distance: float = math.inf
    emission: ColorsLike | None = None
    clearcoat: float = 0
    clearcoat_roughness: float = 0
    sheen_color: ColorsLike = (0.0, 0.0, 0.0)
    sheen_roughness: float = 0
    two_sided: bool = True
    unlit: bool = False
    opacity: float = 1
    alpha_mode: AlphaMode = "blend"
    alpha_cutoff: float = 0.5
    normal_scale: float = 1
    texture: npt.NDArray[np.uint8] | None = None
    metallic_roughness_texture: npt.NDArray[np.uint8] | None = None
    normal_texture: npt.NDArray[np.uint8] | None = None
    emission_texture: npt.NDArray[np.uint8] | None = None
    transmission_texture: npt.NDArray[np.uint8] | None = None

    def _add(self, core: _raio.Scene, color: tuple[float, float, float] | None,
             opacity: float) -> int:
        modes = get_args(AlphaMode)
        if self.alpha_mode not in modes:
            raise ValueError(f"alpha_mode: expected {', '.join(modes)}, found {self.alpha_mode!r}")

        def light(name: str, value: Any, otherwise: float) -> tuple[float, float, float]:
            return one_color(name, (otherwise,) * 3 if value is None else value)

        def real(name: str, otherwise: float = 0) -> float:
            value = getattr(self, name)
            return otherwise if value is None else number(name, value)

        grey = 0.8 if self.texture is None else 1
        reflecting = self.metallic_roughness_texture is not None
        return core.add_standard_material(
            color=color or light("color", self.color, grey),
            metallic=real("metallic", 1 if reflecting else 0),
            roughness=real("roughness", 1 if reflecting else 0.5),
            ior=real("ior"), specular=real("specular"),
            specular_color=one_color("specular_color", self.specular_color),
            transmission=real("transmission"), thin=bool(self.thin),
            attenuation_color=one_color("attenuation_color", self.attenuation_color),
            attenuation_distance=real("attenuation_distance"),
            emission=light("emission", self.emission, 0 if self.emission_texture is None else 1),
            clearcoat=real("clearcoat"), clearcoat_roughness=real("clearcoat_roughness"),
            sheen_color=one_color("sheen_color", self.sheen_color),
            sheen_roughness=real("sheen_roughness"), two_sided=bool(self.two_sided),
            unlit=bool(self.unlit), opacity=real("opacity") * opacity,
            alpha_mode=modes.index(self.alpha_mode), alpha_cutoff=real("alpha_cutoff"),
            normal_scale=real("normal_scale"),
            texture=_add_texture(core, "texture", self.texture),
            metallic_roughness_texture=_add_texture(core, "metallic_roughness_texture",
                                                    self.metallic_roughness_texture),
            normal_texture=_add_texture(core, "normal_texture", self.normal_texture),
            emission_texture=_add_texture(core, "emission_texture", self.emission_texture),
            transmission_texture=_add_texture(core, "transmission_texture",
                                              self.transmission_texture))


def _add_texture(core: _raio.Scene, name: str, texture: Any,
                 widths: tuple[int, ...] = (3, 4)) -> int | None:
    if texture is None:
        return None
    texels = np.ascontiguousarray(texture)
    if texels.dtype != np.uint8 or texels.ndim != 3 or texels.shape[2] not in widths:
        shapes = " or ".join(f"(height, width, {width})" for width in widths)
        raise ValueError(f"{name}: expected {shapes} uint8, found {texels.shape} {texels.dtype}")
    return core.add_texture(texels)


# The materials that primitives can have.
Surface = Material | StandardMaterial
