// The numbers of a ray's test with a primitive: they end in the structure's own distance, for every
// kind, and name the condition of a miss.
#include "app/test_numbers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "accel/accel.h"
#include "accel_rays.h"
#include "scenes.h"

namespace raio::core::app {
namespace {

const std::vector<double>* find(const TestNumbers& numbers, std::string_view name) {
  for (const auto& [key, value] : numbers.values)
    if (key == name) return &value;
  return nullptr;
}
double number(const TestNumbers& numbers, std::string_view name) {
  const auto* const value = find(numbers, name);
  EXPECT_TRUE(value && value->size() == 1) << name;
  return value ? value->front() : std::nan("");
}
Vec3d vector(const TestNumbers& numbers, std::string_view name) {
  const auto* const value = find(numbers, name);
  EXPECT_TRUE(value && value->size() == 3) << name;
  return value ? Vec3d((*value)[0], (*value)[1], (*value)[2]) : Vec3d();
}

TEST(TestNumbers, EndInTheDistanceOrNameTheMiss) {
  Scene scene = tests::random_scene(400, 3);
  for (size_t i = 0; i < 40; ++i) {
    const Vec3f to = scene.spheres[i].center, from = scene.spheres[i + 40].center;
    scene.moving_spheres.push_back({from, to, 0.2f, 0, 1});
    scene.moving_sphere_materials.push_back(0);
    const Triangle t{from, from + Vec3f(0.4f, 0, 0), from + Vec3f(0, 0.3f, 0.3f)};
    scene.moving_triangles.push_back({t, {to, to + (t.b - t.a), to + (t.c - t.a)}, 0, 1});
    scene.moving_triangle_materials.push_back(0);
  }
  const auto accel = build_accel(scene, {.kind = AccelKind::bvh});
  ASSERT_TRUE(accel.has_value());
  const Geometry& geometry = (*accel)->geometry();
  const RayBatch rays = tests::awkward_rays(scene, 2000, 9);
  std::map<PrimitiveKind, std::array<int, 2>> counts;  // misses, hits
  for (size_t i = 0; i < rays.size(); ++i) {
    Ray ray = rays[i];
    ray.time = float(i % 10) / 10;
    const auto log = (*accel)->log(ray, false);
    ASSERT_TRUE(log.has_value());
    for (const TraceLog::Test& test : log->tests) {
      const PrimitiveKind kind = geometry.kind_of(test.primitive);
      const TestNumbers numbers = test_numbers(geometry, test.primitive, ray);
      SCOPED_TRACE(testing::Message() << "ray " << i << ' ' << kPrimitiveKindNames[size_t(kind)]);
      EXPECT_STRNE(numbers.formula, "");
      const bool hit = std::isfinite(test.t);
      ++counts[kind][hit];
      if (hit) {
        EXPECT_STREQ(numbers.miss, "");
        EXPECT_EQ(float(number(numbers, "t")), test.t);
      } else if (!*numbers.miss) {
        // Only the side that the ray does not meet is visible.
        EXPECT_NE(geometry.sides_of(kind, geometry.index_of(test.primitive)), Sides::both);
      }
    }
  }
  EXPECT_EQ(counts.size(), kPrimitiveKinds);
  for (const auto& [kind, count] : counts) {
    EXPECT_GT(count[0], 3) << kPrimitiveKindNames[size_t(kind)];
    EXPECT_GT(count[1], 3) << kPrimitiveKindNames[size_t(kind)];
  }
}

// U, V and W, divided by their sum, are the weights that Möller and Trumbore's test computes.
TEST(TestNumbers, EdgeFunctionsGiveTheBarycentricWeights) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto point = [&] {
    const float x = unit(rng), y = unit(rng), z = unit(rng);
    return Vec3f(x, y, z);
  };
  int hits = 0, misses = 0;
  for (int k = 0; k < 2000; ++k) {
    Scene scene;
    scene.materials = {{}};
    scene.positions = {point(), point(), point()};
    scene.triangles = {{0, 1, 2}};
    scene.triangle_materials = {0};
    const Geometry geometry(scene, scene);
    // Through a point of the triangle or beside it.
    const float along = unit(rng), across = unit(rng);
    const Vec3f from = point() * 3, corner = scene.positions[0];
    const Vec3f target =
        corner + (scene.positions[1] - corner) * along + (scene.positions[2] - corner) * across;
    const Ray ray{from, normalize(target - from)};
    const TestNumbers numbers = test_numbers(geometry, 0, ray);
    const Vec3d a = vector(numbers, "P0"), e1 = vector(numbers, "P1") - a,
                e2 = vector(numbers, "P2") - a, d(ray.dir), s = Vec3d(ray.origin) - a;
    const Vec3d p = cross(d, e2), q = cross(s, e1);
    const double det = dot(e1, p);
    if (std::abs(det) < 1e-2) continue;
    const double b1 = dot(s, p) / det, b2 = dot(d, q) / det, t = dot(e2, q) / det;
    EXPECT_NEAR(number(numbers, "b0"), 1 - b1 - b2, 1e-3 * (1 + std::abs(b1) + std::abs(b2)));
    EXPECT_NEAR(number(numbers, "b1"), b1, 1e-3 * (1 + std::abs(b1)));
    EXPECT_NEAR(number(numbers, "b2"), b2, 1e-3 * (1 + std::abs(b2)));
    EXPECT_NEAR(number(numbers, "t"), t, 1e-3 * (1 + std::abs(t)));
    const double u = number(numbers, "U"), v = number(numbers, "V"), w = number(numbers, "W");
    EXPECT_EQ(float(float(float(u) + float(v)) + float(w)), float(number(numbers, "U + V + W")));
    const double least = std::min({b1, b2, 1 - b1 - b2});
    if (std::abs(least) < 1e-3 || std::abs(t) < 1e-3) continue;
    EXPECT_EQ(*numbers.miss == 0, least > 0 && t > 0);
    ++(least > 0 && t > 0 ? hits : misses);
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 500);
}

}  // namespace
}  // namespace raio::core::app
