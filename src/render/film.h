// Where samples are added up.
#pragma once

#include <cmath>
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

  void add(size_t pixel, Rgb value) {
    int64_t* s = &sums_[pixel * 3];
    s[0] += fixed(value.x), s[1] += fixed(value.y), s[2] += fixed(value.z);
  }

  /// Values n of pixels[n].
  void add(const uint32_t* pixels, const float* r, const float* g, const float* b, size_t count);

  int width() const { return width_; }
  int height() const { return height_; }

  /// The mean of `samples_per_pixel` samples.
  Image resolve(int samples_per_pixel) const;

 private:
  // A value beyond what floats hold counts as the bound.
  int64_t fixed(float value) const {
    return std::llrint((double(value) < bound_ ? double(value) : bound_) * scale_);
  }

  int width_, height_;
  double bound_, scale_;
  std::vector<int64_t> sums_;  // r, g, b per pixel
};

}  // namespace raio
