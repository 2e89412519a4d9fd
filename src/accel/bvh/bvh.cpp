#include "accel/bvh/bvh.h"

#include <unordered_map>

#include "accel/structures.h"

namespace raio::core {
namespace {

class BvhAccel final : public Accel {
 public:
  BvhAccel(Geometry geometry, std::shared_ptr<const Bvh> bvh)
      : Accel(std::move(geometry)), shared_(std::move(bvh)), bvh_(*shared_) {}

  void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    bvh_closest(geometry_, bvh_, rays, hits, context);
  }
  void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
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
  void boxes(int level, const std::function<void(const AccelBox&)>& see) const override {
    if (!bvh_.empty()) (void)see_below(pool_ref(Pool::nodes, 0), whole(), 0, level, see);
  }
  AccelInfo describe() const override {
    size_t references = 0;
    if (geometry_.any_transparent())
      references = geometry_.list_opaque().size();
    else
      for_each_bounded_kind([&]<PrimitiveKind kind> { references += geometry_.count(kind); });
    return {.name = "bvh",
            .bytes = geometry_.bytes() + bvh_.bytes(),
            .cells = bvh_.nodes.size(),
            .references = references,
            .oversized = geometry_.count(PrimitiveKind::plane)};
  }
  const void* structure() const override { return &bvh_; }
  std::unique_ptr<Accel> share(Geometry& geometry) const override {
    return std::make_unique<BvhAccel>(std::move(geometry), shared_);
  }

 private:
  // The root's box, which no node stores.
  Box3f whole() const {
    const BvhNode& root = bvh_.nodes[0];
    Box3f box;
    for (size_t c = 0; c < kBlockWidth; ++c)
      if (root.child[c] != kNoChild) box.extend(root.boxes.box(c));
    return box;
  }

  // The number of primitives in this node or leaf.
  size_t see_below(uint32_t ref, const Box3f& box, int depth, int level,
                   const std::function<void(const AccelBox&)>& see) const {
    const bool leaf = ref_pool(ref) != Pool::nodes;
    size_t count = leaf ? bvh_.count_primitives(ref) : 0;
    if (!leaf) {
      const BvhNode& node = bvh_.nodes[ref_index(ref)];
      for (size_t c = 0; c < kBlockWidth; ++c)
        if (node.child[c] != kNoChild)
          count += see_below(node.child[c], node.boxes.box(c), depth + 1, level, see);
    }
    if (depth == level || (leaf && (level == kLeafBoxes || depth < level)))
      see({box, depth, count});
    return count;
  }

  // A parent, which has its children's boxes, comes first.
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
        const int depth = place.depth;
        for (size_t c = 0; c < kBlockWidth; ++c)
          if (node.child[c] != kNoChild) places[node.child[c]] = {depth + 1, node.boxes.box(c)};
        if (depth == 0) step.box = whole();
      }
      const Place& known = places[step.node];
      step.depth = known.depth;
      if (step.depth > 0) step.box = known.box;
      step.node = ref_index(step.node);
    }
  }

  std::shared_ptr<const Bvh> shared_;
  const Bvh& bvh_;
};

}  // namespace

AccelResult make_bvh(Geometry geometry) {
  auto bvh = build_bvh(geometry);
  if (!bvh) return std::unexpected(std::move(bvh.error()));
  return std::make_unique<BvhAccel>(std::move(geometry),
                                    std::make_shared<const Bvh>(std::move(*bvh)));
}

}  // namespace raio::core
