#include "integrate/normal_map.h"

#include <cmath>

namespace raio::core {

std::optional<TextureAxes> texture_axes(const Geometry& geometry, InstanceId instance,
                                        uint32_t triangle) {
  if (instance) {
    const Geometry::Placed at = geometry.placed(instance);
    auto axes = texture_axes(at.object, at.inner, triangle);
    if (!axes) return {};
    const Placement place = geometry.placement(at.index);
    return TextureAxes{place.vector(axes->u), place.vector(axes->v)};
  }
  const std::span<const Uv> uv = geometry.texture_coordinates();
  if (uv.empty()) return {};
  const TriangleIndices& at = geometry.corners(triangle);
  const auto edge = [&](size_t corner) {
    return Vec3d(geometry.positions()[at[corner]]) - Vec3d(geometry.positions()[at[0]]);
  };
  const auto along = [&](size_t corner, size_t axis) {
    return double(uv[at[corner]][axis]) - double(uv[at[0]][axis]);
  };
  const double u1 = along(1, 0), v1 = along(1, 1), u2 = along(2, 0), v2 = along(2, 1);
  // Only its sign counts: negative where the triangle shows the picture's back.
  const double area = u1 * v2 - u2 * v1;
  if (!(std::isfinite(area) && area != 0)) return {};
  const double sign = area > 0 ? 1 : -1;
  return TextureAxes{(edge(1) * v2 - edge(2) * v1) * sign, (edge(2) * u1 - edge(1) * u2) * sign};
}

// The frame is that of the point's normal, not of MikkTSpace, which joins the frames of neighbours:
// edges between triangles show where their coordinates are bent.
Vec3f mapped_normal(Vec3f normal, const TextureAxes& axes, Rgb texel, float scale) {
  const Vec3d n(normal);
  const Vec3d right = axes.u - n * dot(n, axes.u), across = cross(n, right);
  const Vec3d up = dot(across, axes.v) < 0 ? -across : across;
  const double size = length(right);  // of both
  if (!(size > 0)) return normal;
  const Vec3d t = Vec3d(texel) * 2.0 - Vec3d(1);
  const double by = double(scale) / size;
  const Vec3d tilted = right * (t.x * by) + up * (t.y * by) + n * t.z;
  const double stretch = length(tilted);
  return stretch > 1e-6 && std::isfinite(stretch) ? Vec3f(tilted * (1 / stretch)) : normal;
}

Vec3f bent_normal(Vec3f normal, Vec3f geometric, Vec3f to_eye) {
  // The least cosine of mirrored rays and the surface; lower ones meet few microfacets.
  constexpr double kLeast = 0.01;
  const Vec3d g(geometric), eye(to_eye);
  Vec3d n(normal);
  // A normal below the surface, of a map on a smooth one, first rises to its plane.
  if (const double above = dot(n, g); above < 0) n = n - g * above;
  if (!(dot(n, n) > 1e-12)) return geometric;
  const Vec3d mirrored = n * (2 * dot(n, eye) / dot(n, n)) - eye;
  const double cosine = dot(mirrored, g);
  if (cosine >= kLeast) return normal;
  // Straight up to that height. The half vector mirrors the eye there (Keller et al. 2017, "The
  // Iray Light Transport Simulation and Rendering System").
  const Vec3d raised = normalize(mirrored + g * (kLeast - cosine));
  return Vec3f(normalize(eye + raised));
}

}  // namespace raio::core
