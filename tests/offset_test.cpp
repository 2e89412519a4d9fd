#include "shape/offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "random_shapes.h"
#include "shape/cone.h"
#include "shape/plane.h"
#include "shape/sphere.h"
#include "shape/triangle.h"

// Each test hits a shape with random rays, puts the hit back on the surface as shading does, starts
// rays from there into both half spaces, down to grazing ones, and intersects the shape again.

namespace raio::core {
namespace {

using tests::Random;

constexpr int kRays = 150000;

/// A direction in the half of space of the unit vector n: half of them with a cosine between 1e-4
/// and 1e-1.
Vec3f leaving_direction(Random& random, Vec3f n) {
  const bool any = random.uniform() < 0.5;
  const double cosine = any ? random.uniform(1e-4, 1) : std::pow(10.0, random.uniform(-4, -1));
  const Vec3d normal = normalize(Vec3d(n));
  const Frame<double> f(normal);
  const double angle = random.uniform(0, 6.2831853), sine = std::sqrt(1 - cosine * cosine);
  const Vec3d across = f.u * std::cos(angle) + f.v * std::sin(angle);
  return Vec3f(normalize(across * sine + normal * cosine));
}

double random_size(Random& random) { return random.one_of({1e-6, 1.0, 1e6}); }
double random_distance(Random& random) { return random.one_of({0.5, 3.0, 1e2, 1e4, 1e6}); }

Vec3f random_place(Random& random, double size, double farthest) {
  return Vec3f(random.direction() *
               (size * std::min(farthest, random.one_of({0.0, 1.0, 1e3, 1e5}))));
}

Ray ray_to(Vec3d target, Vec3d dir, double distance) {
  const Vec3f origin(target - dir * distance);
  return {origin, Vec3f(normalize(target - Vec3d(origin)))};
}

float largest(Vec3f p) { return max_component(abs(p)); }

TEST(Offset, MovesAlongTheNormalByUlpsOfTheScale) {
  const Vec3f p(1, 2, 3), n(0, 0, 1);
  const float by = 32 * std::numeric_limits<float>::epsilon();
  EXPECT_EQ(offset_origin(p, n, 100, true), Vec3f(1, 2, 3 + 100 * by));
  EXPECT_EQ(offset_origin(p, n, 100, false), Vec3f(1, 2, 3 - 100 * by));
}

TEST(Offset, RaysLeaveASphereOrHitItsFarSide) {
  Random random(1);
  int leaving = 0, entering = 0;
  for (int k = 0; k < kRays; ++k) {
    const double size = random_size(random);
    const Vec3f center = random_place(random, size, 1e5);
    const float radius = float(size);
    const Ray ray = ray_to(Vec3d(center) + random.direction() * (size * 0.99), random.direction(),
                           size * random_distance(random));
    const SphereRoots first = sphere_roots(center, radius, ray);
    if (first.entry > first.exit) continue;
    const Vec3f n = normalize(ray.at(k % 2 ? first.entry : first.exit) - center);
    const Vec3f p = center + n * radius;
    const float scale = largest(p) + radius;

    const Ray out{offset_origin(p, n, scale, true), leaving_direction(random, n)};
    const SphereRoots again = sphere_roots(center, radius, out);
    leaving += again.entry <= again.exit && again.exit > 0;

    const Ray in{offset_origin(p, n, scale, false), leaving_direction(random, -n)};
    const SphereRoots through = sphere_roots(center, radius, in);
    entering += !(through.entry <= 0 && through.exit > 0);
  }
  EXPECT_EQ(leaving, 0);
  EXPECT_EQ(entering, 0);
}

TEST(Offset, RaysLeaveATriangle) {
  Random random(2);
  int met = 0;
  for (int k = 0; k < kRays; ++k) {
    const double size = random_size(random);
    const Vec3d place(random_place(random, size, 1e5));
    const auto corner = [&] { return Vec3f(place + random.direction() * size); };
    const Triangle t{corner(), corner(), corner()};
    const Vec3f n = triangle_normal(t);
    const float edge = std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)});
    // Slivers have no meaningful normal if the vertices are some ulps apart.
    if (n == Vec3f()) continue;
    const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
    const Vec3d target = Vec3d(t.a) * (1 - u - v) + Vec3d(t.b) * u + Vec3d(t.c) * v;
    const Ray ray = ray_to(target, random.direction(), size * random_distance(random));
    const auto h = intersect(t.a, t.b, t.c, ray, ShearedRay(ray.dir));
    if (!h) continue;
    const Vec3f p = t.a * (1 - h->u - h->v) + t.b * h->u + t.c * h->v;
    for (const bool outside : {true, false}) {
      const Vec3f dir = leaving_direction(random, outside ? n : -n);
      const Ray out{offset_origin(p, n, largest(p) + edge, outside), dir};
      const auto again = intersect(t.a, t.b, t.c, out, ShearedRay(dir));
      met += again && again->t > 0;
    }
  }
  EXPECT_EQ(met, 0);
}

