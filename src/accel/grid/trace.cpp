// Traversal of the cells of the grid, compiled once per instruction set (Highway's foreach_target)
// and selected at run time.
#include "accel/grid/grid.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/grid/trace.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "accel/blocks/tracer-inl.h"
#include "accel/grid/traversal-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

void closest(const Geometry& g, const GridBlocks& blocks, const RayBatch& rays, HitBatch& hits,
             TraceContext& context) {
  trace_all<Query::closest, IdLists>(g, blocks, rays, {.hits = &hits}, context);
}

void occluded(const Geometry& g, const GridBlocks& blocks, const RayBatch& rays, uint8_t* hit,
              TraceContext& context) {
  trace_all<Query::any, IdLists>(g, blocks, rays, {.hit = hit}, context);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

HWY_EXPORT(closest);
HWY_EXPORT(occluded);

void grid_closest(const Geometry& geometry, const GridBlocks& blocks, const RayBatch& rays,
                  HitBatch& hits, TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(closest)(geometry, blocks, rays, hits, context);
}

void grid_occluded(const Geometry& geometry, const GridBlocks& blocks, const RayBatch& rays,
                   uint8_t* hit, TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(occluded)(geometry, blocks, rays, hit, context);
}

}  // namespace raio::core
#endif
