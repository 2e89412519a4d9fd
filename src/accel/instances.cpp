#include "accel/instances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "accel/structures.h"
#include "base/executor.h"

namespace raio::core {
namespace {

// The rounding error of rays that enter an object's space, relative to their coordinates or
// distances.
constexpr double kSlack = 2e-6;

double largest(Vec3f v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Rays in the space of an object.
struct Moved {
  RayBatch rays;
  HitBatch after, hits;
  std::vector<double> stretch;
  DepthBatch depths;
  std::vector<uint32_t> from, keys;
};

}  // namespace

std::expected<std::unique_ptr<const Instances>, Error> Instances::build(const Accel& around,
                                                                        const AccelOptions& options,
                                                                        bool one_sided,
                                                                        bool with_sources,
                                                                        const Accel* like) {
  std::unique_ptr<Instances> out(new Instances(around));
  for (const Object& object : out->geometry_.object().prototypes) {
    auto accel = build_object(out->geometry_.scene(), object, options, one_sided, with_sources,
                              like ? like->prototype(out->objects_.size()) : nullptr);
    if (!accel) return std::unexpected(std::move(accel.error()));
    out->objects_.push_back(std::move(*accel));
  }
  if (options.kind != AccelKind::none) out->build_tree();
  return out;
}

std::vector<const Geometry*> Instances::objects() const {
  std::vector<const Geometry*> out;
  out.reserve(objects_.size());
  for (const auto& object : objects_) out.push_back(&object->geometry());
  return out;
}

void Instances::add_to(AccelInfo& info) const {
  info.instances = instances_.size();
  info.bytes += nodes_.size() * sizeof(Node);
  for (const auto& object : objects_) {
    const AccelInfo of_one = object->info();
    info.bytes += of_one.bytes, info.references += of_one.references;
    info.cells += of_one.cells;
  }
}

void Instances::build_tree() {
  std::vector<Box3f> of_object, boxes;
  for (const auto& object : objects_) of_object.push_back(bounds(object->geometry().object()));
  std::vector<uint32_t> some;
  boxes.reserve(instances_.size());
  StopCheck look;
  for (const Instance& instance : instances_) {
    look();
    const Placement place(instance.matrix);
    const Box3f& box = boxes.emplace_back(rounded_out(place.box(of_object[instance.prototype])));
    if (box.empty()) continue;
    some.push_back(uint32_t(boxes.size() - 1));
    slack_ = std::max(slack_, kSlack * place.condition());
  }
  // Widens boxes by the rounding of rays that enter the object's space.
  for (const uint32_t i : some) {
    look();
    boxes[i].pad(float(slack_ * std::max(largest(boxes[i].lo), largest(boxes[i].hi))));
  }
  if (some.empty()) return;
  nodes_.reserve(2 * some.size());
  nodes_.emplace_back();
  split(0, some, boxes);
}

// Splits at the median along the longest side of the box of the centres: the depth is logarithmic
// in the number of instances, wherever they are.
void Instances::split(uint32_t node, std::span<uint32_t> instances,
                      const std::vector<Box3f>& boxes) {
  Box3f around, middles;
  StopCheck look;
  for (const uint32_t i : instances)
    around.extend(boxes[i]), middles.extend(boxes[i].center()), look();
  if (instances.size() == 1) {
    nodes_[node] = {around, instances[0], kLeaf};
    return;
  }
  const Vec3f size = middles.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto half = std::ptrdiff_t(instances.size() / 2);
  std::ranges::nth_element(instances, instances.begin() + half, [&](uint32_t a, uint32_t b) {
    look();
    const float x = boxes[a].center()[axis], y = boxes[b].center()[axis];
    return x < y || (x == y && a < b);
  });
  const auto children = uint32_t(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node] = {around, children, uint8_t(axis)};
  split(children, instances.first(size_t(half)), boxes);
  split(children + 1, instances.subspan(size_t(half)), boxes);
}

// All rays of a batch descend the tree together: each node passes on those that hit its box, the
// nearer child first, as seen from the first ray.
class Instances::Traversal {
 public:
  Traversal(const Instances& in, const RayBatch& rays, TraceContext& context)
      : in_(in), rays_(rays), context_(context) {}

