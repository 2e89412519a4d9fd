// The samplers against the distributions that they promise, and the arithmetic under them.
#include "render/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/sampler-inl.h"

namespace raio {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace wide = raio::HWY_NAMESPACE;
const hn::ScalableTag<float> d;
const hn::ScalableTag<uint32_t> du;
using D = decltype(hn::ScalableTag<float>());

struct Point2 {
  float x, y;
};
Point2 first(const wide::Wide2<D>& p) { return {hn::GetLane(p.x), hn::GetLane(p.y)}; }

Sampler jitter(uint32_t seed, int aa, int per_cell) {
  RenderOptions o;
  o.seed = seed, o.aa = aa, o.lens_samples = per_cell, o.sampler = SamplerKind::jitter;
  return Sampler(o);
}

Point2 in_pixel(const Sampler& sampler, uint32_t pixel, uint32_t sample) {
  return first(wide::WideSampler<D>(sampler, sample).in_pixel(hn::Set(du, pixel)));
}
Point2 in_square(const Sampler& sampler, uint32_t pixel, uint32_t sample, uint32_t branch,
                 uint32_t purpose) {
  return first(
      wide::WideSampler<D>(sampler, sample)
          .in_square(hn::Set(du, pixel), hn::Set(du, pixel), hn::Set(du, branch), purpose));
}
Point2 square_to_disc(float u, float v) {
  return first(wide::square_to_disc(d, hn::Set(d, u), hn::Set(d, v)));
}
float pow_unit(float x, float y) {
  return hn::GetLane(wide::pow_unit(d, hn::Set(d, x), hn::Set(d, y)));
}

// Pearson's chi-square of counts that should be equal, as a number of standard deviations from its
// mean.
double chi_square_sigmas(const std::vector<int>& counts) {
  double total = 0;
  for (const int c : counts) total += c;
  const double expected = total / double(counts.size());
  double chi2 = 0;
  for (const int c : counts) chi2 += (c - expected) * (c - expected) / expected;
  const double freedom = double(counts.size()) - 1;
  return (chi2 - freedom) / std::sqrt(2 * freedom);
}

constexpr int kBins = 16;
int bin(float u) { return std::min(kBins - 1, int(u * kBins)); }

// One sample of each pixel: with all samples of a pixel the strata make counts more equal than
// chance.
TEST(Sampler, SquaresAreUniformForEveryPurposeAndBranch) {
  for (const uint32_t seed : {0u, 77u})
    for (const auto& [aa, per_cell] : {std::pair(1, 1), {3, 1}, {3, 3}, {1, 7}})
      for (const uint32_t branch : {1u, 2u, 21u})
        for (const uint32_t purpose : {uint32_t(kLens), uint32_t(kLight), kLight + 5u}) {
          const Sampler sampler = jitter(seed, aa, per_cell);
          std::vector<int> counts(kBins * kBins);
          for (uint32_t pixel = 0; pixel < 50000; ++pixel) {
            const Point2 p = in_square(sampler, pixel, pixel % sampler.samples, branch, purpose);
            ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            ++counts[size_t(bin(p.y) * kBins + bin(p.x))];
          }
          EXPECT_LT(std::abs(chi_square_sigmas(counts)), 5)
              << seed << " " << aa << " " << per_cell << " " << branch << " " << purpose;
        }
}

TEST(Sampler, PixelCellsGetTheirSamplesAndFillThemEvenly) {
  const Sampler sampler = jitter(3, 4, 2);
  std::vector<int> counts(kBins * kBins);
  for (uint32_t pixel = 0; pixel < 5000; ++pixel) {
    std::vector<int> cells(16);
    for (uint32_t s = 0; s < sampler.samples; ++s) {
      const Point2 p = in_pixel(sampler, pixel, s);
      ++cells[size_t(int(p.y * 4) * 4 + int(p.x * 4))];
      ++counts[size_t(bin(p.y) * kBins + bin(p.x))];
    }
    for (const int c : cells) EXPECT_EQ(c, 2);
  }
  // 5000 x 2 samples fall in each cell, 16 bins a cell: the cells' totals are exact, the rest is
  // chance.
  EXPECT_LT(std::abs(chi_square_sigmas(counts)), 5);
}

TEST(Sampler, OneCellMeansThePixelsCentre) {
  const Point2 p = in_pixel(jitter(9, 1, 4), 123, 2);
  EXPECT_EQ(p.x, 0.5f);
  EXPECT_EQ(p.y, 0.5f);
}

TEST(Sampler, EverySampleOfAPixelHasACellOfTheSquareOfItsOwn) {
  for (const auto& [aa, per_cell] : {std::pair(3, 1), {3, 3}, {2, 2}, {1, 5}}) {
    const Sampler sampler = jitter(1, aa, per_cell);
    const uint32_t n = sampler.samples;
    uint32_t columns = uint32_t(std::sqrt(double(n)));
    while (n % columns) --columns;
    for (uint32_t pixel = 0; pixel < 200; ++pixel) {
      std::vector<int> cells(n);
      for (uint32_t s = 0; s < n; ++s) {
        const Point2 p = in_square(sampler, pixel, s, 1, kLight);
        ++cells[uint32_t(p.y * float(n / columns)) * columns + uint32_t(p.x * float(columns))];
      }
      for (const int c : cells) EXPECT_EQ(c, 1);
    }
  }
}

Sampler sobol(uint32_t seed, int samples) {
  RenderOptions o;
  o.seed = seed, o.samples = samples, o.sampler = SamplerKind::sobol;
  return Sampler(o);
}

// The first 2^k points of a (0,2)-sequence: one in each of the 2^k boxes of every shape, however it
// is scrambled.
TEST(Sampler, SobolFillsEveryElementaryBoxOnce) {
  const Sampler sampler = sobol(2, 64);
  for (uint32_t pixel = 0; pixel < 50; ++pixel)
    for (const int log_n : {1, 3, 6})
      for (int log_columns = 0; log_columns <= log_n; ++log_columns) {
        const uint32_t n = 1u << log_n, columns = 1u << log_columns, rows = n / columns;
        std::vector<int> in_lens(n), in_pixels(n);
        for (uint32_t s = 0; s < n; ++s) {
          const auto box = [&](Point2 p) {
            return uint32_t(p.y * float(rows)) * columns + uint32_t(p.x * float(columns));
          };
          ++in_lens[box(in_square(sampler, pixel, s, 1, kLens))];
          ++in_pixels[box(in_pixel(sampler, pixel, s))];
        }
        for (const int c : in_lens) ASSERT_EQ(c, 1) << n << " " << columns;
        for (const int c : in_pixels) ASSERT_EQ(c, 1) << n << " " << columns;
      }
}

TEST(Sampler, SobolIsUniformAndItsPurposesAreIndependent) {
  const Sampler sampler = sobol(5, 7);
  std::vector<int> square(kBins * kBins), pixel_lens(kBins * kBins), lights(kBins * kBins);
  for (uint32_t pixel = 0; pixel < 50000; ++pixel) {
    const uint32_t s = pixel % 7;
    const Point2 lens = in_square(sampler, pixel, s, 1, kLens);
    ASSERT_TRUE(lens.x >= 0 && lens.x < 1 && lens.y >= 0 && lens.y < 1);
    const float light = in_square(sampler, pixel, s, 3, kLight).x;
    ++square[size_t(bin(lens.y) * kBins + bin(lens.x))];
    ++pixel_lens[size_t(bin(in_pixel(sampler, pixel, s).x) * kBins + bin(lens.x))];
    ++lights[size_t(bin(light) * kBins + bin(in_square(sampler, pixel, s, 3, kLight + 1).x))];
  }
  for (const auto& counts : {square, pixel_lens, lights})
    EXPECT_LT(std::abs(chi_square_sigmas(counts)), 5);
}

TEST(Sampler, EffectsAreIndependentOfEachOther) {
  const Sampler sampler = jitter(5, 3, 1);
  std::vector<int> pixel_lens(kBins * kBins), lens_light(kBins * kBins), lights(kBins * kBins);
  for (uint32_t pixel = 0; pixel < 50000; ++pixel) {
    const uint32_t s = pixel % 9;
    const float in_cell = in_pixel(sampler, pixel, s).x * 3;
    const float lens = in_square(sampler, pixel, s, 1, kLens).x;
    const float light = in_square(sampler, pixel, s, 1, kLight).x;
    const float second = in_square(sampler, pixel, s, 1, kLight + 1).x;
    ++pixel_lens[size_t(bin(in_cell - std::floor(in_cell)) * kBins + bin(lens))];
    ++lens_light[size_t(bin(lens) * kBins + bin(light))];
    ++lights[size_t(bin(light) * kBins + bin(second))];
  }
  EXPECT_LT(std::abs(chi_square_sigmas(pixel_lens)), 5);
  EXPECT_LT(std::abs(chi_square_sigmas(lens_light)), 5);
  EXPECT_LT(std::abs(chi_square_sigmas(lights)), 5);
}

TEST(Math, DiscIsUniform) {
  const Sampler sampler = jitter(0, 1, 1);
  std::vector<int> counts(8 * 8);
  for (uint32_t pixel = 0; pixel < 100000; ++pixel) {
    const Point2 square = in_square(sampler, pixel, 0, 1, kLens);
    const Point2 p = square_to_disc(square.x, square.y);
    const double r2 = double(p.x) * p.x + double(p.y) * p.y;
    ASSERT_LE(r2, 1.000001);
    const double turn = std::atan2(p.y, p.x) / (2 * std::numbers::pi) + 0.5;
    ++counts[size_t(std::min(7, int(r2 * 8)) * 8 + std::min(7, int(turn * 8)))];
  }
  EXPECT_LT(std::abs(chi_square_sigmas(counts)), 5);
}

TEST(Math, PowUnitIsPow) {
  for (const float y : {0.0f, 0.5f, 1.0f, 3.0827f, 30.0827f, 101.148f, 1000.0f, 100000.0f})
    for (float x = 0; x <= 1; x += 0.0009765f) {
      const double expected = std::pow(double(x), double(y));
      EXPECT_NEAR(pow_unit(x, y), expected, 2e-7) << x << "^" << y;
    }
  EXPECT_EQ(pow_unit(1, 100000), 1);
  EXPECT_EQ(pow_unit(0, 0), 1);
  EXPECT_EQ(pow_unit(0, 2), 0);
  EXPECT_GT(pow_unit(0.99999f, 100000), 0);
}

// The same numbers in every lane, whatever its neighbours are.
TEST(Math, LanesAreIndependent) {
  const size_t lanes = hn::Lanes(d);
  std::vector<float> x(lanes), y(lanes), power(lanes);
  for (size_t i = 0; i < lanes; ++i) x[i] = float(i) / float(lanes), y[i] = float(3 * i);
  hn::StoreU(wide::pow_unit(d, hn::LoadU(d, x.data()), hn::LoadU(d, y.data())), d, power.data());
  for (size_t i = 0; i < lanes; ++i) EXPECT_EQ(power[i], pow_unit(x[i], y[i]));
}

}  // namespace
}  // namespace raio
