// Uniform movements between two times.
#ifndef RAIO_SHAPE_MOVEMENT_H_
#define RAIO_SHAPE_MOVEMENT_H_

#include <algorithm>
#include <cmath>

#include "base/vec.h"

namespace raio::core {

/// The completed fraction of a movement: 0 until `begin`, 1 from `end`.
inline double part_moved(float begin, float end, float time) {
  const double part = (double(time) - double(begin)) / (double(end) - double(begin));
  return std::min(std::max(part, 0.0), 1.0);
}

inline Vec3d between(Vec3f from, Vec3f to, double part) {
  return Vec3d(from) + (Vec3d(to) - Vec3d(from)) * part;
}

template <class Must>
void check_times(float begin, float end, Must&& must) {
  must(std::isfinite(begin) && std::isfinite(end) && begin < end,
       "the movement must begin before it ends");
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_MOVEMENT_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE V part_moved(D d, V begin, V end, V time) {
  const V part = hn::Div(hn::Sub(time, begin), hn::Sub(end, begin));
  return hn::Min(hn::Max(part, hn::Zero(d)), hn::Set(d, 1));
}
template <class V>
HWY_INLINE V between(V from, V to, V part) {
  return hn::Add(from, hn::Mul(hn::Sub(to, from), part));
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
