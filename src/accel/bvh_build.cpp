// Top down by the surface area heuristic over bins (Wald 2007, "On fast Construction of SAH-based
// Bounding Volume Hierarchies", IRT): a node's range is split, and the child of largest surface
// again, until there are eight. Large children are built in parallel, each into pools of its own
// that are then joined in order, so that the tree is the same for any number of threads.
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <span>

#include "accel/bvh.h"
#include "accel/structures.h"

namespace raio {
namespace {

constexpr int kBins = 16;
constexpr size_t kParallel = 8192;  // primitives worth a task

struct Primitive {
  Box3f box;
  ItemId item;

  float center2(int axis) const { return box.lo[axis] + box.hi[axis]; }
};
using Range = std::span<Primitive>;

bool one_kind(Range range) {
  return std::all_of(range.begin(), range.end(), [&](const Primitive& p) {
    return item_kind(p.item) == item_kind(range.front().item);
  });
}

// Each of the eight lanes of a block costs about the same as all eight.
float blocks(size_t count) { return float((count + kBvhWidth - 1) / kBvhWidth); }

struct Split {
  int axis = -1;
  int bin = 0;
};

// Bins over the centres of a range, all three axes at once.
struct Bins {
  Vec3f lo, scale;
  Box3f boxes[3][kBins];
  size_t counts[3][kBins] = {};

  explicit Bins(const Box3f& centers) : lo(centers.lo) {
    // An axis on which all centres are one, or too near to divide, has no bins.
    for (int a = 0; a < 3; ++a) {
      scale[a] = kBins * (1 - 1e-6f) / centers.size()[a];
      if (!std::isfinite(scale[a])) scale[a] = 0;
    }
  }
  int bin_of(const Primitive& p, int axis) const {
    return std::clamp(int((p.center2(axis) - lo[axis]) * scale[axis]), 0, kBins - 1);
  }
  void add(const Primitive& p) {
    for (int a = 0; a < 3; ++a) {
      const int b = bin_of(p, a);
      boxes[a][b].extend(p.box);
      ++counts[a][b];
    }
  }
  void add(const Bins& other) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < kBins; ++b) {
        boxes[a][b].extend(other.boxes[a][b]);
        counts[a][b] += other.counts[a][b];
      }
  }

  // The best of all splits between bins of all axes; axis -1 when there is none.
  Split best(size_t total) const {
    Split out;
    float best_cost = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      float above_cost[kBins];
      Box3f box;
      size_t count = 0;
      for (int b = kBins - 1; b > 0; --b) {
        box.extend(boxes[axis][b]);
        count += counts[axis][b];
        above_cost[b] = box.half_area() * blocks(count);
      }
      box = {}, count = 0;
      for (int b = 1; b < kBins; ++b) {
        box.extend(boxes[axis][b - 1]);
        count += counts[axis][b - 1];
        const float cost = box.half_area() * blocks(count) + above_cost[b];
        if (count > 0 && count < total && cost < best_cost) best_cost = cost, out = {axis, b};
      }
    }
    return out;
  }
};

// Folds the range into copies of `zero`, in parallel where that pays. Boxes and counts join in any
// order to the same result.
template <class T, class Add, class Join>
T fold(Range range, const T& zero, Add&& add, Join&& join) {
  const auto part = [&](const tbb::blocked_range<size_t>& r, T sum) {
    for (size_t i = r.begin(); i < r.end(); ++i) add(sum, range[i]);
    return sum;
  };
  const tbb::blocked_range<size_t> all(0, range.size(), kParallel);
  if (range.size() <= 2 * kParallel) return part(all, zero);
  return tbb::parallel_reduce(all, zero, part, [&](T x, const T& y) { return join(x, y), x; });
}

