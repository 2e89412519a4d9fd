// The tree of lights against brute force and against its own probabilities.
#include "integrate/light_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/executor.h"
#include "sanitized.h"

namespace raio::core {
namespace {

using tests::if_sanitized;

class LightMaker {
 public:
  explicit LightMaker(uint32_t seed) : rng_(seed) {}

  float between(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(rng_);
  }
  Vec3f in_cube() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
  Vec3f direction() {
    for (;;)
      if (const Vec3f v = in_cube(); length(v) < 1 && length(v) > 0.1f) return normalize(v);
  }
  // A direction at most so far from `axis`.
  Vec3f near(Vec3f axis, float cosine) {
    const Frame<float> frame(axis);
    const float c = between(cosine, 1), s = std::sqrt(1 - c * c);
    const Vec3f at = direction();
    const float across = std::sqrt(at.x * at.x + at.y * at.y);
    return axis * c + (frame.u * at.x + frame.v * at.y) * (s / across);
  }
  // A point, a small or a large box; one normal, some or all; Lambert's law, narrow or wide beams.
  LightBounds light() {
    LightBounds out;
    const Vec3f at = in_cube(), half = abs(in_cube()) * pick({0, 0.01f, 0.3f});
    out.box = {at - half, at + half};
    out.axis = pick({0, 1}) > 0 ? direction() : Vec3f(0, 0, 1);
    out.cos_normals = pick({1, 0.7f, -0.5f, -1});
    out.cos_emission = pick({0, 0, 0.9f, 0.999f, -0.6f, -1});
    out.two_sided = pick({0, 0, 1}) > 0;
    out.power = between(0.1f, 2);
    return out;
  }
  std::vector<LightBounds> lights(size_t count) {
    std::vector<LightBounds> out;
    while (out.size() < count) out.push_back(light());
    return out;
  }
  // A normal, or none.
  Vec3f surface() { return pick({0, 1}) > 0 ? direction() : Vec3f(); }

 private:
  float pick(std::initializer_list<float> from) { return from.begin()[rng_() % from.size()]; }

