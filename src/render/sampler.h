// Where the samples of a pixel go: its cells, the lens, the lights.
//
// The table of dimensions. Each row is a pair of numbers in the unit square, a function of
// (seed, pixel, sample, branch, purpose), so that effects can be switched without moving the
// others:
//
//   purpose      branch                what it places
//   kPixel       1                     the eye ray in its cell of the pixel
//   kLens        1                     the eye ray on the lens
//   kLight + i   place in ray tree     the shadow ray on light i
//
// Branch 1 is the eye ray; the reflected child of branch b is 2b, the refracted one 2b + 1.
#pragma once

#include "base/math.h"
#include "base/random.h"

namespace raio {

enum Purpose : uint32_t { kPixel, kLens, kLight };

inline constexpr uint32_t kEyeBranch = 1;

class Sampler {
 public:
  /// aa x aa cells a pixel, `per_cell` samples in each.
  Sampler(uint32_t seed, int aa, int per_cell)
      : seed_(seed * 0x9e3779b9u), aa_(uint32_t(aa)), per_cell_(uint32_t(per_cell)) {
    samples_ = aa_ * aa_ * per_cell_;
    for (columns_ = uint32_t(std::sqrt(double(samples_))); samples_ % columns_;) --columns_;
    rows_ = samples_ / columns_;
  }

  uint32_t samples() const { return samples_; }

  /// In the unit pixel: its centre for one cell, else a random point of the sample's cell.
  Point2 in_pixel(uint32_t pixel, uint32_t sample) const {
    if (aa_ == 1) return {0.5f, 0.5f};
    const Uint4 r = random(pixel, sample, kEyeBranch, kPixel);
    const uint32_t cell = sample / per_cell_;
    return {(float(cell % aa_) + to_unit(r.x)) / float(aa_),
            (float(cell / aa_) + to_unit(r.y)) / float(aa_)};
  }

  /// In the unit square, for one of the other purposes. The samples of a pixel share out the square
  /// among them, one random point in each of `samples()` equal cells, dealt in an order of the
  /// pixel's own.
  Point2 in_square(uint32_t pixel, uint32_t sample, uint32_t branch, uint32_t purpose) const {
    const Uint4 r = random(pixel, sample, branch, purpose);
    const uint32_t order = random(pixel, ~0u, branch, purpose).x;
    const uint32_t cell = permute(sample, samples_, order);
    return {(float(cell % columns_) + to_unit(r.x)) / float(columns_),
            (float(cell / columns_) + to_unit(r.y)) / float(rows_)};
  }

 private:
  Uint4 random(uint32_t pixel, uint32_t sample, uint32_t branch, uint32_t purpose) const {
    return hash4({pixel, sample, branch, seed_ + purpose});
  }

  uint32_t seed_, aa_, per_cell_, samples_, columns_, rows_;
};

}  // namespace raio
