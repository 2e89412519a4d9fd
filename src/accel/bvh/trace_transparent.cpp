// Traversal of the tree over transparent primitives, compiled once per instruction set (Highway's
// foreach_target) and selected at run time.
#include "accel/bvh/bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/bvh/trace_transparent.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "accel/blocks/tracer-inl.h"
#include "accel/bvh/stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

void next_transparent(const Geometry& g, const Bvh& bvh, const RayBatch& rays,
                      const HitBatch& after, HitBatch& hits, TraceContext& context,
                      const uint32_t* keys) {
  trace_all<Query::next_transparent, StreamScratch>(
      g, bvh, rays, {.hits = &hits, .after = &after, .keys = keys}, context);
}

void transparent_depths(const Geometry& g, const Bvh& bvh, const RayBatch& rays, DepthBatch& depths,
                        TraceContext& context) {
  trace_all<Query::depths, StreamScratch>(g, bvh, rays, {.depths = &depths}, context);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

HWY_EXPORT(next_transparent);
HWY_EXPORT(transparent_depths);

void bvh_next_transparent(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays,
                          const HitBatch& after, HitBatch& hits, TraceContext& context,
                          const uint32_t* keys) {
  HWY_DYNAMIC_DISPATCH(next_transparent)(geometry, bvh, rays, after, hits, context, keys);
}

void bvh_transparent_depths(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays,
                            DepthBatch& depths, TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(transparent_depths)(geometry, bvh, rays, depths, context);
}

}  // namespace raio::core
#endif