// Reorders the range and says where its second part begins.
size_t partition(Range range, int depth) {
  if (range.size() <= size_t(kBvhWidth)) {  // of several kinds, which leaves do not mix
    const ItemKind first = item_kind(range.front().item);
    const auto middle = std::stable_partition(
        range.begin(), range.end(), [&](const Primitive& p) { return item_kind(p.item) == first; });
    return size_t(middle - range.begin());
  }
  if (depth >= kBvhCostLevels) return range.size() / 2;
  const Box3f centers = fold(
      range, Box3f(),
      [](Box3f& box, const Primitive& p) {
        box.extend({p.center2(0), p.center2(1), p.center2(2)});
      },
      [](Box3f& x, const Box3f& y) { x.extend(y); });
  const Bins bins = fold(
      range, Bins(centers), [](Bins& b, const Primitive& p) { b.add(p); },
      [](Bins& x, const Bins& y) { x.add(y); });
  const Split split = bins.best(range.size());
  if (split.axis < 0) return range.size() / 2;
  const auto middle = std::partition(range.begin(), range.end(), [&](const Primitive& p) {
    return bins.bin_of(p, split.axis) < split.bin;
  });
  return size_t(middle - range.begin());
}

Box3f box_of(Range range) {
  return fold(
      range, Box3f(), [](Box3f& box, const Primitive& p) { box.extend(p.box); },
      [](Box3f& x, const Box3f& y) { x.extend(y); });
}

class Builder {
 public:
  explicit Builder(const Geometry& geometry) : g_(geometry) {}

  Bvh out;

  // The range as a child of a node: a leaf, or a node with all below it.
  uint32_t build(Range range, int depth) {
    if (range.size() <= size_t(kBvhWidth) && one_kind(range)) return make_leaf(range);
    return make_node(range, depth);
  }

  uint32_t make_node(Range range, int depth) {
    struct Child {
      Range range;
      Box3f box;
      bool is_leaf;
    };
    const auto child_of = [](Range r) {
      return Child{r, box_of(r), r.size() <= size_t(kBvhWidth) && one_kind(r)};
    };
    std::vector<Child> children = {child_of(range)};
    while (children.size() < size_t(kBvhWidth)) {
      Child* widest = nullptr;
      for (Child& c : children)
        if (!c.is_leaf && (!widest || c.box.half_area() > widest->box.half_area())) widest = &c;
      if (!widest) break;
      const Range all = widest->range;
      const size_t middle = partition(all, depth);
      *widest = child_of(all.first(middle));
      children.push_back(child_of(all.subspan(middle)));
    }
    const uint32_t index = uint32_t(out.nodes.size());
    out.nodes.emplace_back();
    std::fill(std::begin(out.nodes[index].child), std::end(out.nodes[index].child), kNoChild);
    uint32_t refs[kBvhWidth];
    if (range.size() > kParallel) {
      build_parallel(children, depth, refs);
    } else {
      for (size_t i = 0; i < children.size(); ++i) refs[i] = build(children[i].range, depth + 1);
    }
    BvhNode& node = out.nodes[index];
    for (size_t i = 0; i < children.size(); ++i) {
      node.boxes.set(i, children[i].box);
      node.child[i] = refs[i];
    }
    return bvh_ref(BvhChild::node, index);
  }

 private:
  template <class Children>
  void build_parallel(const Children& children, int depth, uint32_t* refs) {
    std::vector<Builder> parts(children.size(), Builder(g_));
    tbb::task_group tasks;
    for (size_t i = 0; i < children.size(); ++i)
      tasks.run([&, i] { refs[i] = parts[i].build(children[i].range, depth + 1); });
    tasks.wait();
    for (size_t i = 0; i < children.size(); ++i) refs[i] = append(parts[i].out, refs[i]);
  }