  std::mt19937 rng_;
};

LightBounds bulb(Vec3f at, float power = 1) { return {.box = {at, at}, .power = power}; }

double total_probability(const LightTree& tree, size_t count, Vec3f point, Vec3f normal) {
  double all = 0;
  for (uint32_t i = 0; i < count; ++i) all += double(tree.probability(point, normal, i));
  return all;
}

TEST(LightTree, BulbsShareAllOfTheProbability) {
  LightMaker make(1);
  for (const size_t count : {1, 2, 3, 10, 100, 1000}) {
    std::vector<LightBounds> lights;
    for (size_t i = 0; i < count; ++i) lights.push_back(bulb(make.in_cube(), make.between(0, 1)));
    const LightTree tree(lights);
    for (const float size : {0.5f, 1.0f, 20.0f})
      EXPECT_NEAR(total_probability(tree, count, make.in_cube() * size, {}), 1, 1e-5) << count;
  }
}

// The numbers that choose a light are an interval, so that their count tells its length to 1.
TEST(LightTree, ChoosesWithItsProbabilities) {
  constexpr uint32_t kSteps = 1 << 14;
  LightMaker make(2);
  for (const size_t count : {1, 2, 3, 7, 50, 1000}) {
    const LightTree tree(make.lights(count));
    for (int round = 0; round < if_sanitized(2, 10); ++round) {
      const Vec3f point = make.in_cube() * 1.5f, normal = make.surface();
      std::vector<uint32_t> chosen(count);
      uint32_t none = 0;
      for (uint32_t i = 0; i < kSteps; ++i) {
        const LightChoice choice = tree.choose(point, normal, (float(i) + 0.5f) / float(kSteps));
        if (choice.probability == 0) {
          ++none;
          continue;
        }
        ++chosen[choice.light];
        ASSERT_EQ(choice.probability, tree.probability(point, normal, choice.light));
      }
      for (uint32_t i = 0; i < count; ++i)
        ASSERT_NEAR(chosen[i], tree.probability(point, normal, i) * float(kSteps), 1.01f);
      EXPECT_NEAR(total_probability(tree, count, point, normal), 1 - double(none) / kSteps,
                  double(count) / kSteps);
    }
  }
}

// Whether light that leaves `from` along `dir`, as one of its normals lets it, reaches a surface.
bool reaches(const LightBounds& light, Vec3d surface_normal, Vec3d normal, Vec3d dir) {
  const double cosine = dot(normal, dir);
  return (light.two_sided ? std::abs(cosine) : cosine) > double(light.cos_emission) &&
         (surface_normal == Vec3d() || dot(surface_normal, dir) < 0);
}

TEST(LightTree, ForgetsNoLightThatReachesThePoint) {
  LightMaker make(3);
  size_t reached = 0;
  for (const size_t count : {1, 2, 5, 30, 300}) {
    for (int scene = 0; scene < if_sanitized(2, 20); ++scene) {
      const auto lights = make.lights(count);
      const LightTree tree(lights);
      for (int round = 0; round < 2000; ++round) {
        const auto i = uint32_t(round) % uint32_t(count);
        const LightBounds& light = lights[i];
        const Vec3f t = (make.in_cube() + Vec3f(1)) * 0.5f, size = light.box.size();
        const Vec3f from =
            min(light.box.lo + Vec3f(t.x * size.x, t.y * size.y, t.z * size.z), light.box.hi);
        // Also close to the light, and in its beam's border.
        const float distance = make.between(0, 1) < 0.5f ? 1e-3f : 1.0f;
        const Vec3f normal = make.near(light.axis, light.cos_normals);
        const Vec3f point =
            from + make.near(normal, std::max(light.cos_emission, -0.9f)) * distance;
        const Vec3f surface_normal = make.surface();
        const Vec3d dir = normalize(Vec3d(point) - Vec3d(from));
        if (!reaches(light, Vec3d(surface_normal), Vec3d(normal), dir)) continue;
        ++reached;
        ASSERT_GT(tree.probability(point, surface_normal, i), 0) << count << ' ' << i;
      }
    }
  }
  EXPECT_GT(reached, 1000u);
}

// A row of flat lamps in a ceiling: nothing above it is lit, and below, points lie just under it.
TEST(LightTree, ACeilingLightsWhatIsBelow) {
  std::vector<LightBounds> lamps;
  for (int i = 0; i < 100; ++i) {
    LightBounds lamp = bulb({float(i), 0, 3});
    lamp.box.hi += Vec3f(0.5f, 0.5f, 0);
    lamp.axis = {0, 0, -1}, lamp.cos_normals = 1;
    lamps.push_back(lamp);
  }
  const LightTree tree(lamps);
  for (uint32_t i = 0; i < 100; ++i)
    EXPECT_GT(tree.probability({40, 20, std::nextafter(3.0f, 0.0f)}, {0, 0, 1}, i), 0);
  EXPECT_EQ(tree.choose({40, 20, 60}, {0, 0, -1}, 0.5f).probability, 0);
  EXPECT_EQ(tree.choose({40, 20, 0}, {0, 0, -1}, 0.5f).probability, 0);
  EXPECT_GT(tree.choose({40, 20, 0}, {}, 0.5f).probability, 0);
  const auto under_40 = [&](uint32_t i) { return tree.probability({40, 0, 2}, {0, 0, 1}, i); };
  EXPECT_GT(under_40(40), 10 * under_40(60));
}

TEST(LightTree, FarAwayOnlyPowerCounts) {
  LightMaker make(4);
  std::vector<LightBounds> lights;
  double power = 0;
  for (int i = 0; i < 200; ++i) {
    lights.push_back(bulb(make.in_cube(), make.between(0.01f, 5)));
    power += double(lights.back().power);
  }
  const LightTree tree(lights);
  for (const float distance : {1e4f, 1e9f, 1e17f})
    for (uint32_t i = 0; i < 200; ++i) {
      const double part = double(lights[i].power) / power;
      EXPECT_NEAR(double(tree.probability({distance, -distance, 0}, {}, i)), part, 2e-3 * part);
    }
}

// A street with lamps on both sides: the variance is at most a hundredth of that of a choice by
// power.
TEST(LightTree, HasLittleVariance) {
  LightMaker make(5);
  std::vector<LightBounds> lamps;
  for (int i = 0; i < 1000; ++i) {
    LightBounds lamp = bulb({float(i / 2) * 10, i % 2 ? 6.0f : -6.0f, 5}, make.between(0.5f, 2));
    lamp.axis = {0, 0, -1}, lamp.cos_normals = 1;
    lamps.push_back(lamp);
  }
  const LightTree tree(lamps);
  double by_tree = 0, by_power = 0, power = 0;
  for (const LightBounds& lamp : lamps) power += double(lamp.power);
  for (int round = 0; round < 50; ++round) {
    const Vec3f point(make.between(0, 5000), make.between(-8, 8), 0), normal(0, 0, 1);
    double sum = 0, square_by_tree = 0, square_by_power = 0;
    for (uint32_t i = 0; i < lamps.size(); ++i) {
      const Vec3d to(lamps[i].box.lo - point);
      const double d2 = dot(to, to), light = double(lamps[i].power) * to.z * to.z / (d2 * d2);
      sum += light;
      square_by_tree += light * light / double(tree.probability(point, normal, i));
      square_by_power += light * light / double(lamps[i].power) * power;
    }
    by_tree += square_by_tree / (sum * sum) - 1, by_power += square_by_power / (sum * sum) - 1;
  }
  EXPECT_LT(by_tree, 0.01 * by_power);
}

TEST(LightTree, LightsWithoutPowerAreNeverChosen) {
  EXPECT_EQ(LightTree({}).choose({}, {}, 0.5f).probability, 0);
  std::vector<LightBounds> lights = {bulb({1, 0, 0}, 0), bulb({2, 0, 0}, 0)};
  EXPECT_EQ(LightTree(lights).choose({}, {}, 0.5f).probability, 0);
  EXPECT_EQ(LightTree(lights).probability({}, {}, 1), 0);
  lights.push_back(bulb({3, 0, 0}));
  const LightTree tree(lights);
  EXPECT_EQ(tree.choose({}, {}, 0).light, 2u);
  EXPECT_EQ(tree.choose({}, {}, 0).probability, 1);
  EXPECT_EQ(tree.probability({}, {}, 0), 0);
}

TEST(LightTree, EqualPositions) {
  for (const size_t count : {2, 3, 1000}) {
    std::vector<LightBounds> lights(count, bulb({7, 8, 9}));
    const LightTree tree(lights);
    for (const Vec3f point : {Vec3f(7, 8, 9), Vec3f(7, 8, 10), Vec3f(-1e6f, 0, 0)})
      for (uint32_t i = 0; i < count; ++i) {
        const auto part = 1 / double(count);
        EXPECT_NEAR(double(tree.probability(point, {}, i)), part, 0.5 * part);
      }
    EXPECT_NEAR(total_probability(tree, count, {7, 8, 9}, {0, 1, 0}), 1, 1e-5);
  }
}

// Positions and powers of all magnitudes give deep trees.
TEST(LightTree, AllMagnitudes) {
  std::vector<LightBounds> lights;
  for (float size = 1e-18f; size < 1e18f; size *= 1.25f)
    for (const float power : {1e-30f, 1.0f, 1e30f, std::numeric_limits<float>::max()})
      lights.push_back(bulb({size, -size / 2, 0}, power));
  for (float power = 1e-37f; power < 1e37f; power *= 1.1f) lights.push_back(bulb({1, 1, 1}, power));
  const LightTree tree(lights);
  for (float at = 1e-20f; at < 2e18f; at *= 7)
    for (const Vec3f normal : {Vec3f(), Vec3f(1, 0, 0)}) {
      const Vec3f point(at, 0, at);
      EXPECT_LE(total_probability(tree, lights.size(), point, normal), 1 + 1e-5);
      for (const float u : {0.0f, 0.3f, 1 - 0x1p-24f}) {
        const LightChoice choice = tree.choose(point, normal, u);
        EXPECT_EQ(choice.probability, tree.probability(point, normal, choice.light));
      }
    }
}

TEST(LightTree, ThreadsDoNotChangeIt) {
  LightMaker make(6);
  const auto lights = make.lights(20000);
  const auto tree_with = [&](int threads) {
    return Executor(threads).run([&] { return LightTree(lights); });
  };
  const LightTree one = tree_with(1), many = tree_with(7);
  for (int round = 0; round < 1000; ++round) {
    const Vec3f point = make.in_cube(), normal = make.surface();
    const float u = make.between(0, 1) * 0.999f;
    const LightChoice a = one.choose(point, normal, u), b = many.choose(point, normal, u);
    ASSERT_EQ(a.light, b.light);
    ASSERT_EQ(a.probability, b.probability);
  }
}

TEST(LightTree, AMillionLights) {
  LightMaker make(7);
  const size_t count = if_sanitized(50'000, 1'000'000);
  const LightTree tree(make.lights(count));
  size_t found = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3f point = make.in_cube();
    const LightChoice choice = tree.choose(point, {}, float(i) / 1000);
    ASSERT_EQ(choice.probability,
              choice.probability > 0 ? tree.probability(point, {}, choice.light) : 0);
    found += choice.probability > 0;
  }
  EXPECT_GT(found, 900u);
}

}  // namespace
}  // namespace raio::core
