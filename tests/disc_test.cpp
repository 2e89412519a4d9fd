#include "shape/disc.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "accel_rays.h"
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

Disc random_disc(Random& random) {
  const double radius = std::pow(10, random.uniform(-2, 0));
  return {Vec3f(random.direction() * 5.0), Vec3f(random.direction()), float(radius),
          float(radius * std::max(0.0, random.uniform(-1, 0.9)))};
}

// The area of a ring seen from direction d: pi (R^2 - r^2) |cos(n, d)|.
TEST(Disc, ShowsTheAreaOfARing) {
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    Disc disc = random_disc(random);
    disc.radius = 0.9f, disc.inner = float(trial) * 0.08f;
    const Vec3d d = random.direction();
    const double R = disc.radius, r = disc.inner;
    const double area = std::numbers::pi * (R * R - r * r) * std::abs(dot(d, Vec3d(disc.normal)));
    EXPECT_NEAR(tests::seen_area(disc, Vec3d(disc.center), d), area, 0.01 * area + 0.002);
  }
}

TEST(Disc, IsHitWhereRaysAim) {
  Random random(2);
  for (int trial = 0; trial < 20000; ++trial) {
    const Disc disc = random_disc(random);
    const Vec3d normal(disc.normal);
    const Frame<double> frame(normal);
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const double part = random.uniform(0, 1.5), rho = part * disc.radius;
    const Vec3d target =
        Vec3d(disc.center) + (frame.u * std::cos(angle) + frame.v * std::sin(angle)) * rho;
    const Vec3f dir(random.direction());
    const double cosine = dot(Vec3d(dir), normal), distance = random.uniform(1, 50);
    const Ray ray{Vec3f(target - Vec3d(dir) * distance), dir};
    // Rounding moves the hit on the plane by an ulp of the distance divided by the cosine.
    const double unsure = 4e-7 * distance / std::abs(cosine);
    if (std::abs(rho - disc.radius) < unsure || std::abs(rho - disc.inner) < unsure) continue;
    const bool expected = rho < disc.radius && rho > disc.inner;
    const auto hit = first_hit(disc, ray, Sides::both);
    ASSERT_EQ(hit.has_value(), expected) << trial;
    if (!hit) continue;
    EXPECT_NEAR(hit->t, distance, unsure);
    EXPECT_EQ(first_hit(disc, ray, Sides::outside).has_value(), cosine < 0);
    EXPECT_EQ(first_hit(disc, ray, Sides::inside).has_value(), cosine >= 0);
    const SurfacePoint s = surface_point(disc, ray.at(hit->t));
    EXPECT_EQ(s.normal, disc.normal);
    EXPECT_NEAR(dot(Vec3d(s.point) - Vec3d(disc.center), normal), 0, 1e-6);
    const float scale = max_component(abs(s.point)) + s.extent;
    Vec3d out = random.direction();
    if (dot(out, normal) < 0) out = -out;
    EXPECT_FALSE(
        first_hit(disc, {offset_origin(s.point, s.normal, scale, true), Vec3f(out)}, Sides::both));
    EXPECT_FALSE(first_hit(disc, {offset_origin(s.point, s.normal, scale, false), Vec3f(-out)},
                           Sides::both));
  }
}

TEST(Disc, BoundsAreTightAndOverlapsAreConservative) {
  Random random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const Disc disc = random_disc(random);
    const Box3f box = bounds(disc);
    const Frame<double> frame{Vec3d(disc.normal)};
    Box3d around;
    for (int i = 0; i < 1000; ++i) {
      const double angle = i * (2 * std::numbers::pi / 1000);
      const Vec3d across = frame.u * std::cos(angle) + frame.v * std::sin(angle);
      around.extend(Vec3d(disc.center) + across * double(disc.radius));
      const double rho = random.uniform(disc.inner, disc.radius);
      const double size = std::pow(10, random.uniform(-5, 0));
      const Vec3d corner =
          Vec3d(disc.center) + across * rho -
          Vec3d(random.uniform(0, size), random.uniform(0, size), random.uniform(0, size));
      Box3d near{corner, corner + Vec3d(size)};
      near.pad(1e-6);  // the frame is as long as the rounded normal
      EXPECT_TRUE(overlaps(disc, near));
    }
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(box.lo[a], around.lo[a], 2e-5 * disc.radius + 1e-6);
      EXPECT_NEAR(box.hi[a], around.hi[a], 2e-5 * disc.radius + 1e-6);
    }
    const Vec3d above = Vec3d(disc.center) + Vec3d(disc.normal) * (0.2 * disc.radius);
    EXPECT_FALSE(overlaps(disc, {above, above + Vec3d(1e-4 * disc.radius)}));
    if (disc.inner > 0.1f * disc.radius) {
      const Vec3d hole(disc.center), small(0.01 * disc.radius);
      EXPECT_FALSE(overlaps(disc, {hole - small, hole + small}));
    }
  }
}

