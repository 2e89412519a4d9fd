// Places that files of data give.
#pragma once

#include <cmath>
#include <span>

#include "base/box.h"

namespace raio {

/// Beyond it what is computed of places might not stay finite.
inline constexpr float kFarthestPlace = 1e25f;

inline bool is_place(Vec3f p) {
  const auto is_near = [](float x) { return std::abs(x) <= kFarthestPlace; };
  return is_near(p.x) && is_near(p.y) && is_near(p.z);
}

/// How far points are from each other that fill their bounds evenly, in as many dimensions as these
/// have; 1 for a single one.
inline float mean_spacing(std::span<const Vec3f> points) {
  Box3f box;
  for (const Vec3f& p : points) box.extend(p);
  const double longest = double(max_component(box.size()));
  double volume = 1;
  int dimensions = 0;
  for (int a = 0; a < 3; ++a)
    if (const double side = double(box.size()[a]); side > 1e-6 * longest)
      volume *= side, ++dimensions;
  return dimensions == 0 ? 1 : float(std::pow(volume / double(points.size()), 1.0 / dimensions));
}

}  // namespace raio
