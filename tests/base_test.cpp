#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "base/box.h"
#include "base/lazy_library.h"
#include "base/random.h"
#include "base/vec.h"
#include "base/wide-inl.h"

namespace raio::core {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace wide = raio::core::HWY_NAMESPACE;
const hn::ScalableTag<float> d;
const hn::ScalableTag<uint32_t> du;

float to_unit(uint32_t bits) { return hn::GetLane(wide::to_unit(d, hn::Set(du, bits))); }

struct Uint4 {
  uint32_t x, y, z, w;
};
Uint4 hash4(Uint4 key) {
  const auto h = wide::hash4(
      du, {hn::Set(du, key.x), hn::Set(du, key.y), hn::Set(du, key.z), hn::Set(du, key.w)});
  return {hn::GetLane(h.x), hn::GetLane(h.y), hn::GetLane(h.z), hn::GetLane(h.w)};
}

/// Pearson's statistic of equally likely cells, in standard deviations above its mean.
double chi_square_sigmas(const std::vector<int>& cells) {
  double total = 0;
  for (const int c : cells) total += c;
  const double expected = total / double(cells.size());
  double sum = 0;
  for (const int c : cells) sum += (c - expected) * (c - expected) / expected;
  const double freedom = double(cells.size()) - 1;
  return (sum - freedom) / std::sqrt(2 * freedom);
}

TEST(Vec, FrameIsOrthonormalAndRightHanded) {
  std::mt19937 rng(1);
  std::normal_distribution<float> gauss;
  std::vector<Vec3f> normals;
  for (int k = 0; k < 10000; ++k) normals.push_back({gauss(rng), gauss(rng), gauss(rng)});
  for (const float tiny : {0.f, -0.f, 1e-4f, 1e-7f, 1e-20f}) {
    for (const float sign : {1.f, -1.f}) {
      normals.push_back({tiny, 0, sign}), normals.push_back({0, tiny, sign});
      normals.push_back({sign, 0, tiny}), normals.push_back({0, sign, tiny});
    }
  }
  for (const Vec3f& v : normals) {
    const Vec3f n = normalize(v);
    const Frame<float> f(n);
    constexpr float kBound = 4e-7f;
    EXPECT_NEAR(length(f.u), 1, kBound);
    EXPECT_NEAR(length(f.v), 1, kBound);
    EXPECT_NEAR(dot(f.u, f.v), 0, kBound);
    EXPECT_NEAR(dot(f.u, n), 0, kBound);
    EXPECT_NEAR(dot(f.v, n), 0, kBound);
    EXPECT_NEAR(dot(cross(f.u, f.v), n), 1, 2 * kBound);
  }
}

// Written so that a compiler may use vector instructions; with -ftree-slp-vectorize g++ 12 takes
// the rounding away, which breaks every comparison of a double with its float.
[[gnu::noinline]] void through_float(const double* in, double* out) {
  const float x = float(in[0]), y = float(in[1]);
  out[0] = double(x), out[1] = double(y);
}

TEST(Vec, RoundingToFloatIsKept) {
  volatile float x = 0.1f, y = 0.7f;
  volatile double a = 0.1, b = 0.7;  // known only when the program runs
  const double in[] = {a, b};
  double out[2];
  through_float(in, out);
  EXPECT_EQ(out[0], double(x));
  EXPECT_EQ(out[1], double(y));
}

TEST(Vec, LargestAxis) {
  EXPECT_EQ(max_axis(Vec3f(3, 2, 1)), 0);
  EXPECT_EQ(max_axis(Vec3f(1, 3, 2)), 1);
  EXPECT_EQ(max_axis(Vec3f(1, 2, 3)), 2);
  EXPECT_EQ(max_axis(Vec3f(2, 1, 3)), 2);
}

TEST(Box, EmptyAndArea) {
  Box3f box;
  EXPECT_TRUE(box.empty());
  EXPECT_EQ(box.half_area(), 0);
  box.extend({1, 2, 3});
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.half_area(), 0);
  box.extend({2, 4, 6});
  EXPECT_EQ(box.half_area(), 1 * 2 + 2 * 3 + 3 * 1);
  EXPECT_EQ(box.center(), Vec3f(1.5f, 3, 4.5f));
}

TEST(Box, RoundsOutwardsAndNoFurther) {
  std::mt19937 rng(2);
  std::normal_distribution<double> gauss;
  for (int k = 0; k < 1000; ++k) {
    const Vec3d lo(gauss(rng), gauss(rng) * 1e6, gauss(rng) * 1e-6);
    const Box3f box = rounded_out({lo, lo + Vec3d(0.1)});
    for (int a = 0; a < 3; ++a) {
      EXPECT_LE(double(box.lo[a]), lo[a]);
      EXPECT_GE(double(box.hi[a]), lo[a] + 0.1);
      EXPECT_GT(double(std::nextafter(box.lo[a], INFINITY)), lo[a]);
    }
  }
  const Box3f exact = rounded_out({Vec3d(0.25), Vec3d(3)});
  EXPECT_EQ(exact.lo, Vec3f(0.25f));
  EXPECT_EQ(exact.hi, Vec3f(3));
}