TEST(Disc, SidesAreCulledInEveryStructure) {
  Scene scene;
  scene.materials = {{}};
  scene.discs = {{{0, 0, 0}, {0, 0, 1}, 1, 0}, {{5, 0, 0}, {0, 0, -1}, 1, 0.5f}};
  scene.disc_materials = {0, 0};
  scene.ellipsoids = {{{10, 0, 0}, {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}}};
  scene.ellipsoid_materials = {0};
  RayBatch rays;
  for (const float x : {0.0f, 5.7f, 5.0f, 10.0f}) rays.push({{x, 0, 5}, {0, 0, -1}});
  rays.push({{10, 0, 0}, {0, 0, -1}});  // from inside
  constexpr float kMiss = -1;
  const float both[] = {5, 5, kMiss, 2, 3}, one[] = {5, kMiss, kMiss, 2, kMiss};
  std::vector<AccelKind> kinds = {AccelKind::none, AccelKind::grid, AccelKind::bvh};
#ifndef RAIO_NO_EMBREE
  kinds.push_back(AccelKind::embree);
#endif
  for (const AccelKind kind : kinds)
    for (const bool one_sided : {false, true}) {
      HitBatch hits;
      TraceContext context;
      tests::build(scene, {.kind = kind}, one_sided)->closest(rays, hits, context);
      for (int i = 0; i < 5; ++i) {
        const float expected = one_sided ? one[i] : both[i];
        EXPECT_EQ(hits[i].found() ? hits[i].t : kMiss, expected) << int(kind) << " ray " << i;
      }
    }
}

TEST(Disc, IsReadAndWrittenAndItsFaultsAreNamed) {
  const Scene scene = read_objects("disc 1 2 3  0 0 2  4\ndisc 1 2 3 0 1 0 4 2\ns 0 0 0 1\n");
  ASSERT_EQ(scene.discs.size(), 2u);
  EXPECT_EQ(scene.spheres.size(), 1u);
  EXPECT_TRUE(tests::same(scene.discs[0], Disc{{1, 2, 3}, {0, 0, 1}, 4, 0}));
  EXPECT_TRUE(tests::same(scene.discs[1], Disc{{1, 2, 3}, {0, 1, 0}, 4, 2}));
  EXPECT_THAT(write_nff(scene), HasSubstr("disc 1 2 3 0 0 1 4\ndisc 1 2 3 0 1 0 4 2\n"));
  const auto error = [](const std::string& line) {
    const auto result = parse_nff(tests::kCamera + tests::kMaterial + line, "x.nff");
    return result ? std::string("sound") : result.error()[0].message;
  };
  EXPECT_EQ(error("disc 0 0 0 0 0 0 1\n"),
            "the normal of the disc is zero, expected the direction that it faces");
  EXPECT_EQ(error("disc 0 0 0 0 0 1 -1\n"), "the radius must be above 0, found -1");
  EXPECT_EQ(error("disc 0 0 0 0 0 1 1 2\n"),
            "the inner radius must be at least 0 and below the radius, 1, found 2");
  EXPECT_EQ(error("disc 0 0 0 0 0 1\ns 0 0 0 1\n"),
            "expected a number for the radius of the disc, found \"s\"");
}

TEST(Disc, FaultsOfScenesMadeInCodeAreNamed) {
  Scene scene = read_objects("disc 0 0 0 0 0 1 1\n");
  EXPECT_THAT(validate(scene), ElementsAre());
  scene.discs[0].normal = {0, 0, 2};
  EXPECT_THAT(validate(scene), ElementsAre("disc 0: the normal must have length 1"));
  scene.discs[0] = {{0, 0, 0}, {0, 0, 1}, 1, 1};
  EXPECT_THAT(validate(scene),
              ElementsAre("disc 0: the inner radius must not be negative, and less than the "
                          "radius"));
}

}  // namespace
}  // namespace raio::core
