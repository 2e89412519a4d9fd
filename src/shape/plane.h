// Infinite planes.
#pragma once

#include <cmath>
#include <optional>

#include "base/ray.h"
#include "shape/kinds.h"

namespace raio::core {

/// The points x with dot(normal, x - point) = 0; `normal` has unit length.
struct Plane {
  Vec3f point, normal;
};

constexpr ShapeKind shape_kind(const Plane&) { return ShapeKind::plane; }
inline bool only_inside_seen(const Plane&) { return false; }

template <class Must>
void check_shape(const Plane& p, Must&& must) {
  must(is_finite(p.point), "the point must be finite");
  must(is_finite(p.normal) && is_unit(p.normal), "the normal must have length 1");
}

inline Plane bake(const Plane& p) { return p; }

/// The distance to the plane along the ray; nothing for a parallel ray.
inline std::optional<float> intersect(const Plane& plane, const Ray& ray) {
  // In double: the plane's point may be far from ray and scene, and the cosine of a grazing ray is
  // a small sum of large products.
  const Vec3d normal(plane.normal);
  const double along = dot(normal, Vec3d(ray.dir));
  if (along == 0) return std::nullopt;
  const double height = dot(normal, Vec3d(plane.point) - Vec3d(ray.origin));
  return float(height / along);
}

inline std::optional<ShapeHit> first_hit(const Plane& plane, const Ray& ray, Sides sides) {
  const auto t = intersect(plane, ray);
  if (!t || !(*t > 0) || !visible(sides, dot(plane.normal, ray.dir))) return std::nullopt;
  return ShapeHit{*t};
}

inline SurfacePoint surface_point(const Plane& plane, Vec3f p) {
  const double height = dot(Vec3d(plane.normal), Vec3d(p) - Vec3d(plane.point));
  return {p - plane.normal * float(height), plane.normal, 0};
}

}  // namespace raio::core
