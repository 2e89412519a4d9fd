// Components of the builder of the eight-wide tree: primitives as boxes, splits of a range in two,
// and the plan of the splits at the top of a large tree. For build.cpp, which makes nodes and
// blocks.
#pragma once

#include <bit>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "accel/geometry.h"
#include "base/memory.h"

namespace raio::core {

/// Vectors of four, as compiler extensions: available on every machine, so trees are identical;
/// nothing here justifies a choice of instruction set at run time.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

inline Float4 splat(float x) { return Float4{x, x, x, x}; }
inline Float4 min(Float4 a, Float4 b) { return a < b ? a : b; }
inline Float4 max(Float4 a, Float4 b) { return a > b ? a : b; }
inline Float4 abs(Float4 a) { return max(a, -a); }

/// Lower ends and negated upper ends: a box grows by minima alone, and centre and size take one
/// subtraction and one addition. Initially empty.
struct BuildBox {
  Float4 lo = splat(std::numeric_limits<float>::infinity());
  Float4 minus_hi = lo;

  void extend(const BuildBox& b) { lo = min(lo, b.lo), minus_hi = min(minus_hi, b.minus_hi); }
  Float4 center2() const { return lo - minus_hi; }
  float center2(int axis) const { return lo[axis] - minus_hi[axis]; }
  Box3f box() const { return {{lo[0], lo[1], lo[2]}, {-minus_hi[0], -minus_hi[1], -minus_hi[2]}}; }
};

/// A primitive: its box, and its id in the fourth lane.
struct BuildItem : BuildBox {
  PrimitiveId id() const { return std::bit_cast<PrimitiveId>(float(lo[3])); }
  void set(const BuildBox& box, PrimitiveId id) {
    lo = box.lo, minus_hi = box.minus_hi;
    lo[3] = std::bit_cast<float>(id), minus_hi[3] = 0;
  }
};

/// Items in ascending order of ids; every split preserves it.
using BuildRange = std::span<BuildItem>;

BuildBox box_of(BuildRange range);

/// A range split in two, with the box of each part; `middle` is 0 if no plane separates the
/// centres.
struct BuildSplit {
  size_t middle = 0;
  BuildBox below{}, above{};
};

/// The best split between bins of all axes. In fast mode, many items are sampled, and few items are
/// split along one axis only. `scratch` grows to the size of the range.
BuildSplit split_by_cost(BuildRange range, bool hasty, Column<BuildItem>& scratch);

/// The splits at the top of a tree over many items, found on a lattice of cells and their boxes
/// instead of the items, which then move once instead of once per split.
struct BuildPlan {
  struct Node {
    size_t begin = 0, end = 0;
    BuildBox box;
    uint32_t below = 0, above = 0;  // 0: no further split
  };
  std::vector<Node> nodes;  // the first spans all
};

/// The minimum number of items for a plan.
inline constexpr size_t kPlanAbove = size_t(1) << 17;
/// The maximum depth of a plan.
inline constexpr int kPlanDepth = 18;

/// Makes the items 0 .. out.size() - 1 with `make`, twice each, and writes their ids to `out`, by
/// leaves of the plan and by number within each.
BuildPlan make_plan(std::span<PrimitiveId> out,
                    const std::function<void(size_t first, BuildRange)>& make);

}  // namespace raio::core
