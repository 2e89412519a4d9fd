// Directions sampled by an environment's distribution, with every instruction set of this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "../tests/environment_distribution_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "base/executor.h"
#include "integrate/environment_sampler-inl.h"
#include "sanitized.h"

#ifndef RAIO_TESTS_ENVIRONMENT_DISTRIBUTION_
#define RAIO_TESTS_ENVIRONMENT_DISTRIBUTION_
namespace raio::core {

// A direction, the density with which sample() returned it, the one found there, and the light.
struct SampledDirection {
  Vec3f dir{};
  float density = 0, found = 0;
  Rgb radiance{};

  friend bool operator==(const SampledDirection&, const SampledDirection&) = default;
};

}  // namespace raio::core
#endif

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

void look_up(const Scene& scene, const EnvironmentDistribution& of,
             std::vector<SampledDirection>& at) {
  const EnvironmentSampler sampler(scene.environment[0], of);
  const EnvironmentLight light(scene);
  HWY_ALIGN float x[kWidth] = {}, y[kWidth] = {}, z[kWidth] = {}, found[kWidth];
  for (size_t i = 0; i < at.size(); i += hn::Lanes(d)) {
    const size_t count = std::min(hn::Lanes(d), at.size() - i);
    for (size_t k = 0; k < count; ++k)
      x[k] = at[i + k].dir.x, y[k] = at[i + k].dir.y, z[k] = at[i + k].dir.z;
    const V3 dir = {hn::Load(d, x), hn::Load(d, y), hn::Load(d, z)}, seen = light.radiance(dir);
    hn::Store(sampler.density(dir), d, found);
    hn::Store(seen.x, d, x), hn::Store(seen.y, d, y), hn::Store(seen.z, d, z);
    for (size_t k = 0; k < count; ++k)
      at[i + k].found = found[k], at[i + k].radiance = {x[k], y[k], z[k]};
  }
}

