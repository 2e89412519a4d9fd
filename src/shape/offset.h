// Starting a ray on a surface that it must not meet again at once.
#pragma once

#include <limits>

#include "base/vec.h"

namespace raio {

/// `point`, moved off the surface it lies on to the side that the unit normal points to
/// (`along_normal`) or to the other. The move is k float epsilons of `scale`, the size of the
/// numbers that a test of the shape reckons with: the largest coordinate of the point, plus a
/// sphere's radius, a triangle's longest edge, a cone's height and larger radius, or nothing for a
/// plane. The point must have been put back on the surface after the hit, since a distance along a
/// ray from afar is rounded by more than this.
///
/// k pays for the rounding of the point, of the moved point (together one epsilon of the scale) and
/// of the test that the new ray is put to. It was found by trying: with some millions of rays down
/// to a cosine of 1e-4, at sizes of 1e-6 to 1e6 and up to 1e5 sizes from the origin, k = 1 let
/// spheres and triangles be met again, k = 2 a plane, k = 4 three triangles in six million, k = 8
/// none. Four times that is used.
inline float offset_length(float scale) {
  constexpr float k = 32;
  return k * std::numeric_limits<float>::epsilon() * scale;
}
inline Vec3f offset_origin(Vec3f point, Vec3f geometric_normal, float scale, bool along_normal) {
  const float by = offset_length(scale);
  return point + geometric_normal * (along_normal ? by : -by);
}

}  // namespace raio
