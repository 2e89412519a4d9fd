// Hits on transparent primitives, by a separate tree or by testing all of them.
#include <algorithm>

#include "accel/accel.h"
#include "accel/bvh/bvh.h"
#include "accel/instances.h"
#include "accel/intersect.h"

namespace raio::core {
namespace {

// Calls f(kind, index, hit) for the first hit of the ray on each transparent primitive.
template <class F>
void for_each_transparent_hit(const Geometry& geometry, const Ray& ray, TraceContext& context,
                              F&& f) {
  if (!(ray.tmax > 0)) return;
  for_each_kind([&]<PrimitiveKind kind> {
    if (geometry.all_opaque(kind)) return;
    for (uint32_t i = 0; i < geometry.count(kind); ++i) {
      const uint32_t depth = geometry.depth_of(kind, i);
      if (depth == kOpaque || depth == 0) continue;
      ++context.tests;
      if (RayQuery query(ray); test<kind>(geometry, i, query)) f(kind, i, query.best);
    }
  });
}

}  // namespace

Accel::Accel(Geometry geometry) : geometry_(std::move(geometry)) {}
Accel::~Accel() = default;

std::optional<std::string> Accel::build_transparent() {
  if (!geometry_.any_transparent()) return std::nullopt;
  auto bvh = build_bvh(geometry_, available_memory(), true);
  if (!bvh) return std::move(bvh.error());
  transparent_ = std::make_shared<const Bvh>(std::move(*bvh));
  return std::nullopt;
}

void Accel::next_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                             TraceContext& context, const uint32_t* keys) const {
  hits.reset(rays.size());
  const auto find = [&](const HitBatch& behind) {
    if (transparent_)
      bvh_next_transparent(geometry_, *transparent_, rays, behind, hits, context, keys);
    else
      try_all_transparent(rays, behind, hits, context, keys);
    std::fill_n(hits.instance.begin(), rays.size(), 0);
  };
  if (!instances_) return find(after);
  // Equally near hits on instances come after all that find() looks for.
  HitBatch behind = after;
  for (size_t i = 0; i < rays.size(); ++i)
    if (after.instance[i]) behind.primitive[i] = kNoPrimitive, behind.instance[i] = 0;
  find(behind);
  instances_->next_transparent(rays, after, hits, context, keys);
}

void Accel::closest_of_all(RayBatch& rays, HitBatch& hits, TraceContext& context) const {
  closest(rays, hits, context);
  if (!geometry_.any_transparent()) return;
  HitBatch after, clear;
  after.reset(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].found()) rays.tmax[i] = hits.t[i];
    after.set(i, {.t = 0, .primitive = 0});
  }
  next_transparent(rays, after, clear, context);
  for (size_t i = 0; i < rays.size(); ++i)
    if (clear[i].found()) hits.set(i, clear[i]);
}

void Accel::try_all_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                                TraceContext& context, const uint32_t* keys) const {
  for (size_t i = 0; i < rays.size() && !context.stopped(); ++i) {
    Hit next;
    for_each_transparent_hit(
        geometry_, rays[i], context, [&](PrimitiveKind kind, uint32_t index, const Hit& hit) {
          if (!comes_before(after[i], hit) || (next.found() && !comes_before(hit, next))) return;
          if (!keys || geometry_.stops(kind, index, keys[i])) next = hit;
        });
    hits.set(i, next);
  }
}

void Accel::transparent_depths(const RayBatch& rays, DepthBatch& depths,
                               TraceContext& context) const {
  if (transparent_)
    bvh_transparent_depths(geometry_, *transparent_, rays, depths, context);
  else
    sum_all_transparent(rays, depths, context);
  if (instances_) instances_->transparent_depths(rays, depths, context);
}

void Accel::sum_all_transparent(const RayBatch& rays, DepthBatch& depths,
                                TraceContext& context) const {
  for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
    if (!depths.is_stopped(i))
      for_each_transparent_hit(geometry_, rays[i], context,
                               [&](PrimitiveKind kind, uint32_t index, const Hit&) {
                                 depths.add(i, geometry_.depth_of(kind, index));
                               });
}

}  // namespace raio::core
