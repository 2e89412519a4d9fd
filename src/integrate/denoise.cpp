#include "integrate/denoise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace raio::core {
namespace {

// Measured on the pictures of docs/denoise.md; the errors change little around them.
constexpr int kWindow = 5;                // pixels on each side that a fit looks at
constexpr int kPatch = 1;                 // and that a comparison of two pixels looks at
constexpr float kLikeness = 0.7f * 0.7f;  // squares of differences relative to the noise
constexpr double kRidge = 3e-2,
                 kFloor = 3e-3;  // relative to a term's own weight, and to all weight

constexpr int kSide = 2 * kWindow + 1, kOffsets = kSide * kSide;
constexpr int kBlock = 16;  // side of the squares that are filtered at a time
constexpr int kTerms = 10;  // of a linear model: 1, x, y, normal, albedo, depth
constexpr int kLanes = 12;  // with zeroes up to a multiple of four

// Straight colours, not multiplied by alpha.
struct FilterPixel {
  std::array<float, 6> features{};  // normal, albedo
  float nearness = 0;               // the reciprocal of depth, which is linear on planes
  float weight = 0;                 // alpha; 0: not used
  Rgb color, variance;              // that of the pixel's mean
};

using Terms = std::array<float, kLanes>;

// The intercept of a weighted fit is a weighted sum of the colours: row 0 of the inverse of the
// matrix, by Cholesky's method. The ridge (Tikhonov) keeps terms that hardly vary out of the model.
std::array<double, kTerms> first_row_of_inverse(const std::array<Terms, kTerms>& matrix) {
  std::array<std::array<double, kTerms>, kTerms> lower{};
  std::array<double, kTerms> row{};
  const double all = double(matrix[0][0]);
  for (size_t i = 0; i < kTerms; ++i) {
    for (size_t j = 0; j <= i; ++j) {
      auto sum = double(matrix[j][i]);
      if (i == j && i > 0) sum += kRidge * sum + kFloor * all;
      for (size_t k = 0; k < j; ++k) sum -= lower[i][k] * lower[j][k];
      // Exactly, no pivot is below the floor.
      lower[i][j] = i == j ? std::sqrt(std::max(sum, kFloor * all)) : sum / lower[j][j];
    }
    double sum = i == 0;
    for (size_t k = 0; k < i; ++k) sum -= lower[i][k] * row[k];
    row[i] = sum / lower[i][i];
  }
  for (size_t i = kTerms; i-- > 0;) {
    for (size_t k = i + 1; k < kTerms; ++k) row[i] -= lower[k][i] * row[k];
    row[i] /= lower[i][i];
  }
  return row;
}

class NoiseFilter {
 public:
  NoiseFilter(const Image& image, const PixelGuides& guides)
      : image_(image), guides_(guides), pixels_(image.pixels.size()) {
    for_each_index(pixels_.size(), [&](size_t i) { prepare(i); });
    // Few samples estimate the noise badly; neighbours improve the estimate.
    std::vector<Rgb> smooth(pixels_.size());
    for_each_index(pixels_.size(), [&](size_t i) {
      float count = 0;
      for_window(i, 1, [&](const FilterPixel& q, int, int) {
        if (q.weight > 0) smooth[i] += q.variance, ++count;
      });
      if (count > 0) smooth[i] *= 1 / count;
    });
    for (size_t i = 0; i < pixels_.size(); ++i) pixels_[i].variance = smooth[i];
  }

  Column<Rgb> run() const {
    Column<Rgb> filtered = image_.pixels;
    const int columns = (image_.width + kBlock - 1) / kBlock;
    const int rows = (image_.height + kBlock - 1) / kBlock;
    parallel_for(size_t(columns) * size_t(rows), [&](size_t block) {
      filter(int(block % size_t(columns)) * kBlock, int(block / size_t(columns)) * kBlock,
             filtered);
    });
    return filtered;
  }

 private:
  using Weights = std::array<float, kOffsets>;

  void prepare(size_t i) {
    if (!can_denoise(image_.pixels[i], guides_, i)) return;
    FilterPixel& p = pixels_[i];
    p.weight = guides_.alpha_of(i);
    const float scale = 1 / p.weight;
    p.color = image_.pixels[i] * scale;
    for (size_t c = 0; c < 3; ++c) {
      p.features[c] = guides_.normal[3 * i + c] * scale;
      p.features[3 + c] = std::min(guides_.albedo[3 * i + c] * scale, 4.0f);
      const float variance = guides_.variance[3 * i + c] * scale * scale;
      p.variance[int(c)] = std::min(variance / float(guides_.samples[i]), 1e30f);
    }
    p.nearness = std::clamp(1 / guides_.depth[i], 0.0f, 1e6f);
  }

  // Calls f(pixel, dx, dy) for the pixels of the picture around pixel i.
  template <class F>
  void for_window(size_t i, int radius, const F& f) const {
    const int x = int(i % size_t(image_.width)), y = int(i / size_t(image_.width));
    for (int v = std::max(0, y - radius); v <= std::min(image_.height - 1, y + radius); ++v)
      for (int u = std::max(0, x - radius); u <= std::min(image_.width - 1, x + radius); ++u)
        f(pixels_[size_t(v) * size_t(image_.width) + size_t(u)], u - x, v - y);
  }

