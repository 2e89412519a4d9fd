// Builds top down by the surface area heuristic: a node's range is split in two, then the child
// with the largest surface area, until there are eight. Tasks first make nodes in parts and sort
// ids in the order of the leaves; boxes exist only for the items of running tasks. Then all sizes
// are known, and the parts are copied in parallel to their places in the tree's pools. The tree
// does not depend on the number of threads.
#include "accel/bvh/build.h"

#include <fmt/core.h>

#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "accel/bvh/bvh.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

constexpr size_t kTask = 4096;  // the minimum number of items for a task
// Above this many items, splits are found in fast mode. Measured: an eighth less time and 2 % more
// tests per ray; small scenes, built in no time, would render up to 5 % slower.
constexpr size_t kLarge = size_t(1) << 20;

// A future child: items begin .. end - 1 of the builder's order.
struct Child {
  size_t begin = 0, end = 0;
  BuildBox box;
  BuildItem* items = nullptr;       // null until they are made
  const BuildPlan* plan = nullptr;  // has the splits, from its node `node`
  uint32_t node = 0;

  size_t size() const { return end - begin; }
  BuildRange range() const { return {items, size()}; }
};

// The result of one task: the nodes over a range, with children as indices in this part; or one
// node with children that are parts themselves.
struct Part {
  size_t first = 0;  // of its items
  std::vector<BvhNode> nodes;
  std::vector<uint8_t> leaf_sizes;                 // in the order of the items
  std::array<uint32_t, kPools> counts{}, begin{};  // in and before this part, per Pool
  std::vector<Part> parts;

  uint32_t moved(uint32_t ref) const {
    return ref == kNoChild ? ref : ref + begin[size_t(ref_pool(ref))];
  }
  // Its first node, or else its only leaf.
  uint32_t root() const {
    size_t pool = 0;
    while (counts[pool] == 0) ++pool;
    return moved(pool_ref(Pool(pool), 0));
  }
};

// Unused columns, kept for reuse.
class SpareItems {
 public:
  Column<BuildItem> take() {
    const std::lock_guard lock(mutex_);
    if (spare_.empty()) {
      spare_.reserve(++made_);  // so that returning one cannot fail
      return {};
    }
    Column<BuildItem> items = std::move(spare_.back());
    spare_.pop_back();
    return items;
  }
  void give_back(Column<BuildItem> items) {
    const std::lock_guard lock(mutex_);
    spare_.push_back(std::move(items));
  }

 private:
  std::mutex mutex_;
  std::vector<Column<BuildItem>> spare_;
  size_t made_ = 0;
};

// Referenced by the children of some nodes.
struct Arena {
  explicit Arena(SpareItems& s) : spare(s) {}
  ~Arena() {
    for (Column<BuildItem>& some : items) spare.give_back(std::move(some));
  }
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  SpareItems& spare;
  std::vector<Column<BuildItem>> items;
  std::vector<std::unique_ptr<BuildPlan>> plans;
};

class Builder {
 public:
  // `some`: the primitives of the tree; null: all.
  Builder(const Geometry& geometry, const Column<PrimitiveId>* some) : g_(geometry), some_(some) {}

  // Returns the error, or nothing.
  std::optional<std::string> build(const AvailableMemory& available, Bvh& out) {
    size_t bounded = 0;
    for_each_bounded_kind([&]<PrimitiveKind kind> { bounded += g_.count(kind); });
    const size_t count = some_ ? some_->size() : bounded;
    hasty_ = count > kLarge;
    if (count == 0) return std::nullopt;
    const double order_bytes = double(count) * 2 * sizeof(PrimitiveId);  // twice while they move
    if (auto error = refusal(order_bytes + least_bytes(), available)) return error;
    order_.resize(count);
    // Planes, which are in no tree, have the lowest ids.
    const PrimitiveId first = PrimitiveId(g_.count(PrimitiveKind::plane));
    const auto nth = [&](size_t i) { return some_ ? (*some_)[i] : first + PrimitiveId(i); };
    Child all{0, count, {}};
    Arena arena(spare_);
    if (count > kPlanAbove) {
      plan(all, nth, arena);
    } else {
      make_items(all, nth, arena);
      all.box = box_of(all.range());
    }
    Part root;
    make_part(all, 0, root, true);

    std::vector<Part*> parts;
    std::array<uint32_t, kPools> total{};
    place(root, parts, total);
    if (std::ranges::max(total) > kMaxInPool)
      return fmt::format("a tree over the scene would have more than {} nodes or leaves of a kind",
                         kMaxInPool);
    const double bytes = double(total[0]) * 2 * sizeof(BvhNode) + Blocks::bytes_of(total);
    if (auto error = refusal(order_bytes + bytes, available)) return error;
    out.nodes.resize(total[0]);
    out.resize(total);
    const auto fill = [&](size_t i) { fill_part(*parts[i], out); };
    if (parts.size() == 1)
      fill(0);
    else
      parallel_for(parts.size(), fill);
    const Box3f box = all.box.box();
    out.reach = max_component(max(abs(box.lo), abs(box.hi)));
    return std::nullopt;
  }

