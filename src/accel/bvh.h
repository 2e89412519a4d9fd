// Raio's own fastest structure: a tree of boxes, eight children a node, eight primitives a leaf,
// both laid out so that one SIMD instruction meets all eight. Built by bvh_build.cpp, walked by
// bvh_trace.cpp.
//
// Wald, Benthin and Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
// Multi-branching BVHs", IRT; Dammertz, Hanika and Keller 2008, "Shallow Bounding Volume
// Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", EGSR.
#pragma once

#include <algorithm>
#include <expected>
#include <limits>
#include <string>

#include "accel/accel.h"

namespace raio {

inline constexpr int kBvhWidth = 8;

/// Levels of nodes: so many are split by cost; from there on ranges are halved, at most 30 times,
/// and then parted by kind.
inline constexpr int kBvhCostLevels = 48;
inline constexpr int kBvhMaxLevels = kBvhCostLevels + 30 + 3;

/// What a child of a node is: 2 bits of this, 30 bits of index into the pool of its kind.
enum class BvhChild : uint32_t { node, spheres, triangles, cones };
inline constexpr uint32_t kNoChild = 0xffffffffu;
constexpr uint32_t bvh_ref(BvhChild kind, uint32_t index) { return uint32_t(kind) << 30 | index; }
constexpr BvhChild bvh_kind(uint32_t ref) { return BvhChild(ref >> 30); }
constexpr uint32_t bvh_index(uint32_t ref) { return ref & 0x3fffffffu; }

/// Eight boxes: planes[0] the lower ones, planes[1] the upper, per axis.
struct alignas(32) EightBoxes {
  float planes[2][3][kBvhWidth];

  /// No ray meets an empty one.
  void set_empty() {
    std::fill_n(&planes[0][0][0], 3 * kBvhWidth, std::numeric_limits<float>::infinity());
    std::fill_n(&planes[1][0][0], 3 * kBvhWidth, -std::numeric_limits<float>::infinity());
  }
  void set(size_t i, const Box3f& box) {
    for (int a = 0; a < 3; ++a) planes[0][a][i] = box.lo[a], planes[1][a][i] = box.hi[a];
  }
};

struct BvhNode {
  EightBoxes boxes;
  uint32_t child[kBvhWidth];
};

/// Up to eight primitives of one kind. Lanes without one hold something that no ray meets.
struct alignas(32) SphereBlock {
  float x[kBvhWidth], y[kBvhWidth], z[kBvhWidth], radius[kBvhWidth];
  ItemId item[kBvhWidth];
};
struct alignas(32) TriangleBlock {
  float corner[3][3][kBvhWidth];  // [corner][axis]
  ItemId item[kBvhWidth];
};
struct alignas(32) ConeBlock {  // the boxes tell which of them are worth a test in double
  EightBoxes boxes;
  // As BakedCone, which explains them.
  float base[3][kBvhWidth], axis[3][kBvhWidth];
  float height[kBvhWidth], radius[kBvhWidth], slope[kBvhWidth];
  ItemId item[kBvhWidth];
};

struct Bvh {
  Column<BvhNode> nodes;  // the root first; empty for a scene without bounded primitives
  Column<SphereBlock> spheres;
  Column<TriangleBlock> triangles;
  Column<ConeBlock> cones;
  float reach = 0;  // the largest coordinate in the tree

  size_t bytes() const;
};

/// The tree over all items but planes, the same for any number of threads. The error is one line:
/// more than `available` bytes would be needed.
std::expected<Bvh, std::string> build_bvh(const Geometry& geometry,
                                          size_t available = available_memory_bytes());

/// The walks, for the best instruction set that this machine has. Hits are those of brute force, to
/// the last bit. Sixteen neighbours of a batch that keep together travel as one.
void bvh_closest(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
                 TraceContext& context);
void bvh_occluded(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
                  TraceContext& context);

}  // namespace raio
