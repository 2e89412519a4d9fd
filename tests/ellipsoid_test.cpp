#include "shape/ellipsoid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "nff_text.h"
#include "random_shapes.h"
#include "scene/scene.h"
#include "shape/offset.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::Random;
using tests::read_objects;

// Semi-axes from 1 down to a thousandth.
Ellipsoid random_ellipsoid(Random& random) {
  const Vec3d n = random.direction();
  const Frame<double> frame(n);
  const auto length = [&] { return std::pow(10, random.uniform(-3, 0)); };
  const Vec3d u = frame.u * length(), v = frame.v * length(), w = n * length();
  return {Vec3f(random.direction() * 5.0), {Vec3f(u), Vec3f(v), Vec3f(w)}};
}

Vec3d surface_of(const Ellipsoid& e, Vec3d unit) {
  return Vec3d(e.center) + Vec3d(e.axes[0]) * unit.x + Vec3d(e.axes[1]) * unit.y +
         Vec3d(e.axes[2]) * unit.z;
}

// Along a unit direction d, semi-axes a, b and c show a silhouette of the area
// pi |(b c cos(d, a), a c cos(d, b), a b cos(d, c))|.
TEST(Ellipsoid, SilhouetteHasTheAreaOfItsShadow) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    Ellipsoid e = random_ellipsoid(random);
    double size[3];
    for (int i = 0; i < 3; ++i) {
      e.axes[i] = Vec3f(normalize(Vec3d(e.axes[i])) * random.uniform(0.3, 1));
      size[i] = length(Vec3d(e.axes[i]));
    }
    const Vec3d d = random.direction();
    Vec3d parts;
    for (int i = 0; i < 3; ++i)
      parts[i] = size[(i + 1) % 3] * size[(i + 2) % 3] * dot(d, Vec3d(e.axes[i])) / size[i];
    const double area = std::numbers::pi * length(parts);
    EXPECT_NEAR(tests::seen_area(bake(e), Vec3d(e.center), d), area, 0.01 * area);
  }
}

TEST(Ellipsoid, DistancesMatchTheTransformedUnitSphere) {
  Random random(2);
  int found = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const Ellipsoid e = random_ellipsoid(random);
    const BakedEllipsoid baked(e);
    const Vec3d target = surface_of(e, random.direction() * random.uniform(0, 0.99));
    const Vec3f dir(random.direction());
    const Ray ray{Vec3f(target - Vec3d(dir) * random.uniform(2, 50)), dir};
    // The quadratic equation in long double.
    long double a = -0, b = 0, c = -1;
    for (const Vec3f& row : baked.to_unit) {
      long double o = 0, d = 0;
      for (int k = 0; k < 3; ++k) {
        o += (static_cast<long double>(ray.origin[k]) - baked.center[k]) * row[k];
        d += static_cast<long double>(ray.dir[k]) * row[k];
      }
      a += d * d, b += o * d, c += o * o;
    }
    const long double disc = b * b - a * c;
    if (disc < 1e-9L * b * b * 1e-6L) continue;
    const double entry = double((-b - std::sqrt(disc)) / a);
    const auto hit = first_hit(baked, ray, Sides::both);
    if (entry < 0.1) continue;
    ++found;
    ASSERT_TRUE(hit) << trial;
    EXPECT_NEAR(hit->t, entry, 2e-7 * entry) << trial;
    const auto inside = first_hit(baked, ray, Sides::inside);
    ASSERT_TRUE(inside);
    EXPECT_GE(inside->t, hit->t);
    // The hit is put back on the surface, and rays that leave it do not hit it again.
    const SurfacePoint s = surface_point(baked, ray.at(hit->t));
    long double unit = 0;
    double steepness = 0;
    for (const Vec3f& row : baked.to_unit) {
      const double x = dot(Vec3d(s.point) - Vec3d(baked.center), Vec3d(row));
      unit += static_cast<long double>(x) * x;
      steepness = std::max(steepness, length(Vec3d(row)));
    }
    EXPECT_NEAR(double(std::sqrt(unit)), 1, 4e-6 * steepness);
    EXPECT_NEAR(length(Vec3d(s.normal)), 1, 1e-6);
    const float scale = max_component(abs(s.point)) + s.extent;
    Vec3d out = random.direction();
    if (dot(out, Vec3d(s.normal)) < 0) out = -out;
    const Ray leaving{offset_origin(s.point, s.normal, scale, true), Vec3f(out)};
    EXPECT_FALSE(first_hit(baked, leaving, Sides::both)) << trial;
  }
  EXPECT_GT(found, 15000);
}