 private:
  // If all blocks are full.
  double least_bytes() const {
    if (some_) return double(some_->size()) * sizeof(SphereBlock) / kBlockWidth;
    double bytes = 0;
    for_each_bounded_kind(
        [&]<PrimitiveKind kind> { bytes += double(g_.count(kind)) * sizeof(Block<kind>); });
    return bytes / kBlockWidth;
  }
  static std::optional<std::string> refusal(double bytes, const AvailableMemory& available) {
    if (bytes <= 0.9 * double(available.bytes)) return std::nullopt;
    return fmt::format("a tree over the scene would take {:.1f} GB and {}", bytes * 1e-9,
                       available.text());
  }

  PrimitiveId id(const Child& c, size_t i) const {
    return c.items ? c.items[i].id() : order_[c.begin + i];
  }

  auto ids_of(const Child& child) const {
    return [ids = &order_[child.begin]](size_t i) { return ids[i]; };
  }

  // In ascending order, so kinds do not mix between equal ends.
  bool is_leaf(const Child& c) const {
    return c.size() <= size_t(kBlockWidth) &&
           g_.kind_of(id(c, 0)) == g_.kind_of(id(c, c.size() - 1));
  }

  // Makes the range a part, with a node even if not needed, for the root.
  void make_part(Child child, int depth, Part& part, bool is_root = false) {
    part.first = child.begin;
    if (child.size() > kTask) return make_parts(child, depth, part);
    Arena arena(spare_);
    if (!child.items) make_items(child, ids_of(child), arena);
    if (!is_root && is_leaf(child)) {
      add_leaf(child, part);
    } else {
      part.nodes.reserve(child.size() / 24);
      make_node(child, depth, part, scratches_.local());
      part.counts[0] = uint32_t(part.nodes.size());
    }
    add_work(child.size());
  }

  // Makes the node, and each child as a part.
  void make_parts(const Child& child, int depth, Part& part) {
    Arena arena(spare_);
    std::array<Child, kBlockWidth> children;
    const size_t count = open(child, depth, children, scratches_.local(), &arena);
    part.nodes.resize(1);
    part.counts[0] = 1;
    set_boxes(part.nodes[0], {children.data(), count});
    part.parts.resize(count);
    TaskGroup tasks;
    for (size_t i = 0; i < count; ++i)
      tasks.run([&, i] { make_part(children[i], depth + 1, part.parts[i]); });
    tasks.wait();
  }

  uint32_t add_leaf(const Child& child, Part& part) {
    for (size_t i = 0; i < child.size(); ++i) order_[child.begin + i] = child.items[i].id();
    const Pool pool = pool_of(g_.kind_of(order_[child.begin]));
    part.leaf_sizes.push_back(uint8_t(child.size()));
    return pool_ref(pool, part.counts[size_t(pool)]++);
  }

