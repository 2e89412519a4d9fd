// Normal maps of glTF 2.0: pictures whose colours tilt the normals of triangles.
#pragma once

#include <optional>

#include "accel/geometry.h"

namespace raio::core {

/// The directions on a triangle's plane in which its texture coordinates increase, of any length.
struct TextureAxes {
  Vec3d u, v;
};

/// In the scene's space. Nothing where the triangle has no texture coordinates, or all of its
/// points have the same along a line. `triangle`: its index in the object of `instance`.
std::optional<TextureAxes> texture_axes(const Geometry& geometry, InstanceId instance,
                                        uint32_t triangle);

/// The unit normal that a map gives to a surface: `texel` from 0 to 1, where red points along
/// `axes.u` and green along `axes.v`; `scale` multiplies both. `normal`: the surface's own, unit
/// and outward. It is the result where the map's normal has no direction.
Vec3f mapped_normal(Vec3f normal, const TextureAxes& axes, Rgb texel, float scale);

/// The normal, bent as far as needed for a mirror to reflect light from above the surface to the
/// eye. Without this, parts of bumps that face away from the eye would be black. All are unit
/// vectors; `geometric` and `to_eye` are on the same side of the surface.
Vec3f bent_normal(Vec3f normal, Vec3f geometric, Vec3f to_eye);

}  // namespace raio::core
