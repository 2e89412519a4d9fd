#include "render/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace raio::core {
namespace {

constexpr int kReach = 2;                                   // pixels
constexpr std::array<float, kReach + 1> kWeights{6, 4, 1};  // of a column or row, binomial
constexpr int kFew = 3;  // of 3x3 pixels with one primitive, if it is about as small as a pixel
constexpr float kSimilar = 0.05f;  // depths, relative

}  // namespace

Image without_noise(const Image& image, std::span<const float> depth,
                    std::span<const uint32_t> id) {
  const int width = image.width, height = image.height;
  const auto index = [&](int x, int y) { return size_t(y) * size_t(width) + size_t(x); };
  // Calls visit(x, y) for the pixel and its neighbours up to that far, inside of the picture.
  const auto around = [&](int x, int y, int reach, auto&& visit) {
    for (int j = std::max(0, y - reach); j <= std::min(height - 1, y + reach); ++j)
      for (int i = std::max(0, x - reach); i <= std::min(width - 1, x + reach); ++i) visit(i, j);
  };
  std::vector<uint8_t> is_small(id.size());
  parallel_for(size_t(height), [&](size_t y) {
    for (int x = 0; x < width; ++x) {
      const uint32_t own = id[index(x, int(y))];
      int equal = 0;
      around(x, int(y), 1, [&](int i, int j) { equal += id[index(i, j)] == own ? 1 : 0; });
      is_small[index(x, int(y))] = own > 0 && equal <= kFew;
    }
  });
  Image out = image;
  parallel_for(size_t(height), [&](size_t row) {
    const int y = int(row);
    for (int x = 0; x < width; ++x) {
      const size_t own = index(x, y);
      if (id[own] == 0) continue;
      Rgb sum;
      float weights = 0;
      around(x, y, kReach, [&](int i, int j) {
        const size_t other = index(i, j);
        const bool alike = id[other] == id[own] || (is_small[own] && is_small[other]);
        if (!alike || std::abs(depth[other] - depth[own]) > kSimilar * std::abs(depth[own])) return;
        const float weight = kWeights[size_t(std::abs(i - x))] * kWeights[size_t(std::abs(j - y))];
        sum = sum + image.pixels[other] * weight, weights += weight;
      });
      out.pixels[own] = sum / weights;  // it is similar to itself
    }
  });
  return out;
}

}  // namespace raio::core