  uint32_t make_node(const Child& child, int depth, Part& part, Column<BuildItem>& scratch) {
    std::array<Child, kBlockWidth> children;
    const size_t count = open(child, depth, children, scratch, nullptr);
    const size_t index = part.nodes.size();
    part.nodes.emplace_back();
    set_boxes(part.nodes[index], {children.data(), count});
    for (size_t i = 0; i < count; ++i) {
      const uint32_t ref = is_leaf(children[i]) ? add_leaf(children[i], part)
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

  // Finds the children of a node, in the order of their items, and returns their number. Without
  // `arena` the child has its items.
  size_t open(const Child& child, int depth, std::array<Child, kBlockWidth>& out,
              Column<BuildItem>& scratch, Arena* arena) {
    std::array<float, kBlockWidth> areas;  // half the surface area; -1 for leaves
    const auto area = [&](const Child& c) { return is_leaf(c) ? -1 : c.box.box().half_area(); };
    out[0] = child;
    areas[0] = area(child);
    size_t count = 1;
    for (; count < size_t(kBlockWidth); ++count) {
      const size_t i =
          size_t(std::max_element(areas.begin(), areas.begin() + count) - areas.begin());
      if (areas[i] < 0) break;
      std::move_backward(out.begin() + i + 1, out.begin() + count, out.begin() + count + 1);
      std::move_backward(areas.begin() + i + 1, areas.begin() + count, areas.begin() + count + 1);
      split(Child(out[i]), depth, out[i], out[i + 1], scratch, arena);
      areas[i] = area(out[i]), areas[i + 1] = area(out[i + 1]);
    }
    return count;
  }

  void split(Child child, int depth, Child& below, Child& above, Column<BuildItem>& scratch,
             Arena* arena) {
    if (arena && !child.plan && !child.items) {
      if (child.size() <= kPlanAbove)
        make_items(child, ids_of(child), *arena);
      else if (depth + kPlanDepth <= kBvhCostLevels)
        plan_again(child, *arena);
    }
    if (child.plan) {
      const BuildPlan::Node& node = child.plan->nodes[child.node];
      below = planned(child, node.below);
      above = planned(child, node.above);
      return;
    }
    BuildSplit parts;
    if (child.items) {
      parts.middle = part_kinds(child, depth);
      if (parts.middle == 0 && depth < kBvhCostLevels)
        parts = split_by_cost(child.range(), hasty_, scratch);
    } else {  // too many at one place for a plan
      parts.below = parts.above = child.box;
    }
    if (parts.middle == 0) parts.middle = child.size() / 2;
    below = part_of(child, 0, parts.middle, parts.below);
    above = part_of(child, parts.middle, child.size(), parts.above);
    if (parts.above.box().empty())
      below.box = box_of(below.range()), above.box = box_of(above.range());
  }

  static Child part_of(const Child& whole, size_t first, size_t end, const BuildBox& box) {
    return {whole.begin + first, whole.begin + end, box,
            whole.items ? whole.items + first : nullptr};
  }

  // The child for node `node` of the plan that contains `child`.
  static Child planned(const Child& child, uint32_t node) {
    const BuildPlan::Node& from = child.plan->nodes[child.node];
    const BuildPlan::Node& to = child.plan->nodes[node];
    const size_t all = child.begin - from.begin;  // index of the plan's first item
    return {.begin = all + to.begin,
            .end = all + to.end,
            .box = to.box,
            .plan = to.below != 0 ? child.plan : nullptr,
            .node = node};
  }

  // Returns the index where to split a range by kind, or 0. The last splits do so, since leaves do
  // not mix kinds. So does the root, where a few primitives of a kind become a leaf that rays test
  // early, which shortens them.
  size_t part_kinds(const Child& child, int depth) const {
    constexpr size_t kFew = kBlockWidth;
    const size_t n = child.size();
    if (n > kFew && depth > 0) return 0;
    const auto kind = [&](size_t i) { return g_.kind_of(child.items[i].id()); };
    size_t first = 1, last = 1;
    while (first <= kFew && first < n && kind(first) == kind(0)) ++first;
    if (first <= kFew) return first;
    while (last <= kFew && kind(n - 1 - last) == kind(n - 1)) ++last;
    return last <= kFew ? n - last : 0;
  }

  // Makes its items, with the ids ids(0), ids(1) ...
  void make_items(Child& child, const auto& ids, Arena& arena) {
    Column<BuildItem>& items = arena.items.emplace_back(arena.spare.take());
    items.clear();  // so that growing copies nothing
    items.resize(child.size());
    child.items = items.data();
    for_chunks(child.size(), [&](size_t, size_t first, size_t end) {
      fill_items(ids, first, child.size(), child.range().subspan(first, end - first));
    });
  }

  // Writes these ids in the order of a plan.
  void plan(Child& child, const auto& ids, Arena& arena) {
    const size_t count = child.size();
    const auto make = [&](size_t first, BuildRange out) { fill_items(ids, first, count, out); };
    arena.plans.push_back(
        std::make_unique<BuildPlan>(make_plan({&order_[child.begin], count}, make)));
    const BuildPlan& plan = *arena.plans.back();
    child.box = plan.nodes[0].box;
    if (plan.nodes[0].below != 0) child.plan = &plan, child.node = 0;
  }

  void plan_again(Child& child, Arena& arena) {
    Column<PrimitiveId> copy(child.size());
    for_each_index(copy.size(), [&](size_t i) { copy[i] = order_[child.begin + i]; });
    plan(child, [&](size_t i) { return copy[i]; }, arena);
  }

  // Fills the items of ids(first) and following, `count` in total.
  void fill_items(const auto& ids, size_t first, size_t count, BuildRange out) const {
    constexpr size_t kAhead = 16;
    for (size_t k = 0; k < out.size(); ++k) {
      const PrimitiveId id = ids(first + k);
      g_.prefetch(ids(std::min(first + k + kAhead, count - 1)));
      if (g_.kind_of(id) == PrimitiveKind::sphere) {
        const Sphere s = g_.object().spheres[g_.index_of(PrimitiveKind::sphere, id)];
        const Float4 center = {s.center.x, s.center.y, s.center.z, 0};
        const Float4 r = splat(std::abs(s.radius));
        BuildBox box{center - r, -center - r};
        // Widens by an ulp or two, since the subtraction may have rounded up by half an ulp.
        constexpr float kUlp = std::numeric_limits<float>::epsilon();
        box.lo -= abs(box.lo) * kUlp;
        box.minus_hi -= abs(box.minus_hi) * kUlp;
        out[k].set(box, id);
      } else {
        const Box3f box = g_.bounds(id);
        const Float4 lo = {box.lo.x, box.lo.y, box.lo.z, 0};
        const Float4 hi = {box.hi.x, box.hi.y, box.hi.z, 0};
        out[k].set({lo, -hi}, id);
      }
    }
  }

  // Lists the parts in the order of their items and assigns their places in the pools.
  void place(Part& part, std::vector<Part*>& parts, std::array<uint32_t, kPools>& total) const {
    part.begin = total;
    for (size_t k = 0; k < kPools; ++k) total[k] += part.counts[k];
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
    std::span<const PrimitiveId> rest(order_);
    rest = rest.subspan(part.first);
    const size_t before = rest.size();
    for (const uint8_t size : part.leaf_sizes) {
      const std::span<const PrimitiveId> ids = rest.first(size);
      rest = rest.subspan(size);
      constexpr size_t kAhead = 32;
      if (rest.size() > kAhead + size)
        for (size_t i = 0; i < size; ++i) g_.prefetch(rest[kAhead + i]);
      const Pool pool = pool_of(g_.kind_of(ids[0]));
      out.fill(g_, pool_ref(pool, next[size_t(pool)]++), ids);
    }
    add_work(before - rest.size());
  }

  const Geometry& g_;
  const Column<PrimitiveId>* some_;
  bool hasty_ = false;
  Column<PrimitiveId> order_;  // finally that of the leaves
  SpareItems spare_;
  PerThread<Column<BuildItem>> scratches_{[] { return Column<BuildItem>(); }};
};

// The median width of a sample of triangles.
float triangle_width(const Column<TriangleBlock>& blocks) {
  constexpr size_t kSamples = 256;
  std::vector<float> widths;
  for (size_t i = 0; i < kSamples; ++i) {
    const TriangleBlock& block = blocks[i * blocks.size() / kSamples];
    Box3f box;
    for (const auto& corner : block.corner) box.extend({corner[0][0], corner[1][0], corner[2][0]});
    widths.push_back(max_component(box.size()));
  }
  const auto middle = widths.begin() + kSamples / 2;
  std::nth_element(widths.begin(), middle, widths.end());
  return *middle;
}

}  // namespace

std::expected<Bvh, std::string> build_bvh(const Geometry& geometry,
                                          const AvailableMemory& available, bool clear) {
  Bvh out;
  Column<PrimitiveId> some;
  if (geometry.any_transparent())
    some = clear ? geometry.list_transparent() : geometry.list_opaque();
  Builder builder(geometry, geometry.any_transparent() ? &some : nullptr);
  if (auto error = builder.build(available, out)) return std::unexpected(*error);
  if (out.empty()) return out;
  constexpr int kFew = 4;  // measured
  for (const uint32_t ref : out.nodes[0].child)
    if (ref != kNoChild && ref_pool(ref) != Pool::nodes &&
        out.primitives(ref)[kFew] == kNoPrimitive)
      out.shared.push_back(ref);
  // If triangles are small, a beam tests many that none of its rays hits. Measured.
  const auto& triangles = out.of<PrimitiveKind::triangle>();
  if (!triangles.empty() && triangles.size() == out.Blocks::count())
    out.farthest_apart = 8 * triangle_width(triangles);
  return out;
}

}  // namespace raio::core
