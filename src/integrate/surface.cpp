#include "integrate/surface.h"

namespace raio {

Surface plane_surface(const Geometry& geometry, uint32_t index, Vec3f p) {
  const Plane& plane = geometry.plane(index);
  const double height = dot(Vec3d(plane.normal), Vec3d(p) - Vec3d(plane.point));
  p = p - plane.normal * float(height);
  return {p, plane.normal, 0, geometry.scene().plane_materials[index]};
}

Surface cone_surface(const Geometry& geometry, uint32_t index, Vec3f p) {
  const BakedCone& c = geometry.cone(index);
  const Vec3f normal = cone_normal(c, p);
  const Vec3d axis(c.axis), x = Vec3d(p) - Vec3d(c.base);
  const double z = dot(x, axis), rho = length(x - axis * z);
  // Along the normal to the surface: the radial error, times the cosine of the slope.
  const double error = rho - (c.base_radius + c.slope * z);
  p = Vec3f(Vec3d(p) - Vec3d(normal) * (error / std::sqrt(1 + double(c.slope) * c.slope)));
  const float extent = c.height + std::max(c.base_radius, c.base_radius + c.slope * c.height);
  return {p, normal, extent, geometry.scene().cone_materials[index]};
}

Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  const Scene& scene = geometry.scene();
  const uint32_t index = item_index(hit.item);
  const Vec3f p = ray.at(hit.t);
  switch (item_kind(hit.item)) {
    case ItemKind::plane:
      return plane_surface(geometry, index, p);
    case ItemKind::cone:
      return cone_surface(geometry, index, p);
    case ItemKind::sphere: {
      const Sphere sphere = geometry.sphere(index);
      const Vec3f normal = normalize(p - sphere.center);
      return {sphere.center + normal * sphere.radius, normal, sphere.radius,
              scene.sphere_materials[index]};
    }
    case ItemKind::triangle:
      break;
  }
  const Facet& facet = geometry.facet(index);
  Surface surface{p, facet.normal, 0, facet.material};
  if (const TriangleIndices* corners = geometry.corner_normals(index)) {
    const auto n = geometry.normals();
    const Vec3f smooth = n[(*corners)[0]] * (1 - hit.u - hit.v) + n[(*corners)[1]] * hit.u +
                         n[(*corners)[2]] * hit.v;
    if (dot(smooth, smooth) > 0) surface.normal = normalize(smooth);
  }
  return surface;
}

}  // namespace raio
