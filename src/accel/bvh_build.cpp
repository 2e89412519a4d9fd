// Top down by the surface area heuristic: a node's range is split in two, and the child of largest
// surface again, until there are eight. First the nodes are made, in parts, each by one task, and
// items brought into the order of the leaves; then all sizes are known, and the parts go to their
// places in the tree's pools, in parallel again. The tree is the same for any number of threads.
#include "accel/bvh_build.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/task_group.h>

#include <memory>
#include <optional>

#include "accel/bvh.h"
#include "accel/parallel.h"

namespace raio {
namespace {

constexpr size_t kTask = 4096;  // items worth a task
constexpr int kPools = 4;       // one for each Pool
// Above so many items the splits are found in haste. Measured: an eighth less time, and 2 % more
// tests a ray; small scenes, which are built in no time, would be rendered up to 5 % slower.
constexpr size_t kLarge = size_t(1) << 20;

bool is_leaf(BuildRange range) {  // in ascending order, so kinds do not mix between equal ends
  return range.size() <= size_t(kBlockWidth) &&
         item_kind(range.front().item()) == item_kind(range.back().item());
}

Pool leaf_pool(BuildRange range) { return pool_of(item_kind(range.front().item())); }

// Where kinds part a range: in the last splits, since leaves do not mix them; and at the root,
// where few of a kind are a leaf of their own, which rays meet early and are the shorter for. Else
// 0.
size_t part_kinds(BuildRange range, int depth) {
  constexpr size_t kFew = kBlockWidth;
  if (range.size() > kFew && depth > 0) return 0;
  const auto kind = [&](size_t i) { return item_kind(range[i].item()); };
  size_t first = 1, last = 1;
  while (first <= kFew && first < range.size() && kind(first) == kind(0)) ++first;
  if (first <= kFew) return first;
  const size_t n = range.size();
  while (last <= kFew && kind(n - 1 - last) == kind(n - 1)) ++last;
  return last <= kFew ? n - last : 0;
}

float half_area(const BuildBox& box) { return box.box().half_area(); }

// A child to be. Where a plan has its splits, `node` is its node there.
struct Child {
  BuildRange range;
  BuildBox box;
  const BuildPlan* plan = nullptr;
  uint32_t node = 0;

  Child() = default;
  Child(BuildRange r, const BuildBox& b) : range(r), box(b) {}
  Child(BuildRange all, const BuildPlan& p, uint32_t n)
      : range(all.subspan(p.nodes[n].begin, p.nodes[n].end - p.nodes[n].begin)),
        box(p.nodes[n].box),
        plan(p.nodes[n].below ? &p : nullptr),
        node(n) {}
};

// What one task makes: the nodes over a range, children named by their place in this part; or one
// node whose children are parts of their own.
struct Part {
  BuildRange items;
  std::vector<BvhNode> nodes;
  std::vector<uint8_t> leaf_sizes;                 // in the order of the items
  std::array<uint32_t, kPools> counts{}, begin{};  // in and before this part, per Pool
  std::vector<Part> parts;

  uint32_t add_leaf(BuildRange range) {
    const Pool pool = leaf_pool(range);
    leaf_sizes.push_back(uint8_t(range.size()));
    return pool_ref(pool, counts[size_t(pool)]++);
  }
  uint32_t moved(uint32_t ref) const { return ref == kNoChild ? ref : ref + begin[ref >> 30]; }
  uint32_t root() const {
    if (counts[0] > 0) return moved(pool_ref(Pool::nodes, 0));
    return moved(pool_ref(leaf_pool(items), 0));
  }
};

void fill_items(const Geometry& g, size_t first, BuildRange out) {
  const size_t spheres = g.count(ItemKind::sphere), triangles = g.count(ItemKind::triangle);
  for (size_t k = 0; k < out.size(); ++k) {
    size_t i = first + k;
    if (i < spheres) {
      const Sphere& s = g.scene().spheres[i];
      const Float4 center = {s.center.x, s.center.y, s.center.z, 0};
      const Float4 r = splat(std::abs(s.radius));
      BuildBox box{center - r, -center - r};
      // Away by an ulp or two, since the subtraction may have been rounded up by half an ulp.
      constexpr float kUlp = std::numeric_limits<float>::epsilon();
      box.lo -= abs(box.lo) * kUlp;
      box.minus_hi -= abs(box.minus_hi) * kUlp;
      out[k].set(box, item_id(ItemKind::sphere, uint32_t(i)));
    } else {
      i -= spheres;
      const ItemId id = i < triangles ? item_id(ItemKind::triangle, uint32_t(i))
                                      : item_id(ItemKind::cone, uint32_t(i - triangles));
      const Box3f box = g.bounds(id);
      const Float4 lo = {box.lo.x, box.lo.y, box.lo.z, 0};
      const Float4 hi = {box.hi.x, box.hi.y, box.hi.z, 0};
      out[k].set({lo, -hi}, id);
    }
  }
}

class Builder {
 public:
  explicit Builder(const Geometry& geometry) : g_(geometry) {}