  // Takes over the pools of `part`; the new name of its child `ref`.
  uint32_t append(const Bvh& part, uint32_t ref) {
    const uint32_t base[4] = {uint32_t(out.nodes.size()), uint32_t(out.spheres.size()),
                              uint32_t(out.triangles.size()), uint32_t(out.cones.size())};
    const auto moved = [&](uint32_t r) { return r == kNoChild ? r : r + base[r >> 30]; };
    for (BvhNode node : part.nodes) {
      for (uint32_t& child : node.child) child = moved(child);
      out.nodes.push_back(node);
    }
    const auto join = [](auto& to, const auto& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    join(out.spheres, part.spheres);
    join(out.triangles, part.triangles);
    join(out.cones, part.cones);
    return moved(ref);
  }

  uint32_t make_leaf(Range range) {
    std::sort(range.begin(), range.end(),
              [](const Primitive& a, const Primitive& b) { return a.item < b.item; });
    switch (item_kind(range.front().item)) {
      case ItemKind::sphere:
        return make_spheres(range);
      case ItemKind::triangle:
        return make_triangles(range);
      default:
        return make_cones(range);
    }
  }

  uint32_t make_spheres(Range range) {
    SphereBlock block{};
    std::fill(std::begin(block.radius), std::end(block.radius),
              std::numeric_limits<float>::quiet_NaN());
    std::fill(std::begin(block.item), std::end(block.item), kNoItem);
    for (size_t i = 0; i < range.size(); ++i) {
      const Sphere s = g_.sphere(item_index(range[i].item));
      block.x[i] = s.center.x, block.y[i] = s.center.y, block.z[i] = s.center.z;
      block.radius[i] = s.radius;
      block.item[i] = range[i].item;
    }
    out.spheres.push_back(block);
    return bvh_ref(BvhChild::spheres, uint32_t(out.spheres.size() - 1));
  }

  uint32_t make_triangles(Range range) {
    TriangleBlock block{};  // three equal corners have no area
    std::fill(std::begin(block.item), std::end(block.item), kNoItem);
    for (size_t i = 0; i < range.size(); ++i) {
      const Triangle t = g_.triangle(item_index(range[i].item));
      for (int a = 0; a < 3; ++a) {
        block.corner[0][a][i] = t.a[a];
        block.corner[1][a][i] = t.b[a];
        block.corner[2][a][i] = t.c[a];
      }
      block.item[i] = range[i].item;
    }
    out.triangles.push_back(block);
    return bvh_ref(BvhChild::triangles, uint32_t(out.triangles.size() - 1));
  }

  uint32_t make_cones(Range range) {
    ConeBlock block{};
    std::fill(std::begin(block.item), std::end(block.item), kNoItem);
    for (size_t i = 0; i < range.size(); ++i) {
      const BakedCone& c = g_.cone(item_index(range[i].item));
      block.boxes.set(i, range[i].box);
      for (int a = 0; a < 3; ++a) block.base[a][i] = c.base[a], block.axis[a][i] = c.axis[a];
      block.height[i] = c.height, block.radius[i] = c.base_radius, block.slope[i] = c.slope;
      block.item[i] = range[i].item;
    }
    out.cones.push_back(block);
    return bvh_ref(BvhChild::cones, uint32_t(out.cones.size() - 1));
  }

  const Geometry& g_;
};

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
    for (const ItemKind kind : {ItemKind::sphere, ItemKind::triangle, ItemKind::cone})
      references += geometry_.count(kind);
    return {.name = "bvh",
            .bytes = geometry_.bytes() + bvh_.bytes(),
            .cells = bvh_.nodes.size(),
            .references = references,
            .giants = geometry_.count(ItemKind::plane)};
  }

 private:
  Bvh bvh_;
};

}  // namespace

size_t Bvh::bytes() const {
  return nodes.size() * sizeof(BvhNode) + spheres.size() * sizeof(SphereBlock) +
         triangles.size() * sizeof(TriangleBlock) + cones.size() * sizeof(ConeBlock);
}

Bvh build_bvh(const Geometry& geometry) {
  std::vector<Primitive> primitives;
  for (const ItemKind kind : {ItemKind::sphere, ItemKind::triangle, ItemKind::cone})
    for (uint32_t i = 0; i < geometry.count(kind); ++i)
      primitives.push_back({{}, item_id(kind, i)});
  if (primitives.empty()) return {};
  tbb::parallel_for(size_t(0), primitives.size(),
                    [&](size_t i) { primitives[i].box = geometry.bounds(primitives[i].item); });
  const Box3f all = box_of(primitives);
  Builder builder(geometry);
  builder.make_node(primitives, 0);
  builder.out.reach = max_component(max(abs(all.lo), abs(all.hi)));
  return std::move(builder.out);
}

std::unique_ptr<Accel> make_bvh(Geometry geometry) {
  Bvh bvh = build_bvh(geometry);
  return std::make_unique<BvhAccel>(std::move(geometry), std::move(bvh));
}

}  // namespace raio
