// The filter of previews, on pictures whose noise is known.
#include "render/preview.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace raio::core {
namespace {

constexpr int kSide = 64;
constexpr float kFar = std::numeric_limits<float>::infinity();

struct Noisy {
  Image image{kSide, kSide};
  std::vector<float> depth = std::vector<float>(kSide * kSide, 1);
  std::vector<uint32_t> id = std::vector<uint32_t>(kSide * kSide, 1);

  Image filtered() const { return without_noise(image, depth, id); }
};

// Black or white at random.
Noisy noise(unsigned seed) {
  Noisy n;
  std::mt19937 random(seed);
  for (Rgb& c : n.image.pixels) c = random() % 2 ? Rgb{1, 1, 1} : Rgb{0, 0, 0};
  return n;
}

// Standard deviation and mean of red in a rectangle.
std::pair<double, double> spread(const Image& image, int x0, int y0, int x1, int y1) {
  double sum = 0, squares = 0, count = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const double v = image.at(x, y).x;
      sum += v, squares += v * v, ++count;
    }
  const double mean = sum / count;
  return {std::sqrt(squares / count - mean * mean), mean};
}

TEST(Preview, AveragesTheLightOfAPrimitive) {
  const Noisy n = noise(1);
  const auto [before, mean] = spread(n.image, 0, 0, kSide, kSide);
  const auto [after, same_mean] = spread(n.filtered(), 0, 0, kSide, kSide);
  EXPECT_LT(after, before / 3);
  EXPECT_NEAR(same_mean, mean, 0.01);
}

TEST(Preview, AveragesPrimitivesSmallerThanAPixel) {
  Noisy n = noise(2);
  for (size_t i = 0; i < n.id.size(); ++i) n.id[i] = uint32_t(i + 1);
  const auto [before, mean] = spread(n.image, 0, 0, kSide, kSide);
  const auto [after, same_mean] = spread(n.filtered(), 0, 0, kSide, kSide);
  EXPECT_LT(after, before / 3);
  EXPECT_NEAR(same_mean, mean, 0.01);
}

TEST(Preview, KeepsOutlinesAndTheBackground) {
  Noisy n;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const size_t i = size_t(y * kSide + x);
      // From the left: background, a red primitive, a green one, small ones near and far.
      const int part = 5 * x / kSide;
      n.id[i] = part == 0 ? 0 : part < 3 ? uint32_t(part) : uint32_t(i + 10);
      n.depth[i] = part == 0 ? kFar : part == 4 ? 2 : 1;
      n.image.pixels[i] = part == 0   ? Rgb{1, 1, 1}
                          : part == 1 ? Rgb{1, 0, 0}
                          : part == 2 ? Rgb{0, 1, 0}
                          : part == 3 ? Rgb{0, 0, 1}
                                      : Rgb{1, 0, 1};
    }
  const Image out = n.filtered();
  for (size_t i = 0; i < out.pixels.size(); ++i) {
    EXPECT_NEAR(out.pixels[i].x, n.image.pixels[i].x, 1e-6) << i;
    EXPECT_NEAR(out.pixels[i].y, n.image.pixels[i].y, 1e-6) << i;
    EXPECT_NEAR(out.pixels[i].z, n.image.pixels[i].z, 1e-6) << i;
  }
}

}  // namespace
}  // namespace raio::core
