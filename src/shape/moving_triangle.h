// Triangles with vertices that move along straight lines.
#ifndef RAIO_SHAPE_MOVING_TRIANGLE_H_
#define RAIO_SHAPE_MOVING_TRIANGLE_H_

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <optional>

#include "base/box.h"
#include "base/ray.h"
#include "shape/kinds.h"
#include "shape/movement.h"
#include "shape/triangle.h"

namespace raio::core {

/// At rest as `from` until the time `begin` and as `to` from `end`; uniform movement in between.
struct MovingTriangle {
  Triangle from, to;
  float begin = 0, end = 1;
};

constexpr ShapeKind shape_kind(const MovingTriangle&) { return ShapeKind::triangle; }
inline bool only_inside_seen(const MovingTriangle&) { return false; }

template <class Must>
void check_shape(const MovingTriangle& t, Must&& must) {
  for (const Vec3f corner : {t.from.a, t.from.b, t.from.c, t.to.a, t.to.b, t.to.c})
    must(is_finite(corner), "the vertices must be finite");
  check_times(t.begin, t.end, must);
}

inline MovingTriangle bake(const MovingTriangle& t) { return t; }

/// The members of a moving triangle as plain numbers: of one, or each a column for many.
template <class T>
struct MovingTriangleNumbers {
  T from[3][3], to[3][3];  // vertex, then axis
  T begin, end;
};
inline MovingTriangleNumbers<float> numbers_of(const MovingTriangle& t) {
  const auto &f = t.from, &o = t.to;
  return {{{f.a.x, f.a.y, f.a.z}, {f.b.x, f.b.y, f.b.z}, {f.c.x, f.c.y, f.c.z}},
          {{o.a.x, o.a.y, o.a.z}, {o.b.x, o.b.y, o.b.z}, {o.c.x, o.c.y, o.c.z}},
          t.begin,
          t.end};
}

/// Bounds of the whole movement.
inline Box3f bounds(const MovingTriangle& t) {
  Box3f box = bounds(t.from);
  box.extend(bounds(t.to));
  return box;
}

/// The maximum distance of a found point from the ray, relative to the distance of the vertices.
inline constexpr double kOffRay = 8 * double(std::numeric_limits<float>::epsilon());

/// Plücker's test in double, with the vertices at the ray's time: the signs of the volumes that the
/// ray spans with the edges. Two triangles with the same movement compute a shared edge from the
/// same rounded products, so no ray passes between them. For a triangle seen edge-on the volumes
/// may be mere rounding errors; then the resulting point is not on the ray.
inline std::optional<ShapeHit> first_hit(const MovingTriangle& t, const Ray& ray, Sides sides) {
  const double part = part_moved(t.begin, t.end, ray.time);
  const Vec3d dir(ray.dir), origin(ray.origin);
  const Vec3d a = between(t.from.a, t.to.a, part) - origin;
  const Vec3d b = between(t.from.b, t.to.b, part) - origin;
  const Vec3d c = between(t.from.c, t.to.c, part) - origin;
  const double u = dot(cross(c, b), dir), v = dot(cross(a, c), dir), w = dot(cross(b, a), dir);
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
  const double det = u + v + w;
  const Vec3d point = (a * u + b * v + c * w) / det;
  const double along = dot(point, dir) / dot(dir, dir);
  const Vec3d off = point - dir * along;
  const double most = max_component(abs(point)) * kOffRay;
  if (!(dot(off, off) <= most * most)) return std::nullopt;  // rejects det = 0, too
  if (!(float(along) > 0) || !visible(sides, float(-det))) return std::nullopt;
  return ShapeHit{float(along)};
}

/// The triangle at a time, for the surface at a hit.
inline Triangle at_time(const MovingTriangle& t, float time) {
  const double part = part_moved(t.begin, t.end, time);
  return {Vec3f(between(t.from.a, t.to.a, part)), Vec3f(between(t.from.b, t.to.b, part)),
          Vec3f(between(t.from.c, t.to.c, part))};
}

/// The point in the triangle's plane.
inline SurfacePoint surface_point(const Triangle& t, Vec3f p) {
  const Vec3f normal = triangle_normal(t);
  const Vec3d n(normal);
  const double height = dot(n, Vec3d(p) - Vec3d(t.a));
  const float extent = std::max(
      {max_component(abs(t.a - p)), max_component(abs(t.b - p)), max_component(abs(t.c - p))});
  return {Vec3f(Vec3d(p) - n * height), normal, extent};
}

/// Whether the moving triangle may touch the box; "no" is always right. The triangle stays in the
/// convex hull of both its places; this tries planes that separate the hull from the box: the
/// triangle's planes at both ends, and those spanned by an edge of the hull and one of the box.
inline bool overlaps(const MovingTriangle& t, const Box3d& box) {
  const Vec3d center = box.center(), half = box.size() * 0.5;
  Vec3d corners[6];
  size_t n = 0;
  for (const Vec3f corner : {t.from.a, t.from.b, t.from.c, t.to.a, t.to.b, t.to.c})
    corners[n++] = Vec3d(corner) - center;
  const auto divides = [&](Vec3d axis) {
    double lo = std::numeric_limits<double>::infinity(), hi = -lo;
    for (const Vec3d corner : corners) {
      const double x = dot(axis, corner);
      lo = std::min(lo, x), hi = std::max(hi, x);
    }
    const double reach = dot(abs(axis), half);
    // Far above the rounding of doubles.
    const double slack =
        std::numeric_limits<float>::epsilon() * std::max({reach, std::abs(lo), std::abs(hi)});
    return lo > reach + slack || -hi > reach + slack;
  };
  const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const Vec3d axis : axes)
    if (divides(axis)) return false;
  for (int i = 0; i < 6; i += 3)
    if (divides(cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]))) return false;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    const Vec3d move = corners[i + 3] - corners[i];
    if (divides(cross(move, corners[next] - corners[i]))) return false;
    for (const Vec3d edge : {move, corners[next] - corners[i], corners[next + 3] - corners[i + 3]})
      for (const Vec3d axis : axes)
        if (divides(cross(edge, axis))) return false;
  }
  return true;
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_MOVING_TRIANGLE_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const MovingTriangleNumbers<V>& t, const V* origin,
                                   const V* dir, V time) {
  const V part = part_moved(d, t.begin, t.end, time), zero = hn::Zero(d);
  V corner[3][3];
  for (int k = 0; k < 3; ++k)
    for (int a = 0; a < 3; ++a)
      corner[k][a] = hn::Sub(between(t.from[k][a], t.to[k][a], part), origin[a]);
  const auto dot3 = [&](const V* x, const V* y)
                        HWY_ATTR { return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]); };
  const auto volume = [&](const V* x, const V* y) HWY_ATTR {
    const V across[3] = {hn::Sub(hn::Mul(x[1], y[2]), hn::Mul(x[2], y[1])),
                         hn::Sub(hn::Mul(x[2], y[0]), hn::Mul(x[0], y[2])),
                         hn::Sub(hn::Mul(x[0], y[1]), hn::Mul(x[1], y[0]))};
    return dot3(across, dir);
  };
  const V u = volume(corner[2], corner[1]), v = volume(corner[0], corner[2]),
          w = volume(corner[1], corner[0]);
  const V smallest = hn::Min(hn::Min(u, v), w), largest = hn::Max(hn::Max(u, v), w);
  const V det = hn::Add(hn::Add(u, v), w);
  V point[3], off[3];
  for (int a = 0; a < 3; ++a)
    point[a] = hn::Div(hn::Add(hn::Add(hn::Mul(corner[0][a], u), hn::Mul(corner[1][a], v)),
                               hn::Mul(corner[2][a], w)),
                       det);
  const V along = hn::Div(dot3(point, dir), dot3(dir, dir));
  for (int a = 0; a < 3; ++a) off[a] = hn::Sub(point[a], hn::Mul(dir[a], along));
  const V reach = hn::Max(hn::Max(hn::Abs(point[0]), hn::Abs(point[1])), hn::Abs(point[2]));
  const V most = hn::Mul(reach, hn::Set(d, kOffRay));
  const auto outside = hn::And(hn::Lt(smallest, zero), hn::Gt(largest, zero));
  const auto in = hn::AndNot(outside, hn::Le(dot3(off, off), hn::Mul(most, most)));
  return first_of(d, in, along, in, along);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
