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

}  // namespace

BuildBox box_of(BuildRange range) {
  BuildBox box;
  for (const BuildItem& item : range) box.extend(item);
  return box;
}

BuildSplit split_by_cost(BuildRange range, size_t samples, Column<BuildItem>& scratch) {
  Float4 from = range.front().center2(), to = from;
  for (const BuildItem& item : range) {
    from = min(from, item.center2());
    to = max(to, item.center2());
  }
  const Binning binning(from, to, {kBins, kBins, kBins});
  Bins<kBins> bins;
  const size_t step = std::max<size_t>(1, range.size() / samples);
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

}  // namespace raio
