// Raio's fastest structure: a tree of boxes with eight children per node and eight primitives per
// leaf, both laid out for SIMD: one instruction tests all eight. Built by build.cpp, traversed by
// bvh/trace.cpp.
//
// Wald, Benthin and Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using
// Multi-branching BVHs", IRT; Dammertz, Hanika and Keller 2008, "Shallow Bounding Volume
// Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", EGSR.
#pragma once

#include <expected>
#include <string>

#include "accel/accel.h"
#include "accel/blocks/blocks.h"

namespace raio::core {

/// Levels of nodes split by cost; below, ranges are halved, at most 30 times, then split by kind.
inline constexpr int kBvhCostLevels = 48;
inline constexpr int kBvhMaxLevels = kBvhCostLevels + 30 + 3;

/// A child is a node or a block.
inline constexpr uint32_t kNoChild = 0xffffffffu;

struct BvhNode {
  EightBoxes boxes;
  uint32_t child[kBlockWidth];
};

struct Bvh : Blocks {
  Column<BvhNode> nodes;  // the root first; empty for a scene without bounded primitives

  bool empty() const { return nodes.empty(); }
  size_t bytes() const { return Blocks::bytes() + nodes.size() * sizeof(BvhNode); }
};

/// Builds the tree over all opaque items except planes, or over transparent ones if `clear` is set
/// (Geometry::list_transparent()); independent of the number of threads. The error is one line:
/// more than `available` bytes would be needed.
std::expected<Bvh, std::string> build_bvh(const Geometry& geometry,
                                          const AvailableMemory& available = available_memory(),
                                          bool clear = false);

/// Traversal with the machine's best instruction set. Hits are exactly those of brute force.
/// Sixteen coherent neighbours of a batch travel as one beam.
void bvh_closest(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
                 TraceContext& context);
void bvh_occluded(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
                  TraceContext& context);

/// Accel::next_transparent() and Accel::transparent_depths() with the tree over transparent
/// primitives.
void bvh_next_transparent(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays,
                          const HitBatch& after, HitBatch& hits, TraceContext& context,
                          const uint32_t* keys);
void bvh_transparent_depths(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays,
                            DepthBatch& depths, TraceContext& context);

/// Traverses with one ray and logs to `context.log`: nodes and leaves, without depths and boxes,
/// and the items tested.
void bvh_log(const Geometry& geometry, const Bvh& bvh, const RayBatch& ray, bool any,
             TraceContext& context);

}  // namespace raio::core
