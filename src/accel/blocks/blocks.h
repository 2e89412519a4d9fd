// Blocks of up to eight primitives of one kind, laid out for SIMD: one instruction tests all eight.
// The leaves of the tree and the contents of grid cells.
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

namespace raio::core {

inline constexpr int kBlockWidth = 8;

/// A reference has a pool in its upper bits and an index into it in the others. Blocks of a kind
/// are in the pool of its number; planes have no blocks, so their pool holds the nodes.
enum class Pool : uint32_t { nodes };
inline constexpr size_t kPools = kPrimitiveKinds;
inline constexpr int kRefIndexBits = 32 - std::bit_width(kPools - 1);
/// The reference with all bits set is null.
inline constexpr uint32_t kMaxInPool = (uint32_t(1) << kRefIndexBits) - 1;
static_assert(kRefIndexBits >= 28, "the kinds leave too few bits for an index");
static_assert(!kIsBounded<PrimitiveKind(Pool::nodes)>);
constexpr Pool pool_of(PrimitiveKind kind) { return Pool(kind); }
constexpr uint32_t pool_ref(Pool pool, uint32_t index) {
  return uint32_t(pool) << kRefIndexBits | index;
}
constexpr Pool ref_pool(uint32_t ref) { return Pool(ref >> kRefIndexBits); }
constexpr uint32_t ref_index(uint32_t ref) { return ref & kMaxInPool; }

/// Eight boxes: planes[0] are the lower ones, planes[1] the upper, per axis.
struct alignas(32) EightBoxes {
  float planes[2][3][kBlockWidth];

  /// No ray hits an empty one.
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

/// Columns of the members of a kind, named as in numbers_of().
template <template <class> class Numbers>
Numbers<float[kBlockWidth]> columns_of(Numbers<float>);
template <PrimitiveKind kind>
using NumberColumns = decltype(columns_of(numbers_of(std::declval<const Baked<kind>&>())));

/// Up to eight primitives of one kind. Unused lanes hold something that no ray hits. This block is
/// for kinds tested in double, which is expensive: the boxes cull most tests.
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
  float corner[3][3][kBlockWidth];  // [vertex][axis]
  PrimitiveId primitive[kBlockWidth];
};
using SphereBlock = Block<PrimitiveKind::sphere>;
using TriangleBlock = Block<PrimitiveKind::triangle>;

/// An array of blocks for each bounded kind.
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
  float reach = 0;  // the largest absolute coordinate
  // If ray origins are further apart than this, beams of any-hit rays do not pay.
  float farthest_apart = std::numeric_limits<float>::infinity();
  // Blocks that most rays hit, or with so few primitives that most of the eight lanes would be
  // wasted. Single rays are tested with them sixteen at a time, before the traversal.
  std::vector<uint32_t> shared;

  template <PrimitiveKind kind>
  auto& of() {
    return std::get<size_t(kind)>(columns);
  }
  template <PrimitiveKind kind>
  const auto& of() const {
    return std::get<size_t(kind)>(columns);
  }

  /// The eight primitives of a block; unused ones are last.
  const PrimitiveId* primitives(uint32_t ref) const;
  size_t count_primitives(uint32_t ref) const {
    const PrimitiveId* const first = primitives(ref);
    return size_t(std::find(first, first + kBlockWidth, kNoPrimitive) - first);
  }

  /// Bakes up to eight primitives of one kind into the block `ref`.
  void fill(const Geometry& geometry, uint32_t ref, std::span<const PrimitiveId> ids);

  /// The size of these numbers of blocks per Pool.
  static double bytes_of(const std::array<uint32_t, kPools>& counts);
  void resize(const std::array<uint32_t, kPools>& counts);
  size_t count() const;
  size_t bytes() const;
};

}  // namespace raio::core
