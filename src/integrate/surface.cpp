#include "integrate/surface.h"

#include "base/placement.h"

namespace raio::core {
namespace {

// At the ray's hit, with the smooth normal if the triangle has one.
SurfacePoint triangle_point(const Geometry& geometry, uint32_t index, Vec3f p, const Hit& hit) {
  SurfacePoint point{p, geometry.facet(index).normal, 0};
  if (const TriangleIndices* corners = geometry.corner_normals(index)) {
    const auto n = geometry.normals();
    const Vec3f smooth = n[(*corners)[0]] * (1 - hit.u - hit.v) + n[(*corners)[1]] * hit.u +
                         n[(*corners)[2]] * hit.v;
    // As in surfaces.cpp: in files, the winding of some patches contradicts their normals.
    if (const float side = dot(smooth, point.normal); side != 0)
      point.normal = side > 0 ? normalize(smooth) : -normalize(smooth);
  }
  return point;
}

}  // namespace

Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  if (hit.instance) {
    const Geometry::Placed at = geometry.placed(hit.instance);
    const Placement place = geometry.placement(at.index);
    double stretch = 0;
    const Ray there = place.to_object(ray, stretch);
    Surface surface = surface_at(
        at.object, there, {float(double(hit.t) * stretch), hit.primitive, hit.u, hit.v, at.inner});
    surface.point = Vec3f(place.point(Vec3d(surface.point)));
    surface.normal = Vec3f(place.normal(Vec3d(surface.normal)));
    surface.extent *= float(place.longest());
    return surface;
  }
  const PrimitiveKind its_kind = geometry.kind_of(hit.primitive);
  const uint32_t index = geometry.index_of(its_kind, hit.primitive);
  const Vec3f p = ray.at(hit.t);
  const SurfacePoint point = with_kind(its_kind, [&]<PrimitiveKind kind> {
    if constexpr (kind == PrimitiveKind::triangle)
      return triangle_point(geometry, index, p, hit);
    else
      return surface_point(at_time(geometry.get<kind>(index), ray.time), p);
  });
  return {point, geometry.material_of(hit.primitive)};
}

}  // namespace raio::core