TEST(Offset, RaysLeaveAPlane) {
  Random random(3);
  int met = 0;
  for (int k = 0; k < kRays; ++k) {
    const double size = random_size(random);
    const Plane plane{random_place(random, size, 1e5), Vec3f(random.direction())};
    const Vec3d target = Vec3d(plane.point) + random.direction() * size;
    const Ray ray = ray_to(target, random.direction(), size * random_distance(random));
    const auto t = intersect(plane, ray);
    if (!t || !(*t > 0) || *t > 1e7 * size) continue;
    const Vec3f hit = ray.at(*t);
    const double height = dot(Vec3d(plane.normal), Vec3d(hit) - Vec3d(plane.point));
    const Vec3f p(Vec3d(hit) - Vec3d(plane.normal) * height);
    for (const bool outside : {true, false}) {
      const Vec3f dir = leaving_direction(random, outside ? plane.normal : -plane.normal);
      const float scale = largest(p);
      const auto again = intersect(plane, {offset_origin(p, plane.normal, scale, outside), dir});
      met += again && *again > 0;
    }
  }
  EXPECT_EQ(met, 0);
}

TEST(Offset, RaysLeaveACone) {
  Random random(4);
  int leaving = 0, entering = 0, entered = 0;
  for (int k = 0; k < kRays; ++k) {
    const double size = random_size(random);
    const Vec3f base = random_place(random, size, 1e3);
    const double r0 = size * random.one_of({0.03, 0.3, 1.0});
    const double r1 = r0 * random.one_of({0.0, 0.3, 1.0, 2.0});
    const Vec3d height = random.direction() * (size * random.one_of({0.1, 0.5, 1.0}));
    const Cone cone{base, float(r0), Vec3f(Vec3d(base) + height), float(r1)};
    const BakedCone c(cone);
    const Vec3d target = Vec3d(base) + height * random.uniform(0, 1) +
                         random.direction() * (r0 * random.uniform(0, 1));
    const Ray ray = ray_to(target, random.direction(), size * random_distance(random));
    const ConeRoots first = cone_roots(c, ray);
    if (first.count == 0) continue;
    const Vec3f hit = ray.at(first.t[0]);
    // Back along the normal, in double, onto the surface at the hit's height.
    const Vec3f n = cone_normal(c, hit);
    const Vec3d axis(c.axis), x = Vec3d(hit) - Vec3d(base);
    const double z = dot(x, axis), wall = c.base_radius + c.slope * z;
    const double off = (length(x - axis * z) - wall) / std::hypot(1.0, double(c.slope));
    const Vec3f p(Vec3d(hit) - Vec3d(n) * off);
    const float scale = largest(p) + c.height + std::max(cone.base_radius, cone.apex_radius);
    const double offset = 32.0 * std::numeric_limits<float>::epsilon() * scale;
    // At the tip, where the wall is within a few offsets of the axis, the side is undefined.
    if (wall < 16 * offset) continue;

    const ConeRoots again =
        cone_roots(c, {offset_origin(p, n, scale, true), leaving_direction(random, n)});
    for (int i = 0; i < again.count; ++i) leaving += again.t[i] > 0;

    // The near side must not be hit again: a root in front is on the far side, to be left there.
    const ConeRoots in =
        cone_roots(c, {offset_origin(p, n, scale, false), leaving_direction(random, -n)});
    for (int i = 0; i < in.count; ++i) {
      if (!(in.t[i] > 0)) continue;
      ++entered;
      entering += in.cosine[i] < 0;
    }
  }
  EXPECT_EQ(leaving, 0);
  EXPECT_EQ(entering, 0);
  EXPECT_GT(entered, 10000);
}

}  // namespace
}  // namespace raio::core