  // Calls visit(instance, rays) for the instances that rays may hit; limit(i) is the remaining
  // length of ray i; not positive: none.
  template <class Limit, class Visit>
  void run(const Limit& limit, const Visit& visit) {
    for (uint32_t i = 0; i < rays_.size(); ++i)
      if (limit(i) > 0) lists_.push_back(i);
    if (in_.nodes_.empty()) {
      const std::vector<uint32_t> all = lists_;
      for (uint32_t i = 0; i < in_.instances_.size() && !context_.stopped(); ++i)
        visit(i, std::span<const uint32_t>(all));
      return;
    }
    slabs_.resize(rays_.size());
    for (const uint32_t i : lists_) {
      const Ray ray = rays_[i];
      const auto slack = float(in_.slack_ * largest(ray.origin));
      for (int a = 0; a < 3; ++a)
        slabs_[i].axes[a] = {ray.origin[a] + slack, ray.origin[a] - slack, 1 / ray.dir[a]};
    }
    enter(0, 0, lists_.size(), limit, visit);
  }

 private:
  template <class Limit, class Visit>
  void enter(uint32_t number, size_t begin, size_t end, const Limit& limit, const Visit& visit) {
    if (context_.stopped()) return;
    const Node& node = in_.nodes_[number];
    context_.steps += end - begin;
    for (size_t k = begin; k < end; ++k)
      if (const uint32_t i = lists_[k]; meets(node.box, i, limit(i))) lists_.push_back(i);
    const size_t last = lists_.size();
    if (last > end) {
      if (node.axis == kLeaf) {
        some_.assign(lists_.begin() + std::ptrdiff_t(end), lists_.end());
        visit(node.first, std::span<const uint32_t>(some_));
      } else {
        const uint32_t far = rays_[lists_[end]].dir[node.axis] < 0 ? 0 : 1;
        enter(node.first + 1 - far, end, last, limit, visit);
        enter(node.first + far, end, last, limit, visit);
      }
    }
    lists_.resize(end);
  }

  bool meets(const Box3f& box, uint32_t i, float limit) const {
    if (!(limit > 0)) return false;
    float begin = 0, last = limit;
    for (int a = 0; a < 3; ++a) {
      const Slab& slab = slabs_[i].axes[a];
      const float x = (box.lo[a] - slab.above) * slab.inverse;
      const float y = (box.hi[a] - slab.below) * slab.inverse;
      const float enters = x < y ? x : y, leaves = x < y ? y : x;
      begin = std::max(begin, enters);
      last = std::min(last, leaves);
    }
    return begin <= last * float(1 + kSlack);
  }

  // For an axis: the ray's origin with slack to both sides, and 1 over its direction.
  struct Slab {
    float above, below, inverse;
  };
  struct Slabs {
    Slab axes[3];
  };