// Of the points of the square, with the same number in each of its lanes.
void sample(const Scene& scene, const EnvironmentDistribution& of,
            const std::vector<std::array<float, 2>>& square, std::vector<SampledDirection>& out) {
  const EnvironmentSampler sampler(scene.environment[0], of);
  out.clear();
  for (const auto [x, y] : square) {
    const auto one = sampler.sample({hn::Set(d, x), hn::Set(d, y)});
    out.push_back({.dir = {hn::GetLane(one.dir.x), hn::GetLane(one.dir.y), hn::GetLane(one.dir.z)},
                   .density = hn::GetLane(one.density)});
  }
  look_up(scene, of, out);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {
namespace {

using tests::if_sanitized;

HWY_EXPORT(look_up);
HWY_EXPORT(sample);

constexpr double kSphere = 4 * std::numbers::pi;

template <class F>
Scene picture(uint32_t width, uint32_t height, const F& texel) {
  Scene scene;
  scene.environment = {{.width = width, .height = height, .up = {1, 2, 2}, .direction = {0, 3, 1}}};
  for (uint32_t row = 0; row < height; ++row)
    for (uint32_t column = 0; column < width; ++column)
      scene.environment_texels.push_back(texel(column, row));
  return scene;
}

EnvironmentDistribution distribution(const Scene& scene) {
  const Array<Rgb>& texels = scene.environment_texels;
  return {scene.environment[0], {texels.data(), texels.size()}};
}

// Random texels, some of them black, and a brighter one.
Scene sky(uint32_t width, uint32_t height) {
  std::mt19937 rng(width);
  return picture(width, height, [&](uint32_t column, uint32_t row) {
    if (column == width / 3 && row == height / 4) return Rgb(5, 4, 3);
    const auto part = float(rng() % 4) / 4;
    return Rgb(part, part * part, 2 * part);
  });
}

std::vector<SampledDirection> samples(const Scene& scene, const EnvironmentDistribution& of,
                                      uint32_t side) {
  std::vector<std::array<float, 2>> square;
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x)
      square.push_back({(float(x) + 0.5f) / float(side), (float(y) + 0.5f) / float(side)});
  std::vector<SampledDirection> out;
  HWY_DYNAMIC_DISPATCH(sample)(scene, of, square, out);
  return out;
}

// Directions that share the sphere equally, on a spiral.
std::vector<SampledDirection> everywhere(const Scene& scene, const EnvironmentDistribution& of,
                                         size_t count) {
  std::vector<SampledDirection> out(count);
  for (size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * double(i) + 1) / double(count), r = std::sqrt(1 - z * z);
    const double angle = double(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    out[i].dir = Vec3f(Vec3d(r * std::cos(angle), r * std::sin(angle), z));
  }
  HWY_DYNAMIC_DISPATCH(look_up)(scene, of, out);
  return out;
}

const std::vector<std::array<uint32_t, 2>> kSizes = {{1, 1}, {2, 1},  {1, 2},
                                                     {3, 2}, {16, 8}, {37, 19}};

TEST(EnvironmentDistribution, TheDensityAddsUpToOne) {
  for (const auto [width, height] : kSizes) {
    const Scene scene = sky(width, height);
    const auto of = distribution(scene);
    double sum = 0;
    const size_t count = if_sanitized(100'000, 1'000'000);
    for (const auto& one : everywhere(scene, of, count)) sum += double(one.found);
    EXPECT_NEAR(sum * kSphere / double(count), 1, if_sanitized(3e-3, 1e-4)) << width;
  }
}

// Also the light over the density has the mean that the light has on the sphere.
TEST(EnvironmentDistribution, SamplesFollowTheirDensity) {
  for (const auto [width, height] : kSizes) {
    const Scene scene = sky(width, height);
    const auto of = distribution(scene);
    const auto side = if_sanitized(100u, 400u);
    const auto found = samples(scene, of, side);
    size_t elsewhere = 0;
    double light = 0;
    for (const auto& one : found) {
      ASSERT_GT(one.density, 0);
      ASSERT_NEAR(length(one.dir), 1, 1e-6);
      elsewhere += std::abs(one.found - one.density) > 1e-6f * one.density;
      light += double(one.radiance.y) / double(one.density);
    }
    EXPECT_LE(elsewhere, found.size() / 5000) << width;  // next to a cell's border
    double truth = 0;
    const auto all = everywhere(scene, of, if_sanitized(100'000, 500'000));
    for (const auto& one : all) truth += double(one.radiance.y);
    truth *= kSphere / double(all.size());
    EXPECT_NEAR(light / double(found.size()), truth, if_sanitized(2e-2, 2e-3) * truth) << width;
  }
}

// Chi-square over boxes of equal solid angle that have nothing to do with the picture's cells.
TEST(EnvironmentDistribution, ChiSquare) {
  constexpr int kAround = 12, kHigh = 9;
  const auto box = [](Vec3f dir) {
    const double turns = std::atan2(double(dir.y), double(dir.x)) / (2 * std::numbers::pi) + 0.5;
    return std::min(int(turns * kAround), kAround - 1) +
           kAround * std::min(int((double(dir.z) + 1) / 2 * kHigh), kHigh - 1);
  };
  const Scene scene = sky(16, 8);
  const auto of = distribution(scene);
  std::vector<double> expected(kAround * kHigh), counts(kAround * kHigh);
  const auto all = everywhere(scene, of, if_sanitized(200'000, 1'000'000));
  constexpr size_t kSamples = 50'000;
  for (const auto& one : all)
    expected[box(one.dir)] += double(one.found) * kSphere / double(all.size()) * kSamples;
  std::mt19937 rng(3);
  std::vector<std::array<float, 2>> square(kSamples);
  for (auto& [x, y] : square) x = float(rng() >> 8) * 0x1p-24f, y = float(rng() >> 8) * 0x1p-24f;
  std::vector<SampledDirection> found;
  HWY_DYNAMIC_DISPATCH(sample)(scene, of, square, found);
  for (const auto& one : found) ++counts[box(one.dir)];
  double chi2 = 0;
  for (size_t i = 0; i < counts.size(); ++i) {
    ASSERT_GT(expected[i], 5);
    chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  }
  EXPECT_LT(chi2, 166);  // 107 degrees of freedom: once in 5,000 seeds
}

TEST(EnvironmentDistribution, OneBrightTexel) {
  const Scene scene = picture(64, 32, [](uint32_t column, uint32_t row) {
    return Rgb(column == 63 && row == 5 ? 1e-30f : 0);
  });
  const auto of = distribution(scene);
  for (const auto& one : samples(scene, of, 100)) EXPECT_GT(one.radiance.x, 0);
  size_t bright = 0;
  for (const auto& one : everywhere(scene, of, 200'000)) {
    if (one.radiance.x > 0) {
      EXPECT_GT(one.found, 0);
    }
    bright += one.radiance.x > 0;
  }
  EXPECT_GT(bright, 100u);
}

// Nor does a texel vanish beside one that is 10^60 times as bright.
TEST(EnvironmentDistribution, AnyLightHasADensity) {
  std::mt19937 rng(4);
  constexpr std::array<float, 4> kValues = {0, 1e-30f, 1, 1e30f};
  const Scene scene = picture(20, 11, [&](auto...) { return Rgb(0, 0, kValues[rng() % 4]); });
  for (const auto& one : everywhere(scene, distribution(scene), 100'000))
    ASSERT_EQ(one.found > 0, one.radiance.z > 0);
}

TEST(EnvironmentDistribution, BlackHasNone) {
  const Scene scene = picture(5, 3, [](auto...) { return Rgb(0); });
  const auto of = distribution(scene);
  EXPECT_TRUE(of.is_black());
  for (const auto& one : samples(scene, of, 10)) EXPECT_EQ(one.density, 0);
  for (const auto& one : everywhere(scene, of, 1000)) EXPECT_EQ(one.found, 0);
}

TEST(EnvironmentDistribution, ConstantIsUniform) {
  for (const auto [width, height] : kSizes) {
    const Scene scene = picture(width, height, [](auto...) { return Rgb(0.3f); });
    const auto of = distribution(scene);
    for (const auto& one : samples(scene, of, 50)) {
      ASSERT_NEAR(one.density * float(kSphere), 1, 1e-5f);
      ASSERT_NEAR(one.found * float(kSphere), 1, 1e-5f);
    }
  }
}

// Cells of large pictures are small, above all at the poles.
TEST(EnvironmentDistribution, LargePicturesWithLightAtThePoles) {
  const Scene scene = picture(4096, 2048, [](uint32_t column, uint32_t row) {
    return Rgb((row == 0 || row == 2047) && column < 9 ? 1 : row == 1024 ? 1e-4f : 0);
  });
  const auto of = distribution(scene);
  double light = 0;
  const auto found = samples(scene, of, 200);
  for (const auto& one : found) light += double(one.radiance.x) / double(one.density);
  // At the poles half a row and a triangle below, in which the radiance falls linearly to zero.
  constexpr double kRow = std::numbers::pi / 2048;
  const double poles = 2 * 9 * (kRow * kRow / 8 + kRow * kRow * (1.0 / 4 + 1.0 / 6)) * kRow;
  const double equator = 1e-4 * 2 * std::numbers::pi * kRow;
  EXPECT_NEAR(light / double(found.size()), poles + equator, 0.02 * (poles + equator));
}

TEST(EnvironmentDistribution, AllMachinesAndThreadsAgree) {
  const Scene scene = sky(301, 150);
  const auto one = Executor(1).run([&] { return distribution(scene); });
  const auto many = Executor(7).run([&] { return distribution(scene); });
  const auto expected = samples(scene, one, 50);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    EXPECT_EQ(samples(scene, many, 50), expected) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace raio::core
#endif