  // The nearest pixel of the picture.
  const FilterPixel& at(int x, int y) const {
    return pixels_[size_t(std::clamp(y, 0, image_.height - 1)) * size_t(image_.width) +
                   size_t(std::clamp(x, 0, image_.width - 1))];
  }

  // The squared difference of two colours beyond their noise, in units of it.
  static float unlikeness(const FilterPixel& p, const FilterPixel& q) {
    float sum = 0;
    for (int c = 0; c < 3; ++c) {
      const float difference = p.color[c] - q.color[c];
      // A bright spot with much noise must not look like its quiet neighbours.
      const float noise = p.variance[c] + std::min(p.variance[c], q.variance[c]);
      sum += (difference * difference - noise) / (1e-10f + kLikeness * noise);
    }
    return std::min(sum, 1e4f);
  }

  void filter(int x0, int y0, Column<Rgb>& filtered) const {
    constexpr int kWide = kBlock + 2 * kPatch;
    constexpr float kPixels = (2 * kPatch + 1) * (2 * kPatch + 1);
    std::vector<Weights> weights(size_t(kBlock) * kBlock);
    std::array<std::array<float, kWide>, kWide> apart{};  // of pixels of the block and its border
    for (size_t offset = 0; offset < kOffsets; ++offset) {
      const int dx = int(offset) % kSide - kWindow, dy = int(offset) / kSide - kWindow;
      for (size_t y = 0; y < kWide; ++y)
        for (size_t x = 0; x < kWide; ++x) {
          const int px = x0 + int(x) - kPatch, py = y0 + int(y) - kPatch;
          apart[y][x] = unlikeness(at(px, py), at(px + dx, py + dy));
        }
      for (size_t y = 0; y < kBlock; ++y)
        for (size_t x = 0; x < kBlock; ++x) {
          float sum = 0;
          for (size_t v = y; v <= y + 2 * kPatch; ++v)
            for (size_t u = x; u <= x + 2 * kPatch; ++u) sum += apart[v][u];
          // About exp(-mean), without a tail.
          const float mean = std::max(0.0f, sum / (3 * kPixels));
          const float root = std::max(0.0f, 1 - mean / 4);
          weights[y * kBlock + x][offset] = root * root * root * root;
        }
    }
    for (int y = y0; y < std::min(y0 + kBlock, image_.height); ++y)
      for (int x = x0; x < std::min(x0 + kBlock, image_.width); ++x) {
        const size_t i = size_t(y) * size_t(image_.width) + size_t(x);
        if (pixels_[i].weight > 0)
          filtered[i] =
              fit(i, weights[size_t(y - y0) * kBlock + size_t(x - x0)]) * pixels_[i].weight;
      }
  }

  static Terms terms(const FilterPixel& p, const FilterPixel& q, int dx, int dy) {
    Terms t = {1, float(dx) / kWindow, float(dy) / kWindow};
    for (size_t k = 0; k < p.features.size(); ++k) t[3 + k] = q.features[k] - p.features[k];
    const bool is_near = p.nearness > 0;
    t[9] = is_near ? std::min(q.nearness / p.nearness - 1, 4.0f) : float(q.nearness > 0);
    return t;
  }

  // The value of the model at pixel i.
  Rgb fit(size_t i, const Weights& weights) const {
    const FilterPixel& p = pixels_[i];
    std::array<Terms, kTerms> matrix{};
    std::array<Terms, 3> colors{};
    Rgb least = p.color, most = p.color;
    for_window(i, kWindow, [&](const FilterPixel& q, int dx, int dy) {
      const float weight = weights[size_t(dy + kWindow) * kSide + size_t(dx + kWindow)] * q.weight;
      if (!(weight > 0)) return;
      const Terms t = terms(p, q, dx, dy);
      for (size_t row = 0; row < kTerms; ++row)
        for (size_t k = row / 4 * 4; k < kLanes; ++k) matrix[row][k] += weight * t[row] * t[k];
      for (int c = 0; c < 3; ++c)
        for (size_t k = 0; k < kLanes; ++k)
          colors[size_t(c)][k] += weight * (q.color[c] - p.color[c]) * t[k];
      least = min(least, q.color), most = max(most, q.color);
    });
    const auto row = first_row_of_inverse(matrix);
    Rgb result;
    for (int c = 0; c < 3; ++c) {
      double sum = 0;
      for (size_t k = 0; k < kTerms; ++k) sum += row[k] * double(colors[size_t(c)][k]);
      result[c] = std::clamp(float(double(p.color[c]) + sum), least[c], most[c]);
    }
    return result;
  }

  const Image& image_;
  const PixelGuides& guides_;
  std::vector<FilterPixel> pixels_;
};

}  // namespace

bool can_denoise(const Rgb& color, const PixelGuides& guides, size_t pixel) {
  constexpr float kMost = 1e15f;
  const auto is_sound = [](float value) { return std::abs(value) <= kMost; };
  return guides.alpha_of(pixel) > 0 && is_sound(color.x) && is_sound(color.y) && is_sound(color.z);
}

void denoise(Image& color, const PixelGuides& guides) {
  color.pixels = NoiseFilter(color, guides).run();
}

}  // namespace raio::core
