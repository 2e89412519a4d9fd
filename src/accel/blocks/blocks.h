// Primitives eight at a time: blocks of up to eight of one kind, laid out so that one SIMD
// instruction meets all of them. What the tree has in its leaves and the grid in its cells.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "accel/geometry.h"
#include "base/box.h"
#include "base/memory.h"

namespace raio {

inline constexpr int kBlockWidth = 8;

/// A reference names a pool in its upper bits and an index into that pool in the others. The blocks
/// of a kind are in the pool of its number; planes have no blocks, so their pool holds the nodes.
enum class Pool : uint32_t { nodes };
inline constexpr size_t kPools = kPrimitiveKinds;
inline constexpr int kRefIndexBits = 32 - std::bit_width(kPools - 1);
/// The reference of all bits set names nothing.
inline constexpr uint32_t kMaxInPool = (uint32_t(1) << kRefIndexBits) - 1;
static_assert(kMaxInPool >= 1u << 28, "the pools leave too few bits for an index");
static_assert(!kIsBounded<PrimitiveKind(Pool::nodes)>);
constexpr Pool pool_of(PrimitiveKind kind) { return Pool(kind); }
constexpr uint32_t pool_ref(Pool pool, uint32_t index) {
  return uint32_t(pool) << kRefIndexBits | index;
}
constexpr Pool ref_pool(uint32_t ref) { return Pool(ref >> kRefIndexBits); }
constexpr uint32_t ref_index(uint32_t ref) { return ref & kMaxInPool; }

/// Eight boxes: planes[0] the lower ones, planes[1] the upper, per axis.
struct alignas(32) EightBoxes {
  float planes[2][3][kBlockWidth];

  /// No ray meets an empty one.
  void set_empty() {
    std::fill_n(&planes[0][0][0], 3 * kBlockWidth, std::numeric_limits<float>::infinity());
    std::fill_n(&planes[1][0][0], 3 * kBlockWidth, -std::numeric_limits<float>::infinity());
  }
  void set(size_t i, const Box3f& box) {
    for (int a = 0; a < 3; ++a) planes[0][a][i] = box.lo[a], planes[1][a][i] = box.hi[a];
  }
  Box3f box(size_t i) const {
    return {{planes[0][0][i], planes[0][1][i], planes[0][2][i]},
            {planes[1][0][i], planes[1][1][i], planes[1][2][i]}};
  }
};

/// Columns of the numbers of a kind, by the names that numbers_of() gives them.
template <template <class> class Numbers>
Numbers<float[kBlockWidth]> columns_of(Numbers<float>);
template <PrimitiveKind kind>
using NumberColumns = decltype(columns_of(numbers_of(std::declval<const Baked<kind>&>())));

/// Up to eight primitives of one kind. Lanes without one hold something that no ray meets. This is
/// the block of kinds that are tested in double, which is dear: the boxes tell which are worth it.
template <PrimitiveKind kind>
struct alignas(32) Block {
  EightBoxes boxes;
  NumberColumns<kind> numbers;
  PrimitiveId primitive[kBlockWidth];
};
template <>
struct alignas(32) Block<PrimitiveKind::sphere> {
  float x[kBlockWidth], y[kBlockWidth], z[kBlockWidth], radius[kBlockWidth];
  PrimitiveId primitive[kBlockWidth];
};
template <>
struct alignas(32) Block<PrimitiveKind::triangle> {
  float corner[3][3][kBlockWidth];  // [corner][axis]
  PrimitiveId primitive[kBlockWidth];
};
using SphereBlock = Block<PrimitiveKind::sphere>;
using TriangleBlock = Block<PrimitiveKind::triangle>;

/// A column of blocks for each kind that is bounded.
template <class = std::make_index_sequence<kPrimitiveKinds>>
struct BlockColumns;
template <size_t... k>
struct BlockColumns<std::index_sequence<k...>> {
  template <PrimitiveKind kind>
  static auto column() {
    if constexpr (kIsBounded<kind>)
      return Column<Block<kind>>();
    else
      return std::monostate();
  }
  using type = std::tuple<decltype(column<PrimitiveKind(k)>())...>;
};

struct Blocks {
  BlockColumns<>::type columns;
  float reach = 0;  // the largest coordinate in any of them
  // Where rays start further apart than this, beams of any-hit rays do not pay.
  float farthest_apart = std::numeric_limits<float>::infinity();
  // Those that most rays meet, or that hold so few primitives that most of eight lanes would be
  // wasted. Rays that travel alone meet them sixteen at a time, before they walk.
  std::vector<uint32_t> shared;

  template <PrimitiveKind kind>
  auto& of() {
    return std::get<size_t(kind)>(columns);
  }
  template <PrimitiveKind kind>
  const auto& of() const {
    return std::get<size_t(kind)>(columns);
  }

  /// The eight primitives of a block, those that it lacks last.
  const PrimitiveId* primitives(uint32_t ref) const;
  size_t count_primitives(uint32_t ref) const {
    const PrimitiveId* const first = primitives(ref);
    return size_t(std::find(first, first + kBlockWidth, kNoPrimitive) - first);
  }

  /// Bakes up to eight primitives of one kind into the block that `ref` names.
  void fill(const Geometry& geometry, uint32_t ref, std::span<const PrimitiveId> ids);

  /// By number of blocks per Pool.
  static double bytes_of(const std::array<uint32_t, kPools>& counts);
  void resize(const std::array<uint32_t, kPools>& counts);
  size_t count() const;
  size_t bytes() const;
};

}  // namespace raio
