// Infinite planes.
#pragma once

#include <cmath>
#include <optional>

#include "base/ray.h"
#include "shape/kinds.h"

namespace raio {

/// The points x with dot(normal, x - point) = 0; `normal` has unit length.
struct Plane {
  Vec3f point, normal;
};

/// The distance to the plane along the ray; nothing for a parallel ray.
inline std::optional<float> intersect(const Plane& plane, const Ray& ray) {
  // In double: the plane's point may lie far from both ray and scene, and the cosine of a grazing
  // ray is the small sum of large products.
  const Vec3d normal(plane.normal);
  const double along = dot(normal, Vec3d(ray.dir));
  if (along == 0) return std::nullopt;
  const double height = dot(normal, Vec3d(plane.point) - Vec3d(ray.origin));
  return float(height / along);
}

}  // namespace raio
