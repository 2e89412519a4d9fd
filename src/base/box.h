// Axis-aligned boxes.
#pragma once

#include <cmath>
#include <limits>

#include "base/vec.h"

namespace raio::core {

template <class T>
struct Box3 {
  Vec3<T> lo{std::numeric_limits<T>::infinity()};
  Vec3<T> hi{-std::numeric_limits<T>::infinity()};

  constexpr bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  constexpr Vec3<T> size() const { return hi - lo; }
  constexpr Vec3<T> center() const { return lo * T(0.5) + hi * T(0.5); }

  /// Half the surface area, which is proportional to the probability that a random ray hits the
  /// box. 0 if empty.
  constexpr T half_area() const {
    if (empty()) return 0;
    const Vec3<T> s = size();
    return s.x * s.y + s.y * s.z + s.z * s.x;
  }

  constexpr void extend(Vec3<T> p) { lo = min(lo, p), hi = max(hi, p); }
  constexpr void extend(const Box3& b) { lo = min(lo, b.lo), hi = max(hi, b.hi); }
  constexpr void pad(T by) { lo = lo - Vec3<T>(by), hi = hi + Vec3<T>(by); }
};

using Box3f = Box3<float>;
using Box3d = Box3<double>;

/// Calls f(from, to) for each of the twelve edges.
template <class T, class F>
void for_each_edge(const Box3<T>& box, F&& f) {
  const auto corner = [&](int k) {
    return Vec3<T>(k & 1 ? box.hi.x : box.lo.x, k & 2 ? box.hi.y : box.lo.y,
                   k & 4 ? box.hi.z : box.lo.z);
  };
  for (int k = 0; k < 8; ++k)
    for (const int bit : {1, 2, 4})
      if (!(k & bit)) f(corner(k), corner(k | bit));
}

/// The smallest box of floats around `box`.
inline Box3f rounded_out(const Box3d& box) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Box3f out;
  for (int a = 0; a < 3; ++a) {
    out.lo[a] = float(box.lo[a]);
    out.hi[a] = float(box.hi[a]);
    if (out.lo[a] > box.lo[a]) out.lo[a] = std::nextafter(out.lo[a], -kInfinity);
    if (out.hi[a] < box.hi[a]) out.hi[a] = std::nextafter(out.hi[a], kInfinity);
  }
  return out;
}

}  // namespace raio::core