  // The error, or nothing.
  std::optional<std::string> build(size_t available, Bvh& out) {
    size_t count = 0;
    for (const ItemKind kind : {ItemKind::sphere, ItemKind::triangle, ItemKind::cone})
      count += g_.count(kind);
    hasty_ = count > kLarge;
    if (count == 0) return std::nullopt;
    const double item_bytes = double(count * sizeof(BuildItem));
    if (auto error = refusal(item_bytes + least_bytes(), available)) return error;
    items_.resize(count);
    Child all;
    all.range = items_;
    BuildPlan plan;
    if (count > kPlanAbove) {
      plan = make_plan(items_, [&](size_t first, BuildRange some) { fill_items(g_, first, some); });
      all = Child(items_, plan, 0);
    } else {
      for_chunks(count, [&](size_t, size_t first, size_t end) {
        fill_items(g_, first, all.range.subspan(first, end - first));
      });
      all.box = box_of(items_);
    }
    Part root;
    make_part(all, 0, root, true);

    std::vector<Part*> parts;
    std::array<uint32_t, kPools> total{};
    place(root, parts, total);
    const double bytes =
        double(total[0]) * 2 * sizeof(BvhNode) + double(total[1]) * sizeof(SphereBlock) +
        double(total[2]) * sizeof(TriangleBlock) + double(total[3]) * sizeof(ConeBlock);
    if (auto error = refusal(item_bytes + bytes, available)) return error;
    out.nodes.resize(total[0]);
    out.spheres.resize(total[1]);
    out.triangles.resize(total[2]);
    out.cones.resize(total[3]);
    const auto fill = [&](size_t i) { fill_part(*parts[i], out); };
    if (parts.size() == 1)
      fill(0);
    else
      tbb::parallel_for(size_t(0), parts.size(), fill);
    const Box3f box = all.box.box();
    out.reach = max_component(max(abs(box.lo), abs(box.hi)));
    return std::nullopt;
  }

 private:
  // Of blocks that are all full.
  double least_bytes() const {
    return (double(g_.count(ItemKind::sphere)) * sizeof(SphereBlock) +
            double(g_.count(ItemKind::triangle)) * sizeof(TriangleBlock) +
            double(g_.count(ItemKind::cone)) * sizeof(ConeBlock)) /
           kBlockWidth;
  }
  static std::optional<std::string> refusal(double bytes, size_t available) {
    if (bytes <= 0.9 * double(available)) return std::nullopt;
    return fmt::format("a tree over the scene would take {:.1f} GB and {:.1f} GB are free",
                       bytes * 1e-9, double(available) * 1e-9);
  }

  // The range as a part of its own: with a node, be it needed or not, for the root.
  void make_part(const Child& child, int depth, Part& part, bool is_root = false) {
    part.items = child.range;
    if (child.range.size() > kTask) {
      make_parts(child, depth, part);
    } else if (!is_root && is_leaf(child.range)) {
      part.add_leaf(child.range);
    } else {
      make_node(child, depth, part, scratches_.local());
      part.counts[0] = uint32_t(part.nodes.size());
    }
  }

  // The node, and each child as a part of its own.
  void make_parts(const Child& child, int depth, Part& part) {
    std::vector<std::unique_ptr<BuildPlan>> plans;
    std::array<Child, kBlockWidth> children;
    const size_t count = open(child, depth, children, scratches_.local(), &plans);
    part.nodes.resize(1);
    part.counts[0] = 1;
    set_boxes(part.nodes[0], {children.data(), count});
    part.parts.resize(count);
    tbb::task_group tasks;
    for (size_t i = 0; i < count; ++i)
      tasks.run([&, i] { make_part(children[i], depth + 1, part.parts[i]); });
    tasks.wait();
  }

  uint32_t make_node(const Child& child, int depth, Part& part, Column<BuildItem>& scratch) {
    std::array<Child, kBlockWidth> children;
    const size_t count = open(child, depth, children, scratch, nullptr);
    const size_t index = part.nodes.size();
    part.nodes.emplace_back();
    set_boxes(part.nodes[index], {children.data(), count});
    for (size_t i = 0; i < count; ++i) {
      const uint32_t ref = is_leaf(children[i].range)
                               ? part.add_leaf(children[i].range)
                               : make_node(children[i], depth + 1, part, scratch);
      part.nodes[index].child[i] = ref;
    }
    return pool_ref(Pool::nodes, uint32_t(index));
  }

  static void set_boxes(BvhNode& node, std::span<const Child> children) {
    node.boxes.set_empty();
    std::fill(std::begin(node.child), std::end(node.child), kNoChild);
    for (size_t i = 0; i < children.size(); ++i) node.boxes.set(i, children[i].box.box());
  }

