// Triangles.
#ifndef RAIO_SHAPE_TRIANGLE_H_
#define RAIO_SHAPE_TRIANGLE_H_

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/box.h"
#include "base/ray.h"
#include "shape/kinds.h"

namespace raio::core {

struct Triangle {
  Vec3f a, b, c;
};

inline Triangle bake(const Triangle& t) { return t; }

inline Box3f bounds(const Triangle& t) {
  return {min(t.a, min(t.b, t.c)), max(t.a, max(t.b, t.c))};
}

/// The unit normal of the side from which the vertices appear counter-clockwise; zero for a
/// triangle without area. In double, so that slivers far from the origin keep their direction.
inline Vec3f triangle_normal(const Triangle& t) {
  const Vec3d a(t.a), n = cross(Vec3d(t.b) - a, Vec3d(t.c) - a);
  const double len = length(n);
  return len > 0 ? Vec3f(n / len) : Vec3f();
}

/// A ray prepared for triangles: the axis permutation and the shear that make it (0, 0, 1).
struct ShearedRay {
  int kx = 0, ky = 1, kz = 2;
  float sx = 0, sy = 0, sz = 1;

  explicit ShearedRay(Vec3f dir) {
    kz = max_axis(abs(dir));
    kx = (kz + 1) % 3;
    ky = (kx + 1) % 3;
    if (dir[kz] < 0) std::swap(kx, ky);  // keeps the winding
    sx = dir[kx] / dir[kz];
    sy = dir[ky] / dir[kz];
    sz = 1 / dir[kz];
  }
};

/// Relative to the distance of the vertices from the ray, measured across it.
inline constexpr float kEdgeSlack = 8 * std::numeric_limits<float>::epsilon();

struct TriangleHit {
  float t = 0, u = 0, v = 0;
  float cosine = 0;  // sign of dot(normal, direction)
};

/// Watertight: two triangles compute a shared edge from the same rounded products, so their edge
/// functions are exact negatives and no ray passes between them. Woop, Benthin and Wald 2013,
/// "Watertight Ray/Triangle Intersection", JCGT 2(1). No second pass in double is needed: an edge
/// function that rounds to zero counts as inside for both triangles. For a triangle seen edge-on
/// all three may be mere rounding errors, wherever in its plane the ray passes; so the ray must
/// also pass through the bounds of the vertices, extended by a few epsilons of their distance, the
/// error of an edge function. Needs contraction off.
inline std::optional<TriangleHit> intersect(Vec3f a, Vec3f b, Vec3f c, const Ray& ray,
                                            const ShearedRay& s) {
  a = a - ray.origin, b = b - ray.origin, c = c - ray.origin;
  const float ax = a[s.kx] - s.sx * a[s.kz], ay = a[s.ky] - s.sy * a[s.kz];
  const float bx = b[s.kx] - s.sx * b[s.kz], by = b[s.ky] - s.sy * b[s.kz];
  const float cx = c[s.kx] - s.sx * c[s.kz], cy = c[s.ky] - s.sy * c[s.kz];
  const float u = cx * by - cy * bx;
  const float v = ax * cy - ay * cx;
  const float w = bx * ay - by * ax;
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return std::nullopt;
  const float det = u + v + w;
  if (det == 0) return std::nullopt;
  const float x0 = std::min({ax, bx, cx}), x1 = std::max({ax, bx, cx});
  const float y0 = std::min({ay, by, cy}), y1 = std::max({ay, by, cy});
  const float slack = kEdgeSlack * std::max({-x0, x1, -y0, y1});
  if (x0 > slack || -x1 > slack || y0 > slack || -y1 > slack) return std::nullopt;
  const float t = (u * (s.sz * a[s.kz]) + v * (s.sz * b[s.kz]) + w * (s.sz * c[s.kz])) / det;
  // Divisions, since 1 / det can be infinite. det is positive if the vertices are clockwise along
  // the ray's (mirrored) frame.
  return TriangleHit{t, v / det, w / det, -det};
}

inline std::optional<ShapeHit> first_hit(const Triangle& t, const Ray& ray,
                                         const ShearedRay& sheared, Sides sides) {
  const auto hit = intersect(t.a, t.b, t.c, ray, sheared);
  if (!hit || !(hit->t > 0) || !visible(sides, hit->cosine)) return std::nullopt;
  return ShapeHit{hit->t, hit->u, hit->v};
}

/// Whether the triangle touches the box, by the separating axes of Akenine-Moeller 2001, "Fast 3D
/// Triangle-Box Overlap Testing", JGT 6(1): exact except for rounding, in double.
bool overlaps(const Triangle& triangle, const Box3d& box);

}  // namespace raio::core

#endif  // RAIO_SHAPE_TRIANGLE_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Distances and weights, still to be divided by `det`, of triangles with sheared vertices (x, y,
// z), and which of them the lines of the rays hit.
template <class D>
struct TriangleLanes {
  hn::Mask<D> in;
  hn::Vec<D> det, t, u, v;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE TriangleLanes<D> edge_test(D d, const V* x, const V* y, const V* z) {
  const V zero = hn::Zero(d);
  const V u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
  const V v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
  const V w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
  const V smallest = hn::Min(hn::Min(u, v), w), largest = hn::Max(hn::Max(u, v), w);
  const V det = hn::Add(hn::Add(u, v), w);
  const V t = hn::Add(hn::Add(hn::Mul(u, z[0]), hn::Mul(v, z[1])), hn::Mul(w, z[2]));
  const auto both = hn::And(hn::Lt(smallest, zero), hn::Gt(largest, zero));
  return {hn::AndNot(both, hn::Ne(det, zero)), det, t, v, w};
}
// Which triangles are near enough to the ray, for those seen edge-on.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> within_reach(D d, const V* x, const V* y) {
  const V x0 = hn::Min(hn::Min(x[0], x[1]), x[2]), x1 = hn::Max(hn::Max(x[0], x[1]), x[2]);
  const V y0 = hn::Min(hn::Min(y[0], y[1]), y[2]), y1 = hn::Max(hn::Max(y[0], y[1]), y[2]);
  const V reach = hn::Max(hn::Max(hn::Neg(x0), x1), hn::Max(hn::Neg(y0), y1));
  const V away = hn::Max(hn::Max(x0, hn::Neg(x1)), hn::Max(y0, hn::Neg(y1)));
  return hn::Le(away, hn::Mul(hn::Set(d, kEdgeSlack), reach));
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
