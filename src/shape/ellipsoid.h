// Ellipsoids in any orientation.
#ifndef RAIO_SHAPE_ELLIPSOID_H_
#define RAIO_SHAPE_ELLIPSOID_H_

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/box.h"
#include "base/exact_math.h"
#include "base/ray.h"
#include "shape/kinds.h"
#include "shape/overlap.h"

namespace raio::core {

/// The unit sphere stretched along three perpendicular semi-axes. Both sides are visible.
struct Ellipsoid {
  Vec3f center;
  Vec3f axes[3];
};

constexpr ShapeKind shape_kind(const Ellipsoid&) { return ShapeKind::ellipsoid; }
inline bool only_inside_seen(const Ellipsoid&) { return false; }

/// An ellipsoid prepared for intersection when a scene is baked: the points x with |to_unit (x -
/// center)| = 1. `to_unit` consists of rows.
struct BakedEllipsoid {
  Vec3f center;
  Vec3f to_unit[3];
  float extent = 0;  // the longest semi-axis

  BakedEllipsoid() = default;
  /// The rows are the inverse of the matrix with the semi-axes as columns.
  explicit BakedEllipsoid(const Ellipsoid& e) : center(e.center) {
    for (int i = 0; i < 3; ++i) {
      const Vec3d axis(e.axes[i]);
      const Vec3d across = cross(Vec3d(e.axes[(i + 1) % 3]), Vec3d(e.axes[(i + 2) % 3]));
      to_unit[i] = Vec3f(across / dot(axis, across));
      extent = std::max(extent, float(length(axis)));
    }
  }
};

inline BakedEllipsoid bake(const Ellipsoid& e) { return BakedEllipsoid(e); }

/// Tolerance of the cosine between semi-axes: files have rounded decimals.
inline constexpr double kRightAngle = 1e-4;

template <class Must>
void check_shape(const Ellipsoid& e, Must&& must) {
  bool finite = is_finite(e.center), positive = true, perpendicular = true;
  for (int i = 0; i < 3; ++i) {
    const Vec3d a(e.axes[i]), b(e.axes[(i + 1) % 3]);
    finite = finite && is_finite(e.axes[i]);
    positive = positive && length(a) > 0;
    perpendicular = perpendicular && !(std::abs(dot(a, b)) > kRightAngle * length(a) * length(b));
  }
  must(finite, "centre and semi-axes must be finite");
  must(!finite || positive, "no semi-axis may be zero");
  must(!finite || !positive || perpendicular, "the semi-axes must be perpendicular to each other");
  if (!finite || !positive || !perpendicular) return;
  const BakedEllipsoid baked(e);
  must(is_finite(baked.to_unit[0]) && is_finite(baked.to_unit[1]) && is_finite(baked.to_unit[2]) &&
           std::isfinite(baked.extent),
       "a semi-axis is too short or too long for a float");
}

/// The members of a baked ellipsoid as plain numbers: of one, or each a column for many.
template <class T>
struct EllipsoidNumbers {
  T center[3], to_unit[3][3];
};
inline EllipsoidNumbers<float> numbers_of(const BakedEllipsoid& e) {
  EllipsoidNumbers<float> out;
  for (int a = 0; a < 3; ++a) {
    out.center[a] = e.center[a];
    for (int i = 0; i < 3; ++i) out.to_unit[i][a] = e.to_unit[i][a];
  }
  return out;
}

/// Bounds of the baked surface. Its extent along x is the length of the vector of the semi-axes' x
/// components; the semi-axes are the columns of the inverse of `to_unit`.
inline Box3f bounds(const BakedEllipsoid& e) {
  Vec3d axes[3];
  for (int i = 0; i < 3; ++i) {
    const Vec3d across = cross(Vec3d(e.to_unit[(i + 1) % 3]), Vec3d(e.to_unit[(i + 2) % 3]));
    axes[i] = across / dot(Vec3d(e.to_unit[i]), across);
  }
  Vec3d reach;
  for (int a = 0; a < 3; ++a) reach[a] = exact_hypot(axes[0][a], axes[1][a], axes[2][a]);
  return rounded_out({Vec3d(e.center) - reach, Vec3d(e.center) + reach});
}

/// The distances at which a ray enters and leaves; `entry > exit` if it misses.
struct EllipsoidRoots {
  float entry = 1, exit = 0;
};

/// Transforms the ray to the unit sphere, then proceeds as sphere.h: from the ray's point nearest
/// to the centre, so cancellation depends on the ellipsoid's size, not on its distance. In double,
/// since a flat ellipsoid magnifies the rounding of a ray by its proportions.
inline EllipsoidRoots ellipsoid_roots(const BakedEllipsoid& e, const Ray& ray) {
  const Vec3d from_center = Vec3d(ray.origin) - Vec3d(e.center), dir(ray.dir);
  Vec3d o, d;
  for (int i = 0; i < 3; ++i)
    o[i] = dot(from_center, Vec3d(e.to_unit[i])), d[i] = dot(dir, Vec3d(e.to_unit[i]));
  const double per_unit = dot(d, d);
  const double middle = -dot(o, d) / per_unit;
  const Vec3d nearest = o + d * middle;
  const double d2 = (1 - dot(nearest, nearest)) / per_unit;
  if (!(d2 >= 0)) return {};
  const double half_chord = std::sqrt(d2);
  return {float(middle - half_chord), float(middle + half_chord)};
}

inline std::optional<ShapeHit> first_hit(const BakedEllipsoid& e, const Ray& ray, Sides sides) {
  const EllipsoidRoots roots = ellipsoid_roots(e, ray);
  if (!(roots.entry <= roots.exit)) return std::nullopt;
  if (roots.entry > 0 && visible(sides, -1)) return ShapeHit{roots.entry};
  if (roots.exit > 0 && visible(sides, 1)) return ShapeHit{roots.exit};
  return std::nullopt;
}

/// Two Newton steps along the gradient put the point back on the surface.
inline SurfacePoint surface_point(const BakedEllipsoid& e, Vec3f point) {
  Vec3d p = Vec3d(point) - Vec3d(e.center), gradient;
  for (int step = 0; step < 3; ++step) {
    double excess = -1;
    gradient = {};
    for (const Vec3f& row : e.to_unit) {
      const double x = dot(p, Vec3d(row));
      excess += x * x;
      gradient += Vec3d(row) * x;
    }
    if (step < 2) p = p - gradient * (0.5 * excess / dot(gradient, gradient));
  }
  return {Vec3f(Vec3d(e.center) + p), Vec3f(normalize(gradient)), e.extent};
}

/// Whether the surface may touch the box; "no" is always right: in the space of the unit sphere,
/// the columns of `to_unit` limit the distance of a box's points from its middle.
inline bool overlaps(const BakedEllipsoid& e, const Box3d& box) {
  return may_touch(box, [&](const Box3d& part) {
    const Vec3d middle = part.center(), half = part.size() * 0.5;
    const Vec3d from_center = middle - Vec3d(e.center);
    double radius2 = 0, distance2 = 0, rounded = 1;
    for (const Vec3f& row : e.to_unit) {
      const Vec3d m(row);
      const double reach = dot(abs(m), half), x = dot(m, from_center);
      radius2 += reach * reach, distance2 += x * x;
      rounded += dot(abs(m), abs(middle) + abs(Vec3d(e.center)) + half);
    }
    const double slack = 16 * std::numeric_limits<double>::epsilon() * rounded;
    return std::abs(std::sqrt(distance2) - 1) > std::sqrt(radius2) + slack;
  });
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_ELLIPSOID_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const EllipsoidNumbers<V>& e, const V* origin,
                                   const V* dir) {
  const auto dot3 = [&](const V* x, const V* y)
                        HWY_ATTR { return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]); };
  V from_center[3], o[3], to[3], nearest[3];
  for (int a = 0; a < 3; ++a) from_center[a] = hn::Sub(origin[a], e.center[a]);
  for (int i = 0; i < 3; ++i)
    o[i] = dot3(from_center, e.to_unit[i]), to[i] = dot3(dir, e.to_unit[i]);
  const V per_unit = dot3(to, to);
  const V middle = hn::Div(hn::Neg(dot3(o, to)), per_unit);
  for (int i = 0; i < 3; ++i) nearest[i] = hn::Add(o[i], hn::Mul(to[i], middle));
  const V d2 = hn::Div(hn::Sub(hn::Set(d, 1.0), dot3(nearest, nearest)), per_unit);
  const hn::Mask<D> in = hn::Ge(d2, hn::Zero(d));
  const V half = hn::Sqrt(d2);
  return first_of(d, in, hn::Sub(middle, half), in, hn::Add(middle, half));
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
