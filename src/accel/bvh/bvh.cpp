#include "accel/bvh/bvh.h"

#include "accel/structures.h"

namespace raio {
namespace {

class BvhAccel final : public Accel {
 public:
  BvhAccel(Geometry geometry, Bvh bvh) : Accel(std::move(geometry)), bvh_(std::move(bvh)) {}

  void closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    bvh_closest(geometry_, bvh_, rays, hits, context);
  }
  void occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    bvh_occluded(geometry_, bvh_, rays, hit, context);
  }
  AccelInfo info() const override {
    size_t references = 0;
    for_each_bounded_kind([&]<PrimitiveKind kind> { references += geometry_.count(kind); });
    return {.name = "bvh",
            .bytes = geometry_.bytes() + bvh_.bytes(),
            .cells = bvh_.nodes.size(),
            .references = references,
            .giants = geometry_.count(PrimitiveKind::plane)};
  }

 private:
  Bvh bvh_;
};

}  // namespace

AccelResult make_bvh(Geometry geometry) {
  auto bvh = build_bvh(geometry);
  if (!bvh) return std::unexpected(std::move(bvh.error()));
  return std::make_unique<BvhAccel>(std::move(geometry), std::move(*bvh));
}

}  // namespace raio
