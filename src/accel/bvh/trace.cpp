// The walks of the eight-wide tree, compiled once for each instruction set (Highway's
// foreach_target) and chosen when the program runs.
#include "accel/bvh/bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/bvh/trace.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "accel/blocks/tracer-inl.h"
#include "accel/bvh/stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

void closest(const Geometry& g, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
             TraceContext& context) {
  trace_all<false, StreamScratch>(g, bvh, rays, &hits, nullptr, context);
}

void occluded(const Geometry& g, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
              TraceContext& context) {
  trace_all<true, StreamScratch>(g, bvh, rays, nullptr, hit, context);
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio {

HWY_EXPORT(closest);
HWY_EXPORT(occluded);

void bvh_closest(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
                 TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(closest)(geometry, bvh, rays, hits, context);
}

void bvh_occluded(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
                  TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(occluded)(geometry, bvh, rays, hit, context);
}

}  // namespace raio
#endif
