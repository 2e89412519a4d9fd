#include <array>
#include <cstring>

#include "accel/bvh/bins.h"

namespace raio::core {
namespace {

constexpr int kBins = 16;
// Above twice this many items, a sample finds the split as well.
constexpr size_t kSamples = 512, kFewSamples = 64;

// Stable partition without a branch, since half would be mispredicted: each item is written to both
// places, and only one of the two indices advances.
template <class Below>
size_t partition(BuildRange range, Column<BuildItem>& scratch, Below&& below) {
  if (scratch.size() < range.size()) scratch.resize(range.size());
  size_t kept = 0, moved = 0;
  for (const BuildItem& from : range) {
    const bool stays = below(from);
    const BuildItem item = from;
    scratch[moved] = item;
    range[kept] = item;
    kept += stays, moved += !stays;
  }
  std::memcpy(range.data() + kept, scratch.data(), moved * sizeof(BuildItem));
  return kept;
}

// For at most as many items as two blocks hold: the best split into two blocks along the axis with
// the largest extent of centres.
BuildSplit split_in_two_blocks(BuildRange range, int axis, Column<BuildItem>& scratch) {
  constexpr size_t kMost = 2 * kBlockWidth;
  const size_t n = range.size();
  // Centres as integers in the same order; the item's number replaces the last bits, so that no two
  // are equal.
  Int4 keys[kMost / 4] = {}, ranks[kMost / 4] = {};
  for (size_t i = 0; i < n; ++i) {
    const auto bits = std::bit_cast<int32_t>(range[i].center2(axis));
    const int32_t ordered = bits ^ ((bits >> 31) & 0x7fffffff);
    keys[i / 4][i % 4] = (ordered & ~int32_t(kMost - 1)) | int32_t(i);
  }
  for (size_t i = 0; i < n; ++i) {
    const int32_t key = keys[i / 4][i % 4];
    for (size_t v = 0; v < kMost / 4; ++v) ranks[v] -= (Int4{key, key, key, key} < keys[v]);
  }
  const auto rank = [&](size_t i) { return size_t(ranks[i / 4][i % 4]); };
  uint8_t order[kMost];
  for (size_t i = 0; i < n; ++i) order[rank(i)] = uint8_t(i);

  BuildBox above[kMost + 1];
  for (size_t k = n; k-- > 1;) (above[k] = above[k + 1]).extend(range[order[k]]);
  BuildSplit best;
  float least = std::numeric_limits<float>::infinity();
  BuildBox below;
  for (size_t k = 1; k <= std::min<size_t>(n - 1, kBlockWidth); ++k) {
    below.extend(range[order[k - 1]]);
    if (n - k > size_t(kBlockWidth)) continue;
    const Float4 areas = half_areas(below, above[k], above[k]);
    if (areas[0] + areas[1] < least || best.middle == 0)
      least = areas[0] + areas[1], best = {k, below, above[k]};
  }
  size_t i = 0;
  partition(range, scratch, [&](const BuildItem&) { return rank(i++) < best.middle; });
  return best;
}

// The best split between bins of one axis, with centres (times two) from `from` to `to`.
BuildSplit split_between_bins(BuildRange range, int axis, float from, float to,
                              Column<BuildItem>& scratch) {
  const float scale = float(kBins) * (1 - 1e-6f) / (to - from);
  if (!std::isfinite(scale)) return {};
  BuildBox boxes[kBins];
  int32_t counts[kBins] = {};
  const auto bin_of = [&](const BuildItem& item) {
    return size_t((item.center2(axis) - from) * scale) & (kBins - 1);
  };
  for (const BuildItem& item : range) {
    const size_t bin = bin_of(item);
    boxes[bin].extend(item);
    ++counts[bin];
  }
  BuildBox above[kBins + 1];
  for (size_t b = kBins; b-- > 1;) (above[b] = above[b + 1]).extend(boxes[b]);
  const auto blocks = [](size_t n) { return float((n + (kBlockWidth - 1)) / kBlockWidth); };
  float least = std::numeric_limits<float>::infinity();
  size_t best = 0, n = 0;
  BuildBox below, best_below;
  for (size_t b = 1; b < kBins; ++b) {
    below.extend(boxes[b - 1]);
    n += counts[b - 1];
    const Float4 areas = half_areas(below, above[b], above[b]);
    const float cost = areas[0] * blocks(n) + areas[1] * blocks(range.size() - n);
    if (cost < least) least = cost, best = b, best_below = below;
  }
  if (best == 0) return {};
  const size_t middle =
      partition(range, scratch, [&](const BuildItem& item) { return bin_of(item) < best; });
  return {middle, best_below, above[best]};
}

}  // namespace

BuildBox box_of(BuildRange range) {
  BuildBox box;
  for (const BuildItem& item : range) box.extend(item);
  return box;
}

BuildSplit split_by_cost(BuildRange range, bool hasty, Column<BuildItem>& scratch) {
  const size_t step = std::max<size_t>(1, range.size() / (hasty ? kFewSamples : kSamples));
  Float4 from = range.front().center2(), to = from;
  for (size_t i = 0; i < range.size(); i += hasty ? step : 1) {
    from = min(from, range[i].center2());
    to = max(to, range[i].center2());
  }
  if (hasty && range.size() < 2 * kFewSamples) {
    const Float4 size = to - from;
    const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
    if (range.size() <= 2 * kBlockWidth) return split_in_two_blocks(range, axis, scratch);
    return split_between_bins(range, axis, from[axis], to[axis], scratch);
  }
  const Binning binning(from, to, {kBins, kBins, kBins});
  Bins<kBins> bins;
  int32_t binned = 0;
  for (size_t i = 0; i < range.size(); i += step, ++binned)
    bins.add(range[i], binning.of_inner(range[i].center2()));
  const BinSplit split = bins.best(binned);
  if (split.axis < 0) return {};
  const int axis = split.axis;
  const float origin = binning.origin[axis], scale = binning.per_unit[axis];
  const float plane = float(split.bin);
  const size_t middle = partition(range, scratch, [&](const BuildItem& item) {
    return !((item.center2(axis) - origin) * scale >= plane);
  });
  if (step > 1) return {middle, box_of(range.first(middle)), box_of(range.subspan(middle))};
  return {middle, bins.box(axis, 0, split.bin), bins.box(axis, split.bin, kBins)};
}

}  // namespace raio::core
