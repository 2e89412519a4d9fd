// Flat discs and rings.
#ifndef RAIO_SHAPE_DISC_H_
#define RAIO_SHAPE_DISC_H_

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/box.h"
#include "base/exact_math.h"
#include "base/ray.h"
#include "shape/kinds.h"
#include "shape/overlap.h"

namespace raio::core {

/// The points of a plane from `inner` to `radius` away from the centre. The unit normal points
/// outward.
struct Disc {
  Vec3f center, normal;
  float radius = 0, inner = 0;
};

constexpr ShapeKind shape_kind(const Disc&) { return ShapeKind::disc; }
inline bool only_inside_seen(const Disc&) { return false; }

template <class Must>
void check_shape(const Disc& d, Must&& must) {
  must(is_finite(d.center), "the centre must be finite");
  must(is_finite(d.normal) && is_unit(d.normal), "the normal must have length 1");
  must(std::isfinite(d.radius) && d.radius > 0, "the radius must be finite and positive");
  must(d.inner >= 0 && d.inner < d.radius,
       "the inner radius must not be negative, and less than the radius");
}

inline Disc bake(const Disc& d) { return d; }

/// The members of a disc as plain numbers: of one, or each a column for many.
template <class T>
struct DiscNumbers {
  T center[3], normal[3], radius, inner;
};
inline DiscNumbers<float> numbers_of(const Disc& d) {
  return {{d.center.x, d.center.y, d.center.z},
          {d.normal.x, d.normal.y, d.normal.z},
          d.radius,
          d.inner};
}

inline Box3f bounds(const Disc& d) {
  // A circle with normal n extends r * sqrt(1 - n_x^2) along x; this form avoids cancellation.
  const Vec3d n = normalize(Vec3d(d.normal)), center(d.center);
  const Vec3d reach =
      Vec3d(exact_hypot(n.y, n.z), exact_hypot(n.z, n.x), exact_hypot(n.x, n.y)) * double(d.radius);
  return rounded_out({center - reach, center + reach});
}

/// Intersects the plane in double as plane.h does, then computes the distance from the centre from
/// differences of the disc's size, not of its distance. A parallel ray misses: its distance is
/// infinite or NaN.
inline std::optional<ShapeHit> first_hit(const Disc& disc, const Ray& ray, Sides sides) {
  const Vec3d normal(disc.normal), dir(ray.dir);
  const Vec3d to_center = Vec3d(disc.center) - Vec3d(ray.origin);
  const double along = dot(normal, dir);
  const double t = dot(normal, to_center) / along;
  const Vec3d from_center = dir * t - to_center;
  const double distance2 = dot(from_center, from_center);
  const double radius = disc.radius, inner = disc.inner;
  if (!(distance2 <= radius * radius && distance2 >= inner * inner)) return std::nullopt;
  if (!(float(t) > 0) || !visible(sides, float(along))) return std::nullopt;
  return ShapeHit{float(t)};
}

inline SurfacePoint surface_point(const Disc& d, Vec3f p) {
  const Vec3d normal(d.normal);
  const double height = dot(normal, Vec3d(p) - Vec3d(d.center));
  return {Vec3f(Vec3d(p) - normal * height), d.normal, d.radius};
}

/// The distance of a point to the disc.
inline double disc_distance(const Disc& d, Vec3d p) {
  const Vec3d normal(d.normal), x = p - Vec3d(d.center);
  const double z = dot(x, normal), rho = length(x - normal * z);
  return exact_hypot(z, std::max({0.0, rho - d.radius, d.inner - rho}));
}

/// Whether the disc may touch the box; "no" is always right.
inline bool overlaps(const Disc& d, const Box3d& box) {
  return may_touch(box, [&](const Box3d& part) {
    const Vec3d center = part.center(), half = part.size() * 0.5, normal(d.normal);
    // The normal has unit length only to float precision, and so have distances along it.
    const double slack =
        std::numeric_limits<float>::epsilon() * (length(center - Vec3d(d.center)) + length(half));
    const double height = std::abs(dot(normal, center - Vec3d(d.center)));
    return height > dot(abs(normal), half) + slack ||
           disc_distance(d, center) > length(half) + slack;
  });
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_DISC_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const DiscNumbers<V>& disc, const V* origin, const V* dir) {
  const auto dot3 = [&](const V* x, const V* y)
                        HWY_ATTR { return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]); };
  V to_center[3], from_center[3];
  for (int a = 0; a < 3; ++a) to_center[a] = hn::Sub(disc.center[a], origin[a]);
  const V t = hn::Div(dot3(disc.normal, to_center), dot3(disc.normal, dir));
  for (int a = 0; a < 3; ++a) from_center[a] = hn::Sub(hn::Mul(dir[a], t), to_center[a]);
  const V distance2 = dot3(from_center, from_center);
  const hn::Mask<D> in = hn::And(hn::Le(distance2, hn::Mul(disc.radius, disc.radius)),
                                 hn::Ge(distance2, hn::Mul(disc.inner, disc.inner)));
  return first_of(d, in, t, in, t);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
