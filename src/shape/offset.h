// Offsets ray origins from a surface, so that rays do not hit it again at once.
#pragma once

#include <limits>

#include "base/vec.h"

namespace raio::core {

/// `point`, moved off its surface to the side of the unit normal (`along_normal`) or to the other.
/// The move is k float epsilons of `scale`, the magnitude of the numbers in the shape's test: the
/// largest coordinate of the point, plus a sphere's radius, a triangle's longest edge, a cone's
/// height and larger radius, or nothing for a plane. The point must have been moved back onto the
/// surface after the hit, since a distance along a ray from afar is rounded by more than this.
///
/// k covers the rounding of the point, of the moved point (together one epsilon of the scale) and
/// of the next ray's test. It was found by experiment, with millions of rays at cosines down to
/// 1e-4, sizes of 1e-6 to 1e6 and up to 1e5 sizes from the origin: k = 1 failed for spheres and
/// triangles, k = 2 for a plane, k = 4 for three triangles in six million, k = 8 for none. We use
/// four times that.
inline float offset_length(float scale) {
  constexpr float k = 32;
  return k * std::numeric_limits<float>::epsilon() * scale;
}
inline Vec3f offset_origin(Vec3f point, Vec3f geometric_normal, float scale, bool along_normal) {
  const float by = offset_length(scale);
  return point + geometric_normal * (along_normal ? by : -by);
}

}  // namespace raio::core
