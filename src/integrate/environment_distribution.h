// The distribution of directions for sampling an environment (scene/scene.h) in proportion to its
// radiance: tables, which environment_sampler-inl.h reads. The picture is divided into cells
// between the centres of texels, within which the radiance is interpolated; in a cell, the density
// per solid angle is constant. A row of cells is chosen first, then a cell of the row. Pharr, Jakob
// and Humphreys 2023, "Physically Based Rendering", 4th edition, section 12.5.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace raio::core {

/// For a picture of `width` x `height` texels: height + 1 rows of `width` cells. Cell (row, column)
/// lies below row - 1 and above `row`, to the right of `column`; the first and the last row are
/// halves. Probabilities are integers, so that they add up to 1 exactly and each cell with light
/// has some.
struct EnvironmentDistribution {
  /// Of a valid scene's environment. All threads work on large pictures; the tables do not depend
  /// on their number.
  EnvironmentDistribution(const Environment& picture, std::span<const Rgb> texels);

  /// No direction can be chosen.
  bool is_black() const { return rows.back() == 0; }

  static constexpr int32_t kCertain = 1 << 30;

  uint32_t width = 0, height = 0;
  std::vector<int32_t> rows;           // height + 2 sums: the probability of the rows above
  std::unique_ptr<int32_t[]> columns;  // width + 1 sums per row: of the cells to the left
  // For each row, the height of its upper border below the zenith of the unit sphere, and what the
  // lower border adds; in the lower half, rows > height / 2, above the nadir. So heights keep their
  // digits near the poles.
  std::vector<float> top, step;
  std::vector<float>
      density;  // per solid angle, of a cell with probability 1 / kCertain in its row
};

}  // namespace raio::core
