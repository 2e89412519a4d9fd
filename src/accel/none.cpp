#include "accel/intersect.h"
#include "accel/structures.h"

namespace raio::core {
namespace {

class None final : public Accel {
 public:
  None(Geometry geometry, bool counters) : Accel(std::move(geometry)), counters_(counters) {}

  void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
      hits.set(i, trace<false>(rays[i], context).best);
  }

  void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
      hit[i] = trace<true>(rays[i], context).best.found();
  }

  std::optional<TraceLog> log(const Ray& ray, bool any) const override {
    TraceLog log;
    bool done = false;
    for_each_kind([&]<PrimitiveKind kind> {
      for (uint32_t i = 0; i < geometry_.count(kind) && !done; ++i) {
        if (!geometry_.is_opaque(kind, i)) continue;
        RayQuery alone(ray);
        const bool hit = test<kind>(geometry_, i, alone);
        hit ? log.add_test(geometry_.id_of(kind, i)) : void(++log.unlisted);
        done = hit && any;
      }
    });
    judge_tests(log, geometry_, ray);
    return log;
  }

  AccelInfo describe() const override { return {.name = "none", .bytes = geometry_.bytes()}; }

 private:
  // Kind by kind, so that each loop runs one test over arrays. With `any`, up to the first hit.
  template <bool any>
  RayQuery trace(const Ray& ray, TraceContext& context) const {
    RayQuery query(ray);
    if (!(ray.tmax > 0)) return query;
    bool done = false;
    for_each_kind([&]<PrimitiveKind kind> { done = done || all_of<any, kind>(query, context); });
    return query;
  }

  template <bool any, PrimitiveKind kind>
  bool all_of(RayQuery& query, TraceContext& context) const {
    const uint32_t n = uint32_t(geometry_.count(kind));
    uint32_t i = 0;
    if (geometry_.all_opaque(kind)) {
      while (i < n && !(test<kind>(geometry_, i, query) && any)) ++i;
    } else {
      const auto opaque = [&](uint32_t k) { return geometry_.is_opaque(kind, k); };
      while (i < n && !(opaque(i) && test<kind>(geometry_, i, query) && any)) ++i;
    }
    if (counters_) context.tests += std::min(i + 1, n);
    return any && i < n;
  }

  bool counters_;
};

}  // namespace

std::unique_ptr<Accel> make_none(Geometry geometry, const AccelOptions& options) {
  return std::make_unique<None>(std::move(geometry), options.counters);
}

}  // namespace raio::core
