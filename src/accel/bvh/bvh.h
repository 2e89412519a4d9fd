// Raio's own fastest structure: a tree of boxes, eight children a node, eight primitives a leaf,
// both laid out so that one SIMD instruction meets all eight. Built by build.cpp, walked by
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

namespace raio {

/// Levels of nodes: so many are split by cost; from there on ranges are halved, at most 30 times,
/// and then parted by kind.
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

/// The tree over all items but planes that are opaque, or over those that are `clear`
/// (Geometry::list_transparent()); the same for any number of threads. The error is one line:
/// more than `available` bytes would be needed.
std::expected<Bvh, std::string> build_bvh(const Geometry& geometry,
                                          size_t available = available_memory_bytes(),
                                          bool clear = false);

/// The walks, for the best instruction set that this machine has. Hits are those of brute force, to
/// the last bit. Sixteen neighbours of a batch that keep together travel as one.
void bvh_closest(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
                 TraceContext& context);
void bvh_occluded(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
                  TraceContext& context);

/// Accel::next_transparent() and Accel::transparent_depths() by the tree over what is clear.
void bvh_next_transparent(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays,
                          const HitBatch& after, HitBatch& hits, TraceContext& context,
                          const uint32_t* keys);
void bvh_transparent_depths(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays,
                            DepthBatch& depths, TraceContext& context);

/// The walk of one ray, which goes to `context.log`: nodes and leaves, without depths and boxes,
/// and the items that are tested.
void bvh_log(const Geometry& geometry, const Bvh& bvh, const RayBatch& ray, bool any,
             TraceContext& context);

}  // namespace raio