TEST(Ellipsoid, NormalsArePerpendicularToTheSurface) {
  Random random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const Ellipsoid e = random_ellipsoid(random);
    const Vec3d u = random.direction();
    const Frame<double> tangents(u);
    const Vec3d p = surface_of(e, u);
    const SurfacePoint s = surface_point(bake(e), Vec3f(p));
    // A tangent of the sphere goes to one of the ellipsoid.
    for (const Vec3d& t : {tangents.u, tangents.v}) {
      const Vec3d along = normalize(surface_of(e, t) - Vec3d(e.center));
      EXPECT_NEAR(dot(along, Vec3d(s.normal)), 0, 5e-3) << trial;
    }
    EXPECT_GT(dot(Vec3d(s.normal), p - Vec3d(e.center)), 0);
  }
}

TEST(Ellipsoid, BoundsAreTightAndOverlapsAreConservative) {
  Random random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const Ellipsoid e = random_ellipsoid(random);
    const BakedEllipsoid baked(e);
    const Box3f box = bounds(baked);
    for (int a = 0; a < 3; ++a) {
      // The support point along the axis.
      const Vec3d reach(e.axes[0][a], e.axes[1][a], e.axes[2][a]);
      EXPECT_NEAR(box.hi[a], e.center[a] + length(reach), 2e-6);
      EXPECT_NEAR(box.lo[a], e.center[a] - length(reach), 2e-6);
    }
    for (int i = 0; i < 50; ++i) {
      const Vec3d p = surface_of(e, random.direction());
      const double size = std::pow(10, random.uniform(-5, 0));
      const Vec3d corner =
          p - Vec3d(random.uniform(0, size), random.uniform(0, size), random.uniform(0, size));
      Box3d near{corner, corner + Vec3d(size)};
      near.pad(1e-6);  // the baked surface is rounded
      EXPECT_TRUE(overlaps(baked, near));
    }
    const Vec3d c(e.center), small = Vec3d(1e-5);
    EXPECT_FALSE(overlaps(baked, {c - small, c + small})) << "inside";
    const Vec3d away(box.hi + Vec3f(0.5f));
    EXPECT_FALSE(overlaps(baked, {away, away + small}));
  }
}

TEST(Ellipsoid, IsReadAndWrittenAndItsFaultsAreNamed) {
  const Scene scene = read_objects("ellipsoid 1 2 3  0 2 0  -1 0 0  0 0 0.5\n");
  ASSERT_EQ(scene.ellipsoids.size(), 1u);
  EXPECT_TRUE(tests::same(scene.ellipsoids[0],
                          Ellipsoid{{1, 2, 3}, {{0, 2, 0}, {-1, 0, 0}, {0, 0, 0.5f}}}));
  EXPECT_THAT(write_nff(scene), HasSubstr("ellipsoid 1 2 3 0 2 0 -1 0 0 0 0 0.5\n"));
  const auto error = [](const std::string& line) {
    const auto result = parse_nff(tests::kCamera + tests::kMaterial + line, "x.nff");
    return result ? std::string("sound") : result.error()[0].message;
  };
  EXPECT_EQ(error("ellipsoid 0 0 0 1 0 0 1 1 0 0 0 1\n"),
            "semi-axes 1 and 2 are 45 degrees apart, expected 90; make them perpendicular");
  EXPECT_EQ(error("ellipsoid 0 0 0 1 0 0 0 1 0 0 0 0\n"), "semi-axis 3 is zero");
  EXPECT_EQ(error("ellipsoid 0 0 0 1 0 0 0 1 0 0 0 1e-45\n"),
            "a semi-axis is too short or too long for a float");
  EXPECT_EQ(error("ellipsoid 0 0 0 1 0 0 0 1\ns 0 0 0 1\n"),
            "expected a number for z of semi-axis 2 of the ellipsoid, found \"s\"");
}

TEST(Ellipsoid, IsCountedAndHashed) {
  Scene scene = read_objects("s 0 0 0 1\n");
  const std::string name = content_hash(scene);
  scene.ellipsoids = {{{0, 0, 0}, {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}}};
  scene.ellipsoid_materials = {0};
  EXPECT_EQ(count_primitives(scene)[size_t(ShapeKind::ellipsoid)], 1u);
  EXPECT_THAT(validate(scene), ElementsAre());
  const std::string with = content_hash(scene);
  EXPECT_NE(with, name);
  scene.ellipsoids[0].axes[2].z = 4;
  EXPECT_NE(content_hash(scene), with);
  EXPECT_FLOAT_EQ(bounds(scene).hi.z, 4);
  scene.ellipsoids[0].axes[2] = {0, 1, 1};
  EXPECT_THAT(validate(scene),
              ElementsAre("ellipsoid 0: the semi-axes must be perpendicular to each other"));
}

}  // namespace
}  // namespace raio::core
