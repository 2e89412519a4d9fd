// Positions in data files.
#pragma once

#include <cmath>
#include <cstddef>

#include "base/box.h"
#include "base/exact_math.h"

namespace raio::core {

/// Beyond this, values computed from positions might overflow.
inline constexpr float kFarthestPlace = 1e25f;

inline bool is_place(Vec3f p) {
  const auto is_near = [](float x) { return std::abs(x) <= kFarthestPlace; };
  return is_near(p.x) && is_near(p.y) && is_near(p.z);
}

/// The spacing of points that fill a box evenly, in as many dimensions as it has; 1 for a single
/// point.
inline float mean_spacing(const Box3f& box, size_t points) {
  const double longest = double(max_component(box.size()));
  double volume = 1;
  int dimensions = 0;
  for (int a = 0; a < 3; ++a)
    if (const double side = double(box.size()[a]); side > 1e-6 * longest)
      volume *= side, ++dimensions;
  return dimensions == 0 ? 1 : float(exact_pow(volume / double(points), 1.0 / dimensions));
}

}  // namespace raio::core
