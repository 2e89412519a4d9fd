#include <array>
#include <cstring>

#include "accel/bvh_bins.h"

namespace raio {
namespace {

constexpr int kBins = 16;

// Keeps the order of both parts. Without a branch that could be mispredicted, since half of them
// would be: each item is written to both places and one of them then counts.
template <class Below>
size_t partition(BuildRange range, Column<BuildItem>& scratch, Below&& below) {
  if (scratch.size() < range.size()) scratch.resize(range.size());
  size_t kept = 0, moved = 0;
  for (const BuildItem item : range) {
    const bool stays = below(item);
    scratch[moved] = item;
    range[kept] = item;
    kept += stays, moved += !stays;
  }
  std::memcpy(range.data() + kept, scratch.data(), moved * sizeof(BuildItem));
  return kept;
}

}  // namespace

BuildBox box_of(BuildRange range) {
  BuildBox box;
  for (const BuildItem& item : range) box.extend(item);
  return box;
}

BuildSplit split_by_cost(BuildRange range, Column<BuildItem>& scratch) {
  Float4 from = range.front().center2(), to = from;
  for (const BuildItem& item : range) {
    from = min(from, item.center2());
    to = max(to, item.center2());
  }
  const Binning binning(from, to, {kBins, kBins, kBins});
  Bins<kBins> bins;
  for (const BuildItem& item : range) bins.add(item, binning.of(item.center2()));
  const BinSplit split = bins.best(int32_t(range.size()));
  if (split.axis < 0) return {};
  const int axis = split.axis;
  const float origin = binning.origin[axis], scale = binning.per_unit[axis];
  const float plane = float(split.bin);
  const size_t middle = partition(range, scratch, [&](const BuildItem& item) {
    return !((item.lo[axis] - item.minus_hi[axis] - origin) * scale >= plane);
  });
  return {middle, bins.box(axis, 0, split.bin), bins.box(axis, split.bin, kBins)};
}

}  // namespace raio
