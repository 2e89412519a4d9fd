#include "render/surface.h"

namespace raio {
namespace {

Surface plane_surface(const Geometry& g, uint32_t i, Vec3f p) {
  const Plane& plane = g.plane(i);
  const double height = dot(Vec3d(plane.normal), Vec3d(p) - Vec3d(plane.point));
  p = p - plane.normal * float(height);
  return {p, plane.normal, plane.normal, max_component(abs(p)), g.scene().plane_materials[i]};
}

Surface sphere_surface(const Geometry& g, uint32_t i, Vec3f p) {
  const Sphere s = g.sphere(i);
  const Vec3f outward = p - s.center;
  const Vec3f normal = outward * (1 / length(outward));
  p = s.center + normal * s.radius;
  return {p, normal, normal, max_component(abs(p)) + s.radius, g.scene().sphere_materials[i]};
}

Surface triangle_surface(const Geometry& g, uint32_t i, const Hit& hit) {
  const Triangle t = g.triangle(i);
  const Vec3f ab = t.b - t.a, ac = t.c - t.a;
  const Vec3f p = t.a + ab * hit.u + ac * hit.v;
  const Facet& facet = g.facet(i);
  const float longest = std::max(max_component(abs(ab)), max_component(abs(ac)));
  Surface out{p, facet.normal, facet.normal, max_component(abs(p)) + 2 * longest, facet.material};
  const TriangleIndices* corners = g.corner_normals(i);
  if (!corners) return out;
  const auto normal = [&](size_t k) { return g.scene().normals[(*corners)[k]]; };
  const Vec3f smooth = normal(0) * (1 - hit.u - hit.v) + normal(1) * hit.u + normal(2) * hit.v;
  // Files wind some patches the other way round than their normals point.
  const float side = dot(smooth, facet.normal);
  if (side != 0) out.normal = normalize(side > 0 ? smooth : -smooth);
  return out;
}

Surface cone_surface(const Geometry& g, uint32_t i, Vec3f p) {
  const BakedCone& c = g.cone(i);
  const Vec3f normal = cone_normal(c, p);
  const Vec3d axis(c.axis), x = Vec3d(p) - Vec3d(c.base);
  const double z = dot(x, axis), rho = length(x - axis * z);
  // Along the normal to the surface: the radial error, times the cosine of the slope.
  const double error = rho - (c.base_radius + c.slope * z);
  p = Vec3f(Vec3d(p) - Vec3d(normal) * (error / std::sqrt(1 + double(c.slope) * c.slope)));
  const float extent = c.height + std::max(c.base_radius, c.base_radius + c.slope * c.height);
  return {p, normal, normal, max_component(abs(p)) + extent, g.scene().cone_materials[i]};
}

}  // namespace

Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  const uint32_t i = item_index(hit.item);
  switch (item_kind(hit.item)) {
    case ItemKind::plane:
      return plane_surface(geometry, i, ray.at(hit.t));
    case ItemKind::sphere:
      return sphere_surface(geometry, i, ray.at(hit.t));
    case ItemKind::triangle:
      return triangle_surface(geometry, i, hit);
    case ItemKind::cone:
      return cone_surface(geometry, i, ray.at(hit.t));
  }
  return {};
}

}  // namespace raio
