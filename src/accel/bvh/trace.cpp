// Traversal of the eight-wide tree, compiled once per instruction set (Highway's foreach_target)
// and selected at run time.
#include "accel/bvh/bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/bvh/trace.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "accel/blocks/tracer-inl.h"
#include "accel/bvh/stream-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

void closest(const Geometry& g, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
             TraceContext& context) {
  trace_all<Query::closest, StreamScratch>(g, bvh, rays, {.hits = &hits}, context);
}

void occluded(const Geometry& g, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
              TraceContext& context) {
  trace_all<Query::any, StreamScratch>(g, bvh, rays, {.hit = hit}, context);
}

// Rays that log their path.
template <Query query>
class LoggedRays : public Rays<query> {
 public:
  LoggedRays(const Geometry& geometry, const Bvh& bvh, const Batch& batch, RayScratch& scratch,
             TraceContext& context)
      : Rays<query>(geometry, bvh, batch, scratch, context), bvh_(bvh), log_(*context.log) {}

  void visits(uint32_t ref, size_t n) {
    add_step(ref, false);
    Rays<query>::visits(ref, n);
  }
  HWY_NOINLINE void leaf(uint32_t ref, const uint32_t* ids, size_t n) {
    add_step(ref, true);
    const PrimitiveId* const listed = bvh_.primitives(ref);
    for (int i = 0; i < kBlockWidth && listed[i] != kNoPrimitive; ++i) log_.add_test(listed[i]);
    Rays<query>::leaf(ref, ids, n);
  }

 private:
  void add_step(uint32_t ref, bool leaf) {
    log_.steps.push_back({.node = ref, .leaf = leaf, .first_test = log_.tests.size()});
  }

  const Bvh& bvh_;
  TraceLog& log_;
};

void log(const Geometry& g, const Bvh& bvh, const RayBatch& ray, bool any, TraceContext& context) {
  for (uint32_t i = 0; i < g.count(PrimitiveKind::plane); ++i)
    if (g.is_opaque(PrimitiveKind::plane, i))
      context.log->add_test(g.id_of(PrimitiveKind::plane, i));
  HitBatch hits;
  hits.reset(1);
  uint8_t hit[kChunk];  // only the first counts
  if (any)
    trace_all<Query::any, StreamScratch, LoggedRays>(g, bvh, ray, {.hit = hit}, context);
  else
    trace_all<Query::closest, StreamScratch, LoggedRays>(g, bvh, ray, {.hits = &hits}, context);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

HWY_EXPORT(closest);
HWY_EXPORT(occluded);
HWY_EXPORT(log);

void bvh_closest(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
                 TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(closest)(geometry, bvh, rays, hits, context);
}

void bvh_occluded(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
                  TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(occluded)(geometry, bvh, rays, hit, context);
}

void bvh_log(const Geometry& geometry, const Bvh& bvh, const RayBatch& ray, bool any,
             TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(log)(geometry, bvh, ray, any, context);
}

}  // namespace raio::core
#endif
