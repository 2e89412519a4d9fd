// Binned surface area heuristic along three axes: Wald 2007, "On fast Construction of SAH-based
// Bounding Volume Hierarchies", IRT. For the builder of the eight-wide tree.
#pragma once

#include <algorithm>
#include <array>

#include "accel/bvh/build.h"
#include "accel/bvh/bvh.h"

namespace raio::core {

/// Half the surface areas of three boxes, in three lanes.
inline Float4 half_areas(const BuildBox& a, const BuildBox& b, const BuildBox& c) {
  // Sizes, negated; the signs cancel in the products.
  const Float4 sa = a.lo + a.minus_hi, sb = b.lo + b.minus_hi, sc = c.lo + c.minus_hi;
  const Float4 xy = __builtin_shufflevector(sa, sb, 0, 4, 1, 5);
  const Float4 z = __builtin_shufflevector(sa, sb, 2, 6, 2, 6);
  const Float4 x = __builtin_shufflevector(xy, sc, 0, 1, 4, 4);
  const Float4 y = __builtin_shufflevector(xy, sc, 2, 3, 5, 5);
  const Float4 w = __builtin_shufflevector(z, sc, 0, 1, 6, 6);
  return x * y + y * w + w * x;
}

/// Between bins bin - 1 and bin of an axis; axis -1: none.
struct BinSplit {
  int axis = -1;
  int bin = 0;
};

template <int kCount>
class Bins {
 public:
  /// `bins` has the bin along each axis.
  void add(const BuildBox& box, Int4 bins, int32_t count = 1) {
    for (int a = 0; a < 3; ++a) {
      boxes_[bins[a]][a].extend(box);
      counts_[bins[a]][a] += count;
    }
  }

  BuildBox box(int axis, int first, int end) const {
    BuildBox sum;
    for (int b = first; b < end; ++b) sum.extend(boxes_[b][axis]);
    return sum;
  }

  /// The best split over the first `count` bins, all three axes at once. One lane of a block costs
  /// about as much as all eight.
  BinSplit best(int32_t total, int count = kCount) const {
    const auto cost = [&](const BuildBox* sums, Int4 n) {
      const Int4 blocks = (n + (kBlockWidth - 1)) >> std::countr_zero(unsigned(kBlockWidth));
      return half_areas(sums[0], sums[1], sums[2]) * __builtin_convertvector(blocks, Float4);
    };
    Float4 above[kCount];
    BuildBox sums[3];
    Int4 n{};
    for (int b = count - 1; b > 0; --b) {
      for (int a = 0; a < 3; ++a) sums[a].extend(boxes_[b][a]);
      n += std::bit_cast<Int4>(counts_[b]);
      above[b] = cost(sums, n);
    }
    std::fill_n(sums, 3, BuildBox());
    n = Int4{};
    // An empty side costs infinity times zero, NaN, which compares as not less.
    Float4 least = splat(std::numeric_limits<float>::infinity());
    Int4 bins{};
    for (int b = 1; b < count; ++b) {
      for (int a = 0; a < 3; ++a) sums[a].extend(boxes_[b - 1][a]);
      n += std::bit_cast<Int4>(counts_[b - 1]);
      const Float4 sum = cost(sums, n) + above[b];
      const Int4 better = (sum < least) & (n > 0) & (n < total);
      least = better ? sum : least;
      bins = better ? Int4{b, b, b, b} : bins;
    }
    BinSplit out;
    float cheapest = std::numeric_limits<float>::infinity();
    for (int a = 0; a < 3; ++a)
      if (least[a] < cheapest) cheapest = least[a], out = {a, bins[a]};
    return out;
  }

 private:
  BuildBox boxes_[kCount][3];
  std::array<int32_t, 4> counts_[kCount] = {};
};

/// Bins for centres (times two) between two points, with the requested numbers along the axes.
/// Centres outside go to the outermost bins.
struct Binning {
  Float4 origin, per_unit{}, last{};
  Int4 mask{};

  /// An axis on which the points coincide, or are too close to divide, has one bin.
  Binning(Float4 from, Float4 to, const std::array<int, 3>& counts) : origin(from) {
    for (int a = 0; a < 3; ++a) {
      const float scale = float(counts[a]) * (1 - 1e-6f) / (to[a] - from[a]);
      per_unit[a] = std::isfinite(scale) ? scale : 0;
      last[a] = float(counts[a] - 1);
      mask[a] = counts[a] - 1;
    }
  }
  /// The bins along the axes; NaN goes to the first.
  Int4 of(Float4 center2) const {
    const Float4 x = (center2 - origin) * per_unit;
    return __builtin_convertvector(min(last, x > 0 ? x : Float4{}), Int4);
  }
  /// The same for centres between the points, with a power of two of bins.
  Int4 of_inner(Float4 center2) const {
    const Float4 x = (center2 - origin) * per_unit;
    return __builtin_convertvector(x, Int4) & mask;
  }
};

}  // namespace raio::core
