// Where samples are added up.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "io/image.h"

namespace raio {

/// Sums are integers (fixed point): adding integers is associative, so that the same samples give
/// the same bytes in whatever order, tiles, threads, shards or resumes they are added. The unit is
/// a power of two chosen from an upper bound of what a sample can bring, so that no sum overflows.
class Film {
 public:
  /// `bound`: no sample of a pixel brings more than this; `samples`: at most so many are added.
  Film(int width, int height, double bound, uint64_t samples);

  /// A value v counts as the integer nearest to min(v, bound) * scale.
  double bound() const { return bound_; }
  double scale() const { return scale_; }

  void add(size_t pixel, std::array<int64_t, 3> rgb) {
    for (size_t c = 0; c < 3; ++c) sums_[pixel * 3 + c] += rgb[c];
  }

  int width() const { return width_; }
  int height() const { return height_; }

  /// The mean of `samples_per_pixel` samples.
  Image resolve(int samples_per_pixel) const;

 private:
  int width_, height_;
  double bound_, scale_;
  std::vector<int64_t> sums_;  // r, g, b per pixel
};

}  // namespace raio