  const Instances& in_;
  const RayBatch& rays_;
  TraceContext& context_;
  std::vector<Slabs> slabs_;
  std::vector<uint32_t> lists_;  // of the nodes on the way down, concatenated
  std::vector<uint32_t> some_;
};

void Instances::closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const {
  Moved moved;
  const auto limit = [&](uint32_t i) { return hits[i].found() ? hits.t[i] : rays.tmax[i]; };
  Traversal(*this, rays, context)
      .run(limit, [&](uint32_t instance, std::span<const uint32_t> some) {
        const Placement place = geometry_.placement(instance);
        moved.rays.resize(some.size()), moved.stretch.resize(some.size());
        for (size_t k = 0; k < some.size(); ++k) {
          Ray ray = rays[some[k]];
          ray.tmax = limit(some[k]);
          moved.rays.set(k, place.to_object(ray, moved.stretch[k], kSlack));
        }
        objects_[instances_[instance].prototype]->closest(moved.rays, moved.hits, context);
        for (size_t k = 0; k < some.size(); ++k) {
          Hit hit = moved.hits[k];
          if (!hit.found()) continue;
          const uint32_t i = some[k];
          hit.t = float(double(hit.t) / moved.stretch[k]);
          hit.instance = geometry_.instance_id(instance, hit.instance);
          const Hit best = hits[i];
          if (best.found() ? comes_before(hit, best) : hit.t < rays.tmax[i]) hits.set(i, hit);
        }
      });
}

void Instances::occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const {
  Moved moved;
  const auto limit = [&](uint32_t i) { return hit[i] ? 0.0f : rays.tmax[i]; };
  std::vector<uint8_t> found;
  Traversal(*this, rays, context)
      .run(limit, [&](uint32_t instance, std::span<const uint32_t> some) {
        const Placement place = geometry_.placement(instance);
        moved.rays.resize(some.size()), found.resize(padded(some.size()));
        for (size_t k = 0; k < some.size(); ++k) {
          double stretch = 0;
          Ray ray = rays[some[k]];
          ray.tmax = limit(some[k]);
          moved.rays.set(k, place.to_object(ray, stretch));
        }
        objects_[instances_[instance].prototype]->occluded(moved.rays, found.data(), context);
        for (size_t k = 0; k < some.size(); ++k) hit[some[k]] |= found[k];
      });
}

// By rounding, a hit found in an object may lie before `after` outside it; then the search
// continues in the object. Each instance has its own key.
void Instances::next_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                                 TraceContext& context, const uint32_t* keys) const {
  Moved moved;
  const auto limit = [&](uint32_t i) { return hits[i].found() ? hits.t[i] : rays.tmax[i]; };
  Traversal(*this, rays, context)
      .run(limit, [&](uint32_t instance, std::span<const uint32_t> some) {
        const Accel& object = *objects_[instances_[instance].prototype];
        if (!object.geometry().any_transparent()) return;
        const Placement place = geometry_.placement(instance);
        size_t n = some.size();
        moved.rays.resize(n), moved.after.reset(n), moved.stretch.resize(n);
        moved.from.assign(some.begin(), some.end());
        moved.keys.resize(keys ? n : 0);
        for (size_t k = 0; k < n; ++k) {
          Ray ray = rays[some[k]];
          ray.tmax = limit(some[k]);
          double& stretch = moved.stretch[k];
          moved.rays.set(k, place.to_object(ray, stretch, kSlack));
          const double t = double(after.t[some[k]]) * stretch * (1 - kSlack);
          moved.after.set(k, {.t = float(t), .primitive = 0});
          if (keys) moved.keys[k] = hash_of(keys[some[k]], instance);
        }
        while (n > 0 && !context.stopped()) {
          object.next_transparent(moved.rays, moved.after, moved.hits, context,
                                  keys ? moved.keys.data() : nullptr);
          size_t kept = 0;
          for (size_t k = 0; k < n; ++k) {
            const Hit there = moved.hits[k];
            if (!there.found()) continue;
            const uint32_t i = moved.from[k];
            Hit hit = there;
            hit.t = float(double(hit.t) / moved.stretch[k]);
            hit.instance = geometry_.instance_id(instance, hit.instance);
            if (comes_before(after[i], hit)) {
              const Hit best = hits[i];
              if (best.found() ? comes_before(hit, best) : hit.t < rays.tmax[i]) hits.set(i, hit);
              // A hit farther away in the object may round to the same distance outside, where a
              // lower id comes first.
              if (hit.t > hits.t[i]) continue;
              moved.rays.tmax[k] =
                  std::min(moved.rays.tmax[k], float(double(there.t) * (1 + kSlack)));
            }
            moved.rays.set(kept, moved.rays[k]), moved.after.set(kept, there);
            moved.stretch[kept] = moved.stretch[k], moved.from[kept] = i;
            if (keys) moved.keys[kept] = moved.keys[k];
            ++kept;
          }
          n = kept;
          moved.rays.resize(n);
        }
      });
}

void Instances::transparent_depths(const RayBatch& rays, DepthBatch& depths,
                                   TraceContext& context) const {
  Moved moved;
  const auto limit = [&](uint32_t i) { return depths.is_stopped(i) ? 0.0f : rays.tmax[i]; };
  Traversal(*this, rays, context)
      .run(limit, [&](uint32_t instance, std::span<const uint32_t> some) {
        const Accel& object = *objects_[instances_[instance].prototype];
        if (!object.geometry().any_transparent()) return;
        const Placement place = geometry_.placement(instance);
        moved.rays.resize(some.size()), moved.depths.reset(some.size());
        for (size_t k = 0; k < some.size(); ++k) {
          double stretch = 0;
          moved.rays.set(k, place.to_object(rays[some[k]], stretch));
          moved.depths.take(k, depths, some[k]);
        }
        object.transparent_depths(moved.rays, moved.depths, context);
        for (size_t k = 0; k < some.size(); ++k) depths.take(some[k], moved.depths, k);
      });
}

}  // namespace raio::core
