#include "integrate/surface.h"

namespace raio {
namespace {

// Where the ray says, and with the smooth normal of a triangle that has one.
SurfacePoint triangle_point(const Geometry& geometry, uint32_t index, Vec3f p, const Hit& hit) {
  SurfacePoint point{p, geometry.facet(index).normal, 0};
  if (const TriangleIndices* corners = geometry.corner_normals(index)) {
    const auto n = geometry.normals();
    const Vec3f smooth = n[(*corners)[0]] * (1 - hit.u - hit.v) + n[(*corners)[1]] * hit.u +
                         n[(*corners)[2]] * hit.v;
    if (dot(smooth, smooth) > 0) point.normal = normalize(smooth);
  }
  return point;
}

}  // namespace

Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  const uint32_t index = primitive_index(hit.item);
  const Vec3f p = ray.at(hit.t);
  const SurfacePoint point = with_kind(primitive_kind(hit.item), [&]<PrimitiveKind kind> {
    if constexpr (kind == PrimitiveKind::triangle)
      return triangle_point(geometry, index, p, hit);
    else
      return surface_point(at_time(geometry.get<kind>(index), ray.time), p);
  });
  return {point, geometry.material_of(hit.item)};
}

}  // namespace raio