TEST(Random, UnitNumbersAreBelowOne) {
  EXPECT_EQ(to_unit(0), 0);
  EXPECT_LT(to_unit(0xffffffffu), 1);
  EXPECT_EQ(to_unit(0x80000000u), 0.5f);
}

TEST(Random, WordsAreUniformAndIndependent) {
  // Keys as in a renderer: small consecutive numbers.
  constexpr int kBins = 16;
  std::array<std::vector<int>, 4> single;
  std::array<std::vector<int>, 6> pair;
  std::vector<int> neighbours(kBins * kBins);
  for (auto& s : single) s.assign(256, 0);
  for (auto& p : pair) p.assign(kBins * kBins, 0);
  uint32_t before = 0;
  for (uint32_t seed = 0; seed < 2; ++seed) {
    for (uint32_t pixel = 0; pixel < 5000; ++pixel) {
      for (uint32_t sample = 0; sample < 16; ++sample) {
        const Uint4 h = hash4({seed, pixel, sample, 3});
        const std::array<uint32_t, 4> w{h.x, h.y, h.z, h.w};
        for (int i = 0, k = 0; i < 4; ++i) {
          ++single[i][w[i] >> 24];
          for (int j = i + 1; j < 4; ++j, ++k) ++pair[k][(w[i] >> 28) * kBins + (w[j] >> 28)];
        }
        ++neighbours[(before >> 28) * kBins + (h.x >> 28)];
        before = h.x;
      }
    }
  }
  for (const auto& s : single) EXPECT_LT(std::abs(chi_square_sigmas(s)), 5);
  for (const auto& p : pair) EXPECT_LT(std::abs(chi_square_sigmas(p)), 5);
  EXPECT_LT(std::abs(chi_square_sigmas(neighbours)), 5);
}

TEST(Random, PermutationsAreBijections) {
  std::mt19937 rng(3);
  for (uint32_t n = 1; n <= 200; ++n) {
    for (int k = 0; k < 20; ++k) {
      const uint32_t key = uint32_t(rng());
      std::vector<bool> seen(n);
      for (uint32_t i = 0; i < n; ++i) {
        const uint32_t p = permute(i, n, key);
        ASSERT_LT(p, n);
        ASSERT_FALSE(seen[p]) << "n " << n << " key " << key;
        seen[p] = true;
      }
    }
  }
  EXPECT_LT(permute(5, 0x80000001u, 7), 0x80000001u);  // the widest words
}

TEST(Random, EveryElementGoesEverywhere) {
  for (const uint32_t n : {2u, 3u, 4u, 5u, 8u, 9u, 16u, 25u, 64u}) {
    for (const uint32_t i : {0u, 1u, n / 2, n - 1}) {
      std::vector<int> hashed(n), counted(n), next(n);
      for (uint32_t k = 0; k < 1000 * n; ++k) {
        const uint32_t key = hash4({k, n, i, 0}).x;
        ++hashed[permute(i, n, key)];
        ++counted[permute(i, n, k)];  // neighbouring keys
        ++next[(permute((i + 1) % n, n, key) + n - permute(i, n, key)) % n];
      }
      EXPECT_LT(chi_square_sigmas(hashed), 6) << "n " << n << " element " << i;
      EXPECT_LT(chi_square_sigmas(counted), 6) << "n " << n << " element " << i;
      // Two elements never go to the same place, and all distances are equally likely.
      EXPECT_EQ(next[0], 0);
      if (n > 2) {
        EXPECT_LT(chi_square_sigmas({next.begin() + 1, next.end()}), 6) << "n " << n;
      }
    }
  }
}

// As in zlib.h.
extern "C" unsigned long crc32(unsigned long crc, const unsigned char* bytes, unsigned size);
extern "C" void no_such_function();
constexpr char kZlib[] = "libz.so.1", kNone[] = "libnone.so.0";

#ifndef RAIO_NO_POSIX  // without POSIX, none is loaded
TEST(LazyLibrary, CallsByTheNameOfTheFunction) {
  EXPECT_EQ(function_name<crc32>(), "crc32");
  ASSERT_TRUE(load_library(kZlib).has_value());
  const auto* digits = reinterpret_cast<const unsigned char*>("123456789");
  EXPECT_EQ((call<kZlib, crc32>(0, digits, 9)), 0xcbf43926u);  // the standard's check value
  EXPECT_THROW((call<kZlib, no_such_function>()), std::runtime_error);
}
#endif

TEST(LazyLibrary, NamesTheMissingFunction) {
  const auto loaded = load_library(kNone);
  ASSERT_FALSE(loaded.has_value());
  EXPECT_NE(loaded.error().find(kNone), std::string::npos);
  EXPECT_THROW((call<kNone, crc32>(0, nullptr, 0)), std::runtime_error);
}

}  // namespace
}  // namespace raio::core