  // The children of a node, in the order of their items; how many there are.
  size_t open(const Child& child, int depth, std::array<Child, kBlockWidth>& out,
              Column<BuildItem>& scratch, std::vector<std::unique_ptr<BuildPlan>>* plans) const {
    std::array<float, kBlockWidth> areas;  // of those that can be opened
    const auto area = [](const Child& c) { return is_leaf(c.range) ? -1 : half_area(c.box); };
    out[0] = child;
    areas[0] = area(child);
    size_t count = 1;
    for (; count < size_t(kBlockWidth); ++count) {
      const size_t i =
          size_t(std::max_element(areas.begin(), areas.begin() + count) - areas.begin());
      if (areas[i] < 0) break;
      std::move_backward(out.begin() + i + 1, out.begin() + count, out.begin() + count + 1);
      std::move_backward(areas.begin() + i + 1, areas.begin() + count, areas.begin() + count + 1);
      split(Child(out[i]), depth, out[i], out[i + 1], scratch, plans);
      areas[i] = area(out[i]), areas[i + 1] = area(out[i + 1]);
    }
    return count;
  }

  void split(Child child, int depth, Child& below, Child& above, Column<BuildItem>& scratch,
             std::vector<std::unique_ptr<BuildPlan>>* plans) const {
    const BuildRange range = child.range;
    if (!child.plan && range.size() > kPlanAbove && depth + kPlanDepth <= kBvhCostLevels) {
      plans->push_back(std::make_unique<BuildPlan>(plan_again(range)));
      child = Child(range, *plans->back(), 0);
    }
    if (child.plan) {
      const BuildPlan::Node& node = child.plan->nodes[child.node];
      const BuildRange all(range.data() - node.begin, child.plan->nodes[0].end);
      below = Child(all, *child.plan, node.below);
      above = Child(all, *child.plan, node.above);
      return;
    }
    BuildSplit parts{.middle = part_kinds(range, depth)};
    if (parts.middle == 0 && depth < kBvhCostLevels) parts = split_by_cost(range, hasty_, scratch);
    if (parts.above.box().empty()) {
      if (parts.middle == 0) parts.middle = range.size() / 2;
      parts.below = box_of(range.first(parts.middle));
      parts.above = box_of(range.subspan(parts.middle));
    }
    below = Child(range.first(parts.middle), parts.below);
    above = Child(range.subspan(parts.middle), parts.above);
  }

  // A plan for items that another plan, or none, has already brought together.
  static BuildPlan plan_again(BuildRange range) {
    Column<BuildItem> copy(range.size());
    for_chunks(range.size(), [&](size_t, size_t first, size_t end) {
      std::copy(range.begin() + first, range.begin() + end, copy.begin() + first);
    });
    return make_plan(range, [&](size_t first, BuildRange out) {
      std::copy_n(copy.begin() + first, out.size(), out.begin());
    });
  }

  // Lists the parts in the order of their items, and finds their places in the pools.
  void place(Part& part, std::vector<Part*>& parts, std::array<uint32_t, kPools>& total) const {
    part.begin = total;
    for (int k = 0; k < kPools; ++k) total[k] += part.counts[k];
    parts.push_back(&part);
    for (Part& p : part.parts) place(p, parts, total);
  }

  void fill_part(Part& part, Bvh& out) const {
    for (size_t i = 0; i < part.nodes.size(); ++i) {
      BvhNode& node = out.nodes[part.begin[0] + i];
      node = part.nodes[i];
      for (uint32_t& child : node.child) child = part.moved(child);
    }
    for (size_t i = 0; i < part.parts.size(); ++i)
      out.nodes[part.begin[0]].child[i] = part.parts[i].root();
    part.nodes = {};
    std::array<uint32_t, kPools> next = part.begin;
    BuildRange rest = part.items;
    for (const uint8_t size : part.leaf_sizes) {
      const BuildRange range = rest.first(size);
      rest = rest.subspan(size);
      const Pool pool = leaf_pool(range);
      std::array<ItemId, kBlockWidth> ids;
      for (size_t i = 0; i < size; ++i) ids[i] = range[i].item();
      constexpr size_t kAhead = 32;
      if (rest.size() > kAhead + size)
        for (size_t i = 0; i < size; ++i) g_.prefetch(rest[kAhead + i].item());
      out.fill(g_, pool_ref(pool, next[size_t(pool)]++), {ids.data(), size});
    }
  }

  const Geometry& g_;
  bool hasty_ = false;
  Column<BuildItem> items_;
  tbb::enumerable_thread_specific<Column<BuildItem>> scratches_{[] { return Column<BuildItem>(); }};
};

}  // namespace

std::expected<Bvh, std::string> build_bvh(const Geometry& geometry, size_t available) {
  Bvh out;
  if (auto error = Builder(geometry).build(available, out)) return std::unexpected(*error);
  if (out.empty()) return out;
  constexpr int kFew = 4;  // measured
  for (const uint32_t ref : out.nodes[0].child)
    if (ref != kNoChild && ref_pool(ref) != Pool::nodes && out.items(ref)[kFew] == kNoItem)
      out.shared.push_back(ref);
  return out;
}

}  // namespace raio
