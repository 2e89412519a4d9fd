// The samplers against the distributions that they promise, and the arithmetic under them.
#include "integrate/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "integrate/sampler-inl.h"
#include "sanitized.h"

namespace raio::core {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace wide = raio::core::HWY_NAMESPACE;
const hn::ScalableTag<float> d;
const hn::ScalableTag<uint32_t> du;
using tests::if_sanitized;
using D = decltype(hn::ScalableTag<float>());

struct Point2 {
  float x, y;
};
Point2 first(const wide::Wide2<D>& p) { return {hn::GetLane(p.x), hn::GetLane(p.y)}; }

Sampler jitter(uint32_t seed, int aa, int per_cell) {
  RenderSettings o;
  o.seed = seed, o.aa = aa, o.lens_samples = per_cell, o.sampler = SamplerKind::jitter;
  return Sampler(o);
}

Point2 in_pixel(const Sampler& sampler, uint32_t pixel, uint32_t sample) {
  return first(wide::WideSampler<D>(sampler, sample).in_pixel(hn::Set(du, pixel)));
}
Point2 in_square(const Sampler& sampler, uint32_t pixel, uint32_t sample, uint32_t branch,
                 uint32_t purpose) {
  return first(wide::WideSampler<D>(sampler, sample)
                   .in_square(hn::Set(du, pixel), hn::Set(du, branch), purpose));
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

// One sample per pixel: with all samples of a pixel, stratification makes counts more equal than
// random ones.
TEST(Sampler, SquaresAreUniformForEveryPurposeAndBranch) {
  for (const uint32_t seed : {0u, 77u})
    for (const auto& [aa, per_cell] : {std::pair(1, 1), {3, 1}, {3, 3}, {1, 7}})
      for (const uint32_t branch : {1u, 2u, 21u})
        for (const uint32_t purpose : {uint32_t(kLens), uint32_t(kLight), kLight + 5u}) {
          const Sampler sampler = jitter(seed, aa, per_cell);
          std::vector<int> counts(kBins * kBins);
          for (uint32_t pixel = 0; pixel < if_sanitized(10000u, 50000u); ++pixel) {
            const Point2 p = in_square(sampler, pixel, pixel % sampler.samples, branch, purpose);
            ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
            ++counts[size_t(bin(p.y) * kBins + bin(p.x))];
          }
          EXPECT_LT(std::abs(chi_square_sigmas(counts)), 5)
              << seed << " " << aa << " " << per_cell << " " << branch << " " << purpose;
        }
}

TEST(Sampler, PixelCellsAreFilledEvenly) {
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

TEST(Sampler, EverySampleOfAPixelHasItsOwnCell) {
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

// If the cells of two effects were in the same order, except for rotation, each cell of one would
// be paired with only one cell of the other: the mean would converge to a wrong value.
TEST(Sampler, CellsOfDifferentEffectsAreCombinedFreely) {
  constexpr uint32_t kSide = 8, kCells = kSide * kSide;
  const Sampler sampler = jitter(4, kSide, 1);
  const auto cell = [](Point2 p) {
    return uint32_t(p.y * float(kSide)) * kSide + uint32_t(p.x * float(kSide));
  };
  for (uint32_t pixel = 0; pixel < 500; ++pixel) {
    std::vector<int> pixel_lens(kCells), pixel_light(kCells), lens_light(kCells);
    for (uint32_t s = 0; s < kCells; ++s) {
      const uint32_t place = cell(in_pixel(sampler, pixel, s));
      const uint32_t lens = cell(in_square(sampler, pixel, s, 1, kLens));
      const uint32_t light = cell(in_square(sampler, pixel, s, 3, kLight + 2));
      ++pixel_lens[(lens - place) % kCells], ++pixel_light[(light - place) % kCells];
      ++lens_light[(light - lens) % kCells];
    }
    for (const auto& counts : {pixel_lens, pixel_light, lens_light})
      EXPECT_LT(std::ranges::max(counts), 12) << pixel;
  }
}

Sampler sobol(uint32_t seed, int samples) {
  RenderSettings o;
  o.seed = seed, o.samples = samples, o.sampler = SamplerKind::sobol, o.aa = 0;
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

// In every box of every shape that is a 2^-n-th of the square, one of 2^n points.
void expect_net(const std::vector<Point2>& points) {
  const uint32_t n = uint32_t(points.size());
  for (uint32_t columns = 1; columns <= n; columns *= 2) {
    std::vector<int> boxes(n);
    for (const Point2 p : points)
      ++boxes[uint32_t(p.y * float(n / columns)) * columns + uint32_t(p.x * float(columns))];
    EXPECT_EQ(std::ranges::max(boxes), 1) << n << " points, " << columns << " columns";
  }
}

TEST(Sampler, SobolSamplesOfAGroupOfPixelsAreANet) {
  const Sampler sampler = sobol(6, 64);
  for (const uint32_t samples : {1u, 2u, 4u, 8u}) {
    std::vector<Point2> points;
    for (uint32_t y = kGroup; y < 2 * kGroup; ++y)
      for (uint32_t x = 0; x < kGroup; ++x)
        for (uint32_t s = 0; s < samples; ++s)
          points.push_back(in_square(sampler, y << 16 | x, s, 5, kLight));
    expect_net(points);
  }
}

TEST(Sampler, ScreenKeysOfEveryBlockAreANet) {
  const auto coordinate = [](uint32_t digits) {
    float sum = 0;
    for (int i = 0; i < 16; ++i) sum += float(digits >> i & 1) * std::ldexp(1.0f, -1 - i);
    return sum;
  };
  for (uint32_t side = 2; side <= kGroup; side *= 2)
    for (uint32_t y0 = 0; y0 < kGroup; y0 += side)
      for (uint32_t x0 = 0; x0 < kGroup; x0 += side) {
        std::vector<Point2> points;
        for (uint32_t i = 0; i < side * side; ++i) {
          const uint32_t key = kScreenKeys[(y0 + i / side) * kGroup + x0 + i % side];
          points.push_back({coordinate(key & 0xffff), coordinate(key >> 16)});
        }
        expect_net(points);
      }
}

// The errors of a 64 x 64 picture with the integral of a function of a point of the square at each
// pixel, and what remains of them after a 5 x 5 blur.
struct Errors {
  double plain, blurred;
};
template <class Function, class Integral>
Errors errors(const Sampler& sampler, const Function& function, const Integral& integral) {
  constexpr int kSide = 64, kReach = 2;
  std::vector<double> e(kSide * kSide);
  Errors squares{0, 0};
  for (int i = 0; i < kSide * kSide; ++i) {
    const double t = (i / kSide + i % kSide) / double(2 * kSide);
    double sum = 0;
    for (uint32_t s = 0; s < sampler.samples; ++s) {
      const uint32_t place = uint32_t(i / kSide) << 16 | uint32_t(i % kSide);
      sum += function(in_square(sampler, place, s, 1, kLens), t);
    }
    e[size_t(i)] = sum / sampler.samples - integral(t);
    squares.plain += e[size_t(i)] * e[size_t(i)] / (kSide * kSide);
  }
  constexpr int kInner = kSide - 2 * kReach;
  for (int y = kReach; y < kSide - kReach; ++y)
    for (int x = kReach; x < kSide - kReach; ++x) {
      double sum = 0;
      for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx) sum += e[size_t((y + dy) * kSide + x + dx)];
      sum /= (2 * kReach + 1) * (2 * kReach + 1);
      squares.blurred += sum * sum / (kInner * kInner);
    }
  return {std::sqrt(squares.plain), std::sqrt(squares.blurred)};
}
// As in a penumbra: an edge across the light hides a part of it.
Errors edge_errors(const Sampler& sampler) {
  return errors(
      sampler, [](Point2 p, double t) { return p.x + p.y < 2 * t ? 1.0 : 0.0; },
      [](double t) { return t < 0.5 ? 2 * t * t : 1 - 2 * (1 - t) * (1 - t); });
}
Errors smooth_errors(const Sampler& sampler) {
  return errors(
      sampler, [](Point2 p, double t) { return double(p.x) * double(p.y) + t * double(p.x); },
      [](double t) { return 0.25 + 0.5 * t; });
}

TEST(Convergence, ErrorsFallAsTheSamplersPromise) {
  // A quarter of the error at four times the samples is order 1; chance alone has order 1/2.
  const auto order = [](double with_4, double with_64) { return std::log2(with_4 / with_64) / 4; };
  EXPECT_GT(order(edge_errors(jitter(1, 2, 1)).plain, edge_errors(jitter(1, 8, 1)).plain), 0.7);
  EXPECT_GT(order(edge_errors(sobol(1, 4)).plain, edge_errors(sobol(1, 64)).plain), 0.7);
  EXPECT_GT(order(smooth_errors(jitter(1, 2, 1)).plain, smooth_errors(jitter(1, 8, 1)).plain), 0.9);
  EXPECT_GT(order(smooth_errors(sobol(1, 4)).plain, smooth_errors(sobol(1, 64)).plain), 1.2);
}

// A diagonal edge is the one case without an advantage.
TEST(Convergence, SobolErrsLessThanJitter) {
  EXPECT_LT(edge_errors(sobol(1, 64)).plain, 1.05 * edge_errors(jitter(1, 8, 1)).plain);
  EXPECT_LT(smooth_errors(sobol(1, 64)).plain, 0.5 * smooth_errors(jitter(1, 8, 1)).plain);
}

// With independent errors, a fifth remains.
TEST(Convergence, SobolErrorsOfNeighboursCancel) {
  for (const int samples : {1, 2, 3, 4, 8, 16}) {
    const Errors edge = edge_errors(sobol(1, samples)), smooth = smooth_errors(sobol(1, samples));
    EXPECT_LT(edge.blurred, 0.165 * edge.plain) << samples;
    EXPECT_LT(smooth.blurred, 0.12 * smooth.plain) << samples;
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
  // The rounded exponent of two is the float above -1/2; its nearest integer is 0.
  EXPECT_EQ(std::bit_cast<uint32_t>(pow_unit(0.5f, std::nextafter(0.5f, 0.0f))), 0x3f3504f4u);
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
}  // namespace raio::core
