// Spheres.
#ifndef RAIO_SHAPE_SPHERE_H_
#define RAIO_SHAPE_SPHERE_H_

#include <optional>

#include "base/box.h"
#include "base/ray.h"
#include "shape/kinds.h"

namespace raio::core {

/// As in NFF, only the inside is visible if the radius is negative.
struct Sphere {
  Vec3f center;
  float radius = 0;
};

constexpr ShapeKind shape_kind(const Sphere&) { return ShapeKind::sphere; }
inline bool only_inside_seen(const Sphere& s) { return s.radius < 0; }

template <class Must>
void check_shape(const Sphere& s, Must&& must) {
  must(is_finite(s.center), "the centre must be finite");
  must(std::isfinite(s.radius) && s.radius != 0, "the radius must be finite and not zero");
}

/// The same sphere with a positive radius.
inline Sphere bake(const Sphere& s) { return {s.center, std::abs(s.radius)}; }

inline Box3d exact_bounds(const Sphere& s) {
  const Vec3d c(s.center), r(std::abs(double(s.radius)));
  return {c - r, c + r};
}
inline Box3f bounds(const Sphere& s) { return rounded_out(exact_bounds(s)); }

/// The distances at which a ray enters and leaves; `entry > exit` if it misses.
struct SphereRoots {
  float entry = 1, exit = 0;
};

/// Finds the ray's point nearest to the centre, then half the chord, so cancellation depends on the
/// sphere's size, not on its distance: Haines, Guenther and Akenine-Moeller 2019, "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems, chapter 7. The radius must not be
/// negative.
inline SphereRoots sphere_roots(Vec3f center, float radius, const Ray& ray) {
  const Vec3f to_center = center - ray.origin;
  const float middle = dot(to_center, ray.dir);
  const Vec3f offset = to_center - ray.dir * middle;
  const float d2 = radius * radius - dot(offset, offset);
  if (!(d2 >= 0)) return {};
  const float half_chord = std::sqrt(d2);
  return {middle - half_chord, middle + half_chord};
}

inline std::optional<ShapeHit> first_hit(const Sphere& s, const Ray& ray, Sides sides) {
  const SphereRoots roots = sphere_roots(s.center, s.radius, ray);
  if (!(roots.entry <= roots.exit)) return std::nullopt;
  if (roots.entry > 0 && visible(sides, -1)) return ShapeHit{roots.entry};
  if (roots.exit > 0 && visible(sides, 1)) return ShapeHit{roots.exit};
  return std::nullopt;
}

inline SurfacePoint surface_point(const Sphere& s, Vec3f p) {
  const Vec3f normal = normalize(p - s.center);
  return {s.center + normal * s.radius, normal, s.radius};
}

/// Whether the surface (a shell, not the ball) touches the box. Exact except for rounding; "no" is
/// always right.
inline bool overlaps(const Sphere& s, const Box3d& box) {
  double nearest = 0, farthest = 0, largest = 0;
  for (int a = 0; a < 3; ++a) {
    const double lo = box.lo[a] - s.center[a], hi = box.hi[a] - s.center[a];
    const double near = lo > 0 ? lo : hi < 0 ? hi : 0;
    const double far = std::max(std::abs(lo), std::abs(hi));
    nearest += near * near;
    farthest += far * far;
    largest = std::max({largest, std::abs(box.lo[a]), std::abs(box.hi[a])});
  }
  // Rounding: half an ulp of the largest coordinate for the differences, two of their own ulps for
  // the lengths.
  const double r = std::abs(double(s.radius));
  const double slack = 4 * std::numeric_limits<double>::epsilon() * (largest + r);
  return std::sqrt(nearest) <= r + slack && r - slack <= std::sqrt(farthest);
}

}  // namespace raio::core

#endif  // RAIO_SHAPE_SPHERE_H_

#ifdef RAIO_KINDS_IN_LANES  // shape/kinds.h; the order of operations is that of above

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Which lines of rays hit the spheres at centres (x, y, z) relative to their origins; gives the
// middle of the chord and the square of half its length.
template <class D>
struct SphereLanes {
  hn::Mask<D> in;
  hn::Vec<D> middle, d2;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE SphereLanes<D> chord_test(D d, V x, V y, V z, V radius, V dx, V dy, V dz) {
  const V middle = dot(d, x, y, z, dx, dy, dz);
  const V px = hn::Sub(x, hn::Mul(dx, middle));
  const V py = hn::Sub(y, hn::Mul(dy, middle));
  const V pz = hn::Sub(z, hn::Mul(dz, middle));
  const V d2 = hn::Sub(hn::Mul(radius, radius), dot(d, px, py, pz, px, py, pz));
  return {hn::Ge(d2, hn::Zero(d)), middle, d2};
}
// The distance; not positive for spheres behind the ray.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V chord_distance(D d, V middle, V d2) {
  const V half = hn::Sqrt(d2);
  const V entry = hn::Sub(middle, half);
  return hn::IfThenElse(hn::Gt(entry, hn::Zero(d)), entry, hn::Add(middle, half));
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // RAIO_KINDS_IN_LANES
