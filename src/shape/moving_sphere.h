// Spheres that move along a straight line.
#ifndef RAIO_SHAPE_MOVING_SPHERE_H_
#define RAIO_SHAPE_MOVING_SPHERE_H_

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/box.h"
#include "base/ray.h"
#include "shape/kinds.h"
#include "shape/movement.h"
#include "shape/overlap.h"
#include "shape/sphere.h"

namespace raio::core {

/// At rest at `center` until the time `begin` and at `to` from `end`; uniform movement in between.
struct MovingSphere {
  Vec3f center, to;
  float radius = 0;
  float begin = 0, end = 1;
};

constexpr ShapeKind shape_kind(const MovingSphere&) { return ShapeKind::sphere; }
inline bool only_inside_seen(const MovingSphere&) { return false; }

template <class Must>
void check_shape(const MovingSphere& s, Must&& must) {
  must(is_finite(s.center) && is_finite(s.to), "the centres must be finite");
  must(std::isfinite(s.radius) && s.radius > 0, "the radius must be finite and positive");
  check_times(s.begin, s.end, must);
}

inline MovingSphere bake(const MovingSphere& s) { return s; }

/// The members of a moving sphere as plain numbers: of one, or each a column for many.
template <class T>
struct MovingSphereNumbers {
  T center[3], to[3], radius, begin, end;
};
inline MovingSphereNumbers<float> numbers_of(const MovingSphere& s) {
  return {{s.center.x, s.center.y, s.center.z}, {s.to.x, s.to.y, s.to.z}, s.radius, s.begin, s.end};
}

inline Vec3d center_at(const MovingSphere& s, float time) {
  return between(s.center, s.to, part_moved(s.begin, s.end, time));
}

/// Bounds of the whole movement.
inline Box3f bounds(const MovingSphere& s) {
  Box3f box = bounds(Sphere{s.center, s.radius});
  box.extend(bounds(Sphere{s.to, s.radius}));
  return box;
}

/// The float test of sphere.h, in double, at the ray's time.
inline std::optional<ShapeHit> first_hit(const MovingSphere& s, const Ray& ray, Sides sides) {
  const Vec3d dir(ray.dir), to_center = center_at(s, ray.time) - Vec3d(ray.origin);
  const double dir2 = dot(dir, dir), radius = s.radius;
  const double middle = dot(to_center, dir) / dir2;
  const Vec3d offset = to_center - dir * middle;
  const double d2 = radius * radius - dot(offset, offset);
  if (!(d2 >= 0)) return std::nullopt;
  const double half = std::sqrt(d2 / dir2);
  const auto entry = float(middle - half), exit = float(middle + half);
  if (entry > 0 && visible(sides, -1)) return ShapeHit{entry};
  if (exit > 0 && visible(sides, 1)) return ShapeHit{exit};
  return std::nullopt;
}

/// The sphere at a time, for the surface at a hit.
inline Sphere at_time(const MovingSphere& s, float time) {
  return {Vec3f(center_at(s, time)), s.radius};
}

/// Whether the moving sphere may touch the box; "no" is always right.
inline bool overlaps(const MovingSphere& s, const Box3d& box) {
  const Vec3d from(s.center), way = Vec3d(s.to) - from;
  const double way2 = dot(way, way);
  return may_touch(box, [&](const Box3d& part) {
    const Vec3d center = part.center(), half = part.size() * 0.5;
    const double at = way2 > 0 ? std::clamp(dot(center - from, way) / way2, 0.0, 1.0) : 0;
    const double distance = length(center - (from + way * at));
    // Far above the rounding of doubles.
    const double slack = std::numeric_limits<float>::epsilon() * (distance + length(half));
    return distance > length(half) + double(s.radius) + slack;
  });
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_MOVING_SPHERE_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const MovingSphereNumbers<V>& s, const V* origin,
                                   const V* dir, V time) {
  const auto dot3 = [&](const V* x, const V* y)
                        HWY_ATTR { return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]); };
  const V zero = hn::Zero(d), part = part_moved(d, s.begin, s.end, time);
  V to_center[3], offset[3];
  for (int a = 0; a < 3; ++a)
    to_center[a] = hn::Sub(between(s.center[a], s.to[a], part), origin[a]);
  const V dir2 = dot3(dir, dir);
  const V middle = hn::Div(dot3(to_center, dir), dir2);
  for (int a = 0; a < 3; ++a) offset[a] = hn::Sub(to_center[a], hn::Mul(dir[a], middle));
  const V d2 = hn::Sub(hn::Mul(s.radius, s.radius), dot3(offset, offset));
  const hn::Mask<D> in = hn::Ge(d2, zero);
  const V half = hn::Sqrt(hn::Div(hn::Max(d2, zero), dir2));
  return first_of(d, in, hn::Sub(middle, half), in, hn::Add(middle, half));
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
