// Primitives eight at a time: blocks of up to eight of one kind, laid out so that one SIMD
// instruction meets all of them. What the tree has in its leaves and the grid in its cells.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "accel/geometry.h"
#include "base/box.h"
#include "base/memory.h"

namespace raio {

inline constexpr int kBlockWidth = 8;

/// What a reference names: 2 bits of this, 30 bits of index into that pool.
enum class Pool : uint32_t { nodes, spheres, triangles, cones };
constexpr uint32_t pool_ref(Pool pool, uint32_t index) { return uint32_t(pool) << 30 | index; }
constexpr Pool ref_pool(uint32_t ref) { return Pool(ref >> 30); }
constexpr uint32_t ref_index(uint32_t ref) { return ref & 0x3fffffffu; }

/// Where blocks of a kind are; planes have none.
constexpr Pool pool_of(PrimitiveKind kind) {
  return kind == PrimitiveKind::sphere     ? Pool::spheres
         : kind == PrimitiveKind::triangle ? Pool::triangles
                                           : Pool::cones;
}

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
};

/// Up to eight primitives of one kind. Lanes without one hold something that no ray meets.
struct alignas(32) SphereBlock {
  float x[kBlockWidth], y[kBlockWidth], z[kBlockWidth], radius[kBlockWidth];
  PrimitiveId item[kBlockWidth];
};
struct alignas(32) TriangleBlock {
  float corner[3][3][kBlockWidth];  // [corner][axis]
  PrimitiveId item[kBlockWidth];
};
struct alignas(32) ConeBlock {  // the boxes tell which of them are worth a test in double
  EightBoxes boxes;
  // As BakedCone, which explains them.
  float base[3][kBlockWidth], axis[3][kBlockWidth];
  float height[kBlockWidth], radius[kBlockWidth], slope[kBlockWidth];
  PrimitiveId item[kBlockWidth];
};

struct Blocks {
  Column<SphereBlock> spheres;
  Column<TriangleBlock> triangles;
  Column<ConeBlock> cones;
  float reach = 0;  // the largest coordinate in any of them
  // Where rays start further apart than this, beams of any-hit rays do not pay.
  float farthest_apart = std::numeric_limits<float>::infinity();
  // Those that most rays meet, or that hold so few primitives that most of eight lanes would be
  // wasted. Rays that travel alone meet them sixteen at a time, before they walk.
  std::vector<uint32_t> shared;

  /// The eight items of a block, those that it lacks last.
  const PrimitiveId* items(uint32_t ref) const;

  /// Bakes up to eight primitives of one kind into the block that `ref` names.
  void fill(const Geometry& geometry, uint32_t ref, std::span<const PrimitiveId> items);

  size_t bytes() const {
    return spheres.size() * sizeof(SphereBlock) + triangles.size() * sizeof(TriangleBlock) +
           cones.size() * sizeof(ConeBlock);
  }
};

}  // namespace raio
