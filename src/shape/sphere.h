// Spheres.
#pragma once

#include <optional>

#include "base/box.h"
#include "base/ray.h"
#include "shape/kinds.h"

namespace raio {

/// As NFF has it: a negative radius is a sphere of which only the inside is seen.
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

/// With a radius that is not negative.
inline Sphere bake(const Sphere& s) { return {s.center, std::abs(s.radius)}; }

inline Box3f bounds(const Sphere& s) {
  const Vec3d c(s.center), r(std::abs(double(s.radius)));
  return rounded_out({c - r, c + r});
}

/// The distances at which a ray enters and leaves; `entry > exit` when it misses.
struct SphereRoots {
  float entry = 1, exit = 0;
};

/// The ray's point nearest to the centre is found first and the half chord from there, so that what
/// cancels is of the size of the sphere and not of its distance: Haines, Guenther and
/// Akenine-Moeller 2019, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems,
/// chapter 7. The radius must not be negative.
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

/// Does the surface (a shell, not the ball) touch the box? Exact but for rounding, and then never
/// wrong with "no".
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
  // The differences are rounded by half an ulp of the largest coordinate, the lengths by two of
  // their own.
  const double r = std::abs(double(s.radius));
  const double slack = 4 * std::numeric_limits<double>::epsilon() * (largest + r);
  return std::sqrt(nearest) <= r + slack && r - slack <= std::sqrt(farthest);
}

}  // namespace raio
