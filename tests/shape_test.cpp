#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "random_shapes.h"
#include "shape/cone.h"
#include "shape/kinds.h"
#include "shape/plane.h"
#include "shape/sphere.h"
#include "shape/triangle.h"

// Bounds are multiples of float epsilon times (distance + size), with the distance from the ray's
// origin to the shape: the best a float ray can do. "Clear" hits and misses are those of the
// reference for both the enlarged and the reduced shape.

namespace raio::core {
namespace {

using Real = long double;
using Vec3r = Vec3<Real>;

constexpr Real kEpsilon = std::numeric_limits<float>::epsilon();
constexpr double kPi = std::numbers::pi;

using tests::Random;

Vec3f unit(Vec3d v) { return Vec3f(normalize(v)); }

/// A ray from `distance` away (or from inside, if small) past the point `at`.
Ray ray_past(Vec3d at, Vec3d dir, double distance) {
  const Vec3f origin(at - dir * distance);
  return {origin, distance > 0 ? unit(at - Vec3d(origin)) : unit(dir)};
}

/// The tested scales and positions: size, and distance from the origin in sizes.
struct Setting {
  double size;
  Vec3d place;
};

Setting random_setting(Random& random) {
  const double size = random.one_of({1e-6, 1.0, 1e6});
  return {size, random.direction() * size * random.one_of({0.0, 1.0, 1e3, 1e5})};
}

double random_distance(Random& random, double size) {
  return size * random.one_of({0.0, 0.5, 3.0, 1e2, 1e4, 1e6});
}

// Spheres

/// Bisection of |o + t d - c| - r on both sides of the nearest point.
std::vector<Real> sphere_reference(Vec3f center, Real radius, const Ray& ray) {
  const Vec3r d(ray.dir), o = Vec3r(ray.origin) - Vec3r(center);
  const auto height = [&](Real t) { return length(o + d * t) - radius; };
  const Real middle = -dot(o, d) / dot(d, d);
  if (height(middle) > 0) return {};
  std::vector<Real> roots;
  for (const int side : {-1, 1}) {
    Real in = middle, out = middle + side * radius * 1.01L;
    for (int k = 0; k < 70; ++k) {
      const Real half = (in + out) / 2;
      (height(half) < 0 ? in : out) = half;
    }
    roots.push_back(in);
  }
  return roots;
}

TEST(Sphere, ClosedForms) {
  const auto roots = [](Vec3f o, Vec3f d) { return sphere_roots({0, 0, 0}, 2, {o, d}); };
  const SphereRoots front = roots({-5, 0, 0}, {1, 0, 0});
  EXPECT_EQ(front.entry, 3);
  EXPECT_EQ(front.exit, 7);
  const SphereRoots inside = roots({0, 0, 0}, {0, 0, 1});
  EXPECT_EQ(inside.entry, -2);
  EXPECT_EQ(inside.exit, 2);
  const SphereRoots behind = roots({5, 0, 0}, {1, 0, 0});
  EXPECT_EQ(behind.exit, -3);
  const SphereRoots tangent = roots({-5, 2, 0}, {1, 0, 0});
  EXPECT_EQ(tangent.entry, 5);
  EXPECT_EQ(tangent.exit, 5);
  const SphereRoots miss = roots({-5, std::nextafter(2.f, 3.f), 0}, {1, 0, 0});
  EXPECT_GT(miss.entry, miss.exit);
}

TEST(Sphere, AgreesWithBisection) {
  Random random(1);
  constexpr Real kBound = 3;
  int hits = 0, misses = 0, unclear = 0;
  for (int k = 0; k < 60000; ++k) {
    const Setting setting = random_setting(random);
    const Vec3f center(setting.place);
    const float radius = float(setting.size);
    // Past a point at a chosen distance from the centre, often very near the silhouette.
    const Vec3d dir = random.direction();
    const double off = k % 2 == 0 ? random.uniform(0, 1.5)
                                  : 1 + random.one_of({-1, 1}) * random.log_uniform(1e-7, 1e-2);
    const Vec3d at = Vec3d(center) + Frame<double>(dir).u * (off * radius);
    const Ray ray = ray_past(at, dir, random_distance(random, radius));
    const Real distance = length(Vec3r(ray.origin) - Vec3r(center));
    const Real bound = kBound * kEpsilon * (distance + radius);
    const SphereRoots roots = sphere_roots(center, radius, ray);
    const bool found = roots.entry <= roots.exit;
    const bool inner = radius > bound && !sphere_reference(center, radius - bound, ray).empty();
    const bool outer = !sphere_reference(center, radius + bound, ray).empty();
    (inner ? hits : outer ? unclear : misses)++;
    ASSERT_TRUE(found || !inner) << "lost at distance " << distance / radius << " off " << off;
    ASSERT_TRUE(!found || outer) << "made up at distance " << distance / radius;
    if (!found) continue;
    for (const float t : {roots.entry, roots.exit}) {
      const Vec3r p = Vec3r(ray.origin) + Vec3r(ray.dir) * Real(t) - Vec3r(center);
      ASSERT_LE(std::abs(length(p) - radius), bound) << "distance " << distance / radius;
    }
    const auto reference = sphere_reference(center, radius, ray);
    if (reference.empty()) continue;
    // An error of the height is one of 1 / cosine times as much along the ray.
    const Real slant = 2 * Real(radius) / (reference[1] - reference[0]);
    if (bound * slant * slant > 0.1L * radius) continue;
    ASSERT_LE(std::abs(roots.entry - reference[0]), 2 * bound * slant);
    ASSERT_LE(std::abs(roots.exit - reference[1]), 2 * bound * slant);
  }
  EXPECT_GT(hits, 20000);
  EXPECT_GT(misses, 10000);
  EXPECT_LT(unclear, 20000);
}

// Cones

/// The quadratic in the cone's own coordinates, about the ray's point nearest to the base.
std::vector<Real> cone_reference(const BakedCone& c, Real radius, Real margin, const Ray& ray) {
  const Vec3r axis = normalize(Vec3r(c.axis));
  const Frame<Real> frame(axis);
  const auto local = [&](Vec3r v) { return Vec3r(dot(v, frame.u), dot(v, frame.v), dot(v, axis)); };
  const Vec3r o = local(Vec3r(ray.origin) - Vec3r(c.base)), d = local(Vec3r(ray.dir));
  const Real start = -dot(o, d) / dot(d, d), k = c.slope;
  const Vec3r p = o + d * start;
  const Real r = radius + k * p.z, kd = k * d.z;
  const Real a = d.x * d.x + d.y * d.y - kd * kd;
  const Real b = 2 * (p.x * d.x + p.y * d.y - r * kd);
  const Real q = p.x * p.x + p.y * p.y - r * r;
  std::vector<Real> roots;
  const auto add = [&](Real s) {
    const Real z = p.z + s * d.z;
    if (z >= -margin && z <= c.height + margin && radius + k * z >= 0) roots.push_back(start + s);
  };
  const Real disc = b * b - 4 * a * q;
  if (disc < 0) return roots;
  const Real root = std::sqrt(disc);
  if (b > 0) {
    add((-b - root) / (2 * a)), add(-2 * q / (b + root));
  } else {
    add((root - b) / (2 * a)), add(2 * q / (root - b));
  }
  std::ranges::sort(roots);
  return roots;
}

Cone random_cone(Random& random, const Setting& setting) {
  const double height = setting.size * random.log_uniform(0.01, 1);
  const double r0 = setting.size * random.log_uniform(0.01, 1);
  const double r1 = random.one_of({0.0, r0, 0.3 * r0, 2 * r0});
  const Vec3f base(setting.place);
  return {base, float(r0), Vec3f(Vec3d(base) + random.direction() * height), float(r1)};
}

TEST(Cone, ClosedForms) {
  const auto roots = [](const Cone& c, Vec3f o, Vec3f d) {
    return cone_roots(BakedCone(c), {o, normalize(d)});
  };
  const Cone cylinder{{0, 0, 0}, 1, {0, 0, 2}, 1};
  ConeRoots r = roots(cylinder, {-5, 0, 1}, {1, 0, 0});
  ASSERT_EQ(r.count, 2);
  EXPECT_EQ(r.t[0], 4);
  EXPECT_EQ(r.t[1], 6);
  EXPECT_LT(r.cosine[0], 0);
  EXPECT_GT(r.cosine[1], 0);
  EXPECT_EQ(roots(cylinder, {-5, 0, 3}, {1, 0, 0}).count, 0);
  EXPECT_EQ(roots(cylinder, {0, 0, -5}, {0, 0, 1}).count, 0);     // along the axis
  EXPECT_EQ(roots(cylinder, {0.5f, 0, -5}, {0, 0, 1}).count, 0);  // next to it
  r = roots(cylinder, {0, 0, 1}, {0, 1, 0});                      // from inside
  ASSERT_EQ(r.count, 2);
  EXPECT_EQ(r.t[0], -1);
  EXPECT_EQ(r.t[1], 1);
  r = roots(cylinder, {0, 0, -1}, {1, 0, 1});  // in through the open end
  ASSERT_EQ(r.count, 1);
  EXPECT_FLOAT_EQ(r.t[0], std::sqrt(2.f));
  EXPECT_GT(r.cosine[0], 0);

  const Cone pointed{{0, 0, 0}, 1, {0, 0, 1}, 0};
  r = roots(pointed, {-5, 0, 0.5f}, {1, 0, 0});
  ASSERT_EQ(r.count, 2);
  EXPECT_FLOAT_EQ(r.t[0], 4.5f);
  EXPECT_FLOAT_EQ(r.t[1], 5.5f);
  EXPECT_EQ(roots(pointed, {-5, 0, 1.5f}, {1, 0, 0}).count, 0);  // only its mirror image is there
  r = roots(pointed, {0, 0, 5}, {0, 0, -1});                     // onto the tip, along the axis
  for (int i = 0; i < r.count; ++i) EXPECT_FLOAT_EQ(r.t[i], 4);

  const Cone frustum{{0, 0, 0}, 2, {0, 0, 1}, 1};
  r = roots(frustum, {1.5f, 0, -1},
            {0, 0, 1});  // parallel to the axis, onto the inside of the wall
  ASSERT_EQ(r.count, 1);
  EXPECT_FLOAT_EQ(r.t[0], 1.5f);
  EXPECT_GT(r.cosine[0], 0);
  // Parallel to the wall x = 2 - z, so only x = z - 2 is hit: at z = 0.75 and, beyond the end, 1.5.
  r = roots(frustum, {0, 0, -0.5f}, {-1, 0, 1});
  ASSERT_EQ(r.count, 1);
  EXPECT_FLOAT_EQ(r.t[0], 1.25f * std::sqrt(2.f));
  EXPECT_EQ(roots(frustum, {1, 0, 0}, {-1, 0, 1}).count, 0);
}

TEST(Cone, AgreesWithTheReference) {
  Random random(2);
  constexpr Real kBound = 3;
  int hits = 0, misses = 0;
  for (int k = 0; k < 60000; ++k) {
    const Setting setting = random_setting(random);
    const Cone cone = random_cone(random, setting);
    const BakedCone c(cone);
    // Past a point of the surface, or one near its silhouette, or any point around.
    const Vec3d axis = normalize(Vec3d(c.axis)), dir = random.direction();
    const Vec3d across = k % 3 == 0 ? normalize(cross(axis, dir)) : Frame<double>(axis).u;
    const double z = c.height * random.uniform(-0.1, 1.1), radius = c.base_radius + c.slope * z;
    const double off = k % 3 == 2 ? random.uniform(-1.5, 1.5)
                                  : 1 + random.one_of({-1, 1}) * random.log_uniform(1e-7, 1e-2);
    const Vec3d at = Vec3d(c.base) + axis * z + across * (radius * off);
    const Ray ray = ray_past(at, dir, random_distance(random, setting.size));
    const Real distance = length(Vec3r(ray.origin) - Vec3r(c.base));
    const Real bound = kBound * kEpsilon * (distance + setting.size);
    const ConeRoots roots = cone_roots(c, ray);
    for (int i = 0; i < roots.count; ++i) {
      const Vec3r p = Vec3r(ray.origin) + Vec3r(ray.dir) * Real(roots.t[i]);
      ASSERT_LE(cone_distance(c, Vec3d(p)), double(bound));
      // The sign of the cosine, if unambiguous, agrees with the normal.
      const double cosine = dot(Vec3d(cone_normal(c, Vec3f(p))), Vec3d(ray.dir));
      const Real here = c.base_radius + c.slope * dot(p - Vec3r(c.base), Vec3r(c.axis));
      if (bound + kEpsilon * length(p) < 1e-3L * here && std::abs(cosine) > 0.02) {
        ASSERT_EQ(roots.cosine[i] > 0, cosine > 0);
      }
    }
    // The distance in the slope's direction that the bound stands for.
    const Real grow = bound * std::hypot(Real(1), Real(c.slope));
    // A clear result is shared by all four cones that are wider or narrower and longer or shorter
    // by that.
    std::vector<Real> least, most;
    bool clear = true;
    for (const int wider : {-1, 0, 1}) {
      for (const int longer : {-1, 1}) {
        auto t = cone_reference(c, c.base_radius + wider * grow, longer * bound, ray);
        if (wider < 0 && longer < 0) least = most = t;
        clear = clear && t.size() == least.size();
        if (!clear) continue;
        for (size_t i = 0; i < t.size(); ++i) {
          least[i] = std::min(least[i], t[i]), most[i] = std::max(most[i], t[i]);
        }
      }
    }
    if (!clear || bound > 0.01L * std::min(c.base_radius, c.height)) continue;
    (least.empty() ? misses : hits)++;
    ASSERT_EQ(roots.count, int(least.size()));
    for (int i = 0; i < roots.count; ++i) {
      ASSERT_GE(roots.t[i], least[i] - bound);
      ASSERT_LE(roots.t[i], most[i] + bound);
    }
  }
  EXPECT_GT(hits, 15000);
  EXPECT_GT(misses, 5000);
}

TEST(Cone, NormalIsTheGradient) {
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const BakedCone c(random_cone(random, {1, {}}));
    const Vec3d axis(c.axis);
    const double z = c.height * random.uniform(0.05, 0.95), angle = random.uniform(0, 2 * kPi);
    const Frame<double> f(axis);
    const double radius = c.base_radius + c.slope * z;
    const Vec3d across = f.u * std::cos(angle) + f.v * std::sin(angle);
    const Vec3d p = Vec3d(c.base) + axis * z + across * radius;
    const auto height = [&](Vec3d x) {
      const Vec3d from = x - Vec3d(c.base);
      const double along = dot(from, axis);
      return length(from - axis * along) - (c.base_radius + c.slope * along);
    };
    const double h = 1e-6;
    Vec3d gradient;
    for (int a = 0; a < 3; ++a) {
      Vec3d step;
      step[a] = h;
      gradient[a] = (height(p + step) - height(p - step)) / (2 * h);
    }
    const Vec3f n = cone_normal(c, Vec3f(p));
    ASSERT_NEAR(length(Vec3d(n)), 1, 2e-7);
    ASSERT_LT(length(Vec3d(n) - normalize(gradient)), 1e-6 / radius);
  }
  const BakedCone tip(Cone{{0, 0, 0}, 1, {0, 0, 1}, 0});
  EXPECT_TRUE(is_finite(cone_normal(tip, {0, 0, 1})));
}

// Planes

TEST(Plane, ClosedForms) {
  const Plane floor{{7, -3, 1}, {0, 0, 1}};
  EXPECT_EQ(intersect(floor, {{0, 0, 5}, {0, 0, -1}}), 4);
  EXPECT_EQ(intersect(floor, {{0, 0, 5}, {0, 0, 1}}), -4);
  EXPECT_EQ(intersect(floor, {{0, 0, 5}, {1, 0, 0}}), std::nullopt);
  EXPECT_EQ(intersect(floor, {{0, 0, 1}, {0, 0, 1}}), 0);
}

TEST(Plane, HitsLieInThePlane) {
  Random random(4);
  for (int k = 0; k < 50000; ++k) {
    const Setting setting = random_setting(random);
    const Plane plane{Vec3f(setting.place), unit(random.direction())};
    const Vec3d n(plane.normal);
    const double cosine = random.log_uniform(1e-4, 1) * random.one_of({-1, 1});
    const Vec3d dir = normalize(Frame<double>(normalize(n)).u + n * cosine);
    const Ray ray = ray_past(setting.place, dir, random_distance(random, setting.size));
    const auto t = intersect(plane, ray);
    ASSERT_TRUE(t.has_value());
    const Vec3r p = Vec3r(ray.origin) + Vec3r(ray.dir) * Real(*t);
    const Real height = dot(Vec3r(plane.normal), p - Vec3r(plane.point));
    // The rounding of t: half an ulp divided by the cosine; and doubles on the way.
    const Real seen = std::abs(dot(Vec3r(plane.normal), Vec3r(ray.dir)));
    const Real doubles = 1e-15L * (length(Vec3r(ray.origin)) + length(Vec3r(plane.point)));
    ASSERT_LE(std::abs(height), kEpsilon / 2 * std::abs(Real(*t)) * seen * 1.01L + doubles);
  }
}

TEST(Kinds, VisibleSides) {
  EXPECT_TRUE(visible(Sides::both, -1) && visible(Sides::both, 1));
  EXPECT_TRUE(visible(Sides::outside, -1) && !visible(Sides::outside, 1));
  EXPECT_TRUE(visible(Sides::inside, 1) && !visible(Sides::inside, -1));
}

// Boxes

Vec3d point_on(Random& random, const Sphere& s) {
  return Vec3d(s.center) + random.direction() * std::abs(double(s.radius));
}

Vec3d point_on(Random& random, const BakedCone& c) {
  const Vec3d axis = normalize(Vec3d(c.axis));
  const Frame<double> f(axis);
  const double z = c.height * random.one_of({0.0, 1.0, random.uniform()});
  const double angle = random.one_of({0.0, 0.5, random.uniform(0, 2)}) * kPi;
  return Vec3d(c.base) + axis * z +
         (f.u * std::cos(angle) + f.v * std::sin(angle)) * (c.base_radius + c.slope * z);
}

Vec3d point_on(Random& random, const Triangle& t) {
  double u = random.one_of({0.0, 1.0, random.uniform()}), v = random.uniform(0, 1 - u);
  if (random.uniform() < 0.3) v = 0;
  return Vec3d(t.a) * (1 - u - v) + Vec3d(t.b) * u + Vec3d(t.c) * v;
}

/// A box with the point in it, often on its boundary.
Box3d box_around(Random& random, Vec3d p, double size) {
  Box3d box{p, p};
  box.pad(4e-16 * length(p));  // the point is rounded
  for (int a = 0; a < 3; ++a) {
    box.lo[a] -= size * random.one_of({0.0, 0.1, 1.0}) * random.uniform();
    box.hi[a] += size * random.one_of({0.0, 0.1, 1.0}) * random.uniform();
  }
  return box;
}

template <class Shape>
void check_boxes(Random& random, const Shape& shape, const Setting& setting) {
  const Box3f around = bounds(shape);
  const Vec3d lo(around.lo), hi(around.hi);
  // Sampled points are themselves rounded.
  const double slack = 4e-16 * (length(lo) + length(hi));
  for (int i = 0; i < 20; ++i) {
    const Vec3d p = point_on(random, shape);
    for (int a = 0; a < 3; ++a) {
      ASSERT_GE(p[a], lo[a] - slack);
      ASSERT_LE(p[a], hi[a] + slack);
    }
    ASSERT_TRUE(overlaps(shape, box_around(random, p, setting.size)));
  }
  // Boxes that clearly miss the bounds.
  for (int i = 0; i < 5; ++i) {
    const int axis = int(random.uniform(0, 3));
    const Vec3d size = hi - lo + Vec3d(setting.size * 0.01);
    Box3d box{lo, hi};
    box.lo[axis] = hi[axis] + 0.6 * length(size), box.hi[axis] = box.lo[axis] + size[axis];
    ASSERT_FALSE(overlaps(shape, box));
  }
}

TEST(Boxes, HoldTheSurface) {
  Random random(5);
  for (int k = 0; k < 3000; ++k) {
    const Setting setting = random_setting(random);
    const Vec3d at = setting.place;
    const double size = setting.size;
    const Vec3f a(at), b(at + random.in_cube() * size), c(at + random.in_cube() * size);
    check_boxes(random, Sphere{a, float(size) * random.one_of({1.f, -1.f})}, setting);
    check_boxes(random, BakedCone(random_cone(random, setting)), setting);
    check_boxes(random, Triangle{a, b, c}, setting);
    check_boxes(random, Triangle{a, b, b}, setting);
    check_boxes(random, Triangle{a, a, a}, setting);
  }
}

TEST(Boxes, TouchingOnALatticeIsOverlapping) {
  const Box3d cell{Vec3d(0), Vec3d(1)};
  EXPECT_TRUE(overlaps(Sphere{{2, 0.5f, 0.5f}, 1}, cell));
  EXPECT_FALSE(overlaps(Sphere{{2, 0.5f, 0.5f}, 0.999f}, cell));
  EXPECT_FALSE(overlaps(Sphere{{0.5f, 0.5f, 0.5f}, 1}, cell)) << "the box is inside the shell";
  EXPECT_TRUE(overlaps(Triangle{{1, 0, 0}, {1, 5, 0}, {1, 0, 5}}, cell));
  EXPECT_TRUE(overlaps(Triangle{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}}, cell));
  EXPECT_TRUE(overlaps(Triangle{{3, 0, 0}, {0, 3, 0}, {0, 0, 3}}, cell)) << "touches (1, 1, 1)";
  EXPECT_FALSE(overlaps(Triangle{{3.01f, 0, 0}, {0, 3.01f, 0}, {0, 0, 3.01f}}, cell));
  EXPECT_TRUE(overlaps(Triangle{{-1, 1, 0.5f}, {1, -1, 0.5f}, {1, -1, 0.5f}}, cell)) << "segment";
  EXPECT_FALSE(overlaps(Triangle{{-1.01f, 1, 0.5f}, {1, -1.01f, 0.5f}, {1, -1.01f, 0.5f}}, cell));
  EXPECT_TRUE(overlaps(Triangle{{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, cell)) << "point";
  EXPECT_FALSE(overlaps(Triangle{{-5, 3, 0.5f}, {3, -5, 0.5f}, {3, -5.5f, 0.5f}}, cell));
  const BakedCone cylinder(Cone{{2, 0, -1}, 1, {2, 0, 2}, 1});
  EXPECT_TRUE(overlaps(cylinder, cell));
  EXPECT_FALSE(overlaps(BakedCone(Cone{{0.5f, 0.5f, -9}, 2, {0.5f, 0.5f, 9}, 2}), cell))
      << "inside";
}

}  // namespace
}  // namespace raio::core
