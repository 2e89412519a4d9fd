#include "accel/bvh/bvh.h"

#include <unordered_map>

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
  std::optional<TraceLog> log(const Ray& ray, bool any) const override {
    TraceLog log;
    TraceContext context{.log = &log};
    RayBatch one;
    one.push(ray);
    bvh_log(geometry_, bvh_, one, any, context);
    find_boxes(log);
    judge_tests(log, geometry_, ray);
    return log;
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
  // A parent, which has the boxes of its children, comes before them.
  void find_boxes(TraceLog& log) const {
    struct Place {
      int depth = 0;
      Box3f box;
    };
    std::unordered_map<uint32_t, Place> places;
    for (TraceLog::Step& step : log.steps) {
      Place& place = places[step.node];
      if (!step.leaf) {
        const BvhNode& node = bvh_.nodes[ref_index(step.node)];
        const auto box_of = [&](size_t c) {
          const auto& p = node.boxes.planes;
          return Box3f{{p[0][0][c], p[0][1][c], p[0][2][c]}, {p[1][0][c], p[1][1][c], p[1][2][c]}};
        };
        const int depth = place.depth;
        Box3f whole;
        for (size_t c = 0; c < kBlockWidth; ++c) {
          if (node.child[c] == kNoChild) continue;
          whole.extend(box_of(c));
          places[node.child[c]] = {depth + 1, box_of(c)};
        }
        if (depth == 0) step.box = whole;
      }
      const Place& known = places[step.node];
      step.depth = known.depth;
      if (step.depth > 0) step.box = known.box;
      step.node = ref_index(step.node);
    }
  }

  Bvh bvh_;
};

}  // namespace

AccelResult make_bvh(Geometry geometry) {
  auto bvh = build_bvh(geometry);
  if (!bvh) return std::unexpected(std::move(bvh.error()));
  return std::make_unique<BvhAccel>(std::move(geometry), std::move(*bvh));
}

}  // namespace raio
