#include "integrate/environment_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

// Writes the sums of probabilities in proportion to `weights`, from 0 to kCertain, or 0 if all of
// them are; returns the sum of the weights. Each positive weight becomes at least 1.
double write_probabilities(std::span<const double> weights, int32_t* sums) {
  double all = 0, sum = 0;
  int32_t positive = 0;
  for (const double w : weights) all += w, positive += w > 0;
  const double scale = EnvironmentDistribution::kCertain - positive;
  *sums = positive = 0;
  for (const double w : weights) {
    sum += w, positive += w > 0;
    *++sums = all > 0 ? positive + int32_t(sum / all * scale) : 0;
  }
  return all;
}

// The distance of the upper border of a row of cells from the zenith's plane: 1 less the sine of
// its altitude, by half the angle from the zenith, without cancellation.
double border(uint32_t row, uint32_t height) {
  if (row == 0) return 0;
  const double sine = exact_sin(std::numbers::pi / 2 * (double(row) - 0.5) / double(height));
  return 2 * sine * sine;
}

}  // namespace

EnvironmentDistribution::EnvironmentDistribution(const Environment& picture,
                                                 std::span<const Rgb> texels)
    : width(picture.width), height(picture.height), rows(size_t(height) + 2) {
  const size_t count = size_t(height) + 1, stride = size_t(width) + 1;
  columns = std::make_unique_for_overwrite<int32_t[]>(count * stride);
  top.resize(count), step.resize(count), density.resize(count);
  std::vector<double> of_rows(count);
  const auto write_row = [&](uint32_t row, std::vector<double>& weights) {
    const Rgb* const above = &texels[size_t(std::max(row, 1u) - 1) * width];
    const Rgb* const below = &texels[size_t(std::min(row, height - 1)) * width];
    const auto of_texel = [](Rgb t) { return double(t.x) + double(t.y) + double(t.z); };
    const double first = of_texel(above[0]) + of_texel(below[0]);
    double left = first;
    for (uint32_t c = 0; c < width; ++c) {
      const bool is_last = c + 1 == width;
      const double right = is_last ? first : of_texel(above[c + 1]) + of_texel(below[c + 1]);
      weights[c] = left + right, left = right;
    }
    const bool is_lower = row > height / 2;
    const double upper = border(is_lower ? height + 1 - row : row, height);
    const double lower = border(is_lower ? height - row : row + 1, height);
    top[row] = float(upper), step[row] = float(lower - upper);
    of_rows[row] = write_probabilities(weights, &columns[row * stride]) * std::abs(lower - upper);
  };
  const size_t rows_each = kLoopChunk / width + 1, chunks = (count + rows_each - 1) / rows_each;
  parallel_for(chunks, [&](size_t chunk) {
    std::vector<double> weights(width);
    const size_t end = std::min(count, (chunk + 1) * rows_each);
    for (size_t row = chunk * rows_each; row < end; ++row) write_row(uint32_t(row), weights);
  });
  write_probabilities(of_rows, rows.data());
  constexpr double kPerCertain = 1.0 / kCertain;
  for (size_t row = 0; row < count; ++row) {
    const double solid_angle = 2 * std::numbers::pi / double(width) * std::abs(double(step[row]));
    density[row] =
        float(double(rows[row + 1] - rows[row]) * kPerCertain * kPerCertain / solid_angle);
  }
}

}  // namespace raio::core
