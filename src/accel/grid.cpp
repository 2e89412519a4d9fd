// The uniform grid: equal cells over the bounds of all primitives, each with the list of those that
// touch it, walked cell by cell along the ray.
//
// Fujimoto, Tanaka and Iwata 1986, "ARTS: Accelerated Ray-Tracing System", IEEE CG&A 6(4); the walk
// is that of Amanatides and Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing",
// Eurographics.
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include "accel/intersect.h"
#include "accel/structures.h"
#include "base/memory.h"
#include "shape/cone.h"
#include "shape/sphere.h"
#include "shape/triangle.h"

namespace raio {
namespace {

// A primitive as large as the scene would be listed in every cell that it passes, and one that is
// larger than all the rest together would leave the rest a few cells (the "teapot in a stadium").
// Such giants, and infinite planes, stay out; every ray tests them first, so only few are worth it.
constexpr size_t kMaxGiants = 16;
constexpr float kGiantShare = 0.5f;  // of the surface of the box of all that is left

constexpr double kReportFactor = 2;  // the report's mFactor

// A hit is computed in floats: from where it belongs it may lie a few roundings of the largest
// number away, that of the ray's origin or of the scene.
double hit_error(double largest) {
  return 16 * double(std::numeric_limits<float>::epsilon()) * largest;
}

// Rays that come from beyond the camera, and from that many times as far as the primitives reach,
// are no longer walked through cells but tested against everything: what they meet is a matter of
// rounding.
constexpr double kNear = 16;

bool touches(const Geometry& g, ItemId id, const Box3d& box) {
  const uint32_t i = item_index(id);
  switch (item_kind(id)) {
    case ItemKind::sphere:
      return overlaps(g.sphere(i), box);
    case ItemKind::triangle:
      return overlaps(g.triangle(i), box);
    case ItemKind::cone:
      return overlaps(g.cone(i), box);
    case ItemKind::plane:
      break;
  }
  return true;
}

struct Lattice {
  Box3d box;
  std::array<int, 3> n{1, 1, 1};
  Vec3d cell, per_unit;  // size of a cell and its reciprocal

  Lattice() = default;
  Lattice(const Box3d& b, std::array<int, 3> counts) : box(b), n(counts) {
    for (int a = 0; a < 3; ++a) {
      cell[a] = box.size()[a] / n[a];
      per_unit[a] = 1 / cell[a];
    }
  }
  size_t cells() const { return size_t(n[0]) * n[1] * n[2]; }
  size_t index(int x, int y, int z) const { return (size_t(z) * n[1] + y) * n[0] + x; }
  int coordinate(double p, int axis) const {
    const double c = (p - box.lo[axis]) * per_unit[axis];
    return c > 0 ? int(std::min(c, double(n[axis] - 1))) : 0;
  }
  double plane(int i, int axis) const { return box.lo[axis] + i * cell[axis]; }
};

// M * side / s + 1 cells along each side, s = cbrt(volume / N): cells are cubes, M^3 * N of them.
// An axis on which the box is thinner than a cell has one and leaves the formula, so that a flat
// scene gets square cells and not a line of infinitely many.
std::array<int, 3> report_resolution(Vec3d size, double count, double factor) {
  constexpr int kMostPerAxis = 1 << 20;
  std::array<int, 3> n{1, 1, 1};
  std::array<bool, 3> thin{};
  for (int pass = 0; pass < 3; ++pass) {
    double measure = 1;
    int axes = 0;
    for (int a = 0; a < 3; ++a)
      if (!thin[a]) measure *= size[a], ++axes;
    if (axes == 0) break;
    const double s = std::pow(measure / count, 1.0 / axes);
    bool again = false;
    for (int a = 0; a < 3; ++a) {
      if (thin[a]) continue;
      if (!(factor * size[a] > s)) {
        thin[a] = again = true;
        n[a] = 1;
      } else {
        n[a] = int(std::min(factor * size[a] / s + 1, double(kMostPerAxis)));
      }
    }
    if (!again) break;
  }
  return n;
}

class GridBuilder {
 public:
  explicit GridBuilder(const Geometry& geometry) : g_(geometry) {}

  std::vector<ItemId> giants;
  Lattice lattice;
  std::vector<uint32_t> begin;  // per cell, and one more: where its list starts
  std::vector<ItemId> items;    // ascending in each cell
  double reach = 0;             // the largest coordinate of what is listed
  double near = 0;              // rays that start with coordinates up to this find it in its cells

  // An error in one line, or nothing.
  std::optional<std::string> build(const AccelOptions& options) {
    by_boxes_ = options.grid_plain;
    collect_items();
    if (!options.grid_plain) pull_giants();
    if (rest_.empty()) {
      begin.assign(2, 0);
      lattice = Lattice(Box3d{Vec3d(0.0), Vec3d(1.0)}, {1, 1, 1});
      return std::nullopt;
    }
    if (auto error = choose_resolution(options)) return error;
    list_references();
    return std::nullopt;
  }

 private:
  void collect_items() {
    for (uint32_t i = 0; i < g_.count(ItemKind::plane); ++i)
      giants.push_back(item_id(ItemKind::plane, i));
    for (const ItemKind kind : {ItemKind::sphere, ItemKind::triangle, ItemKind::cone})
      for (uint32_t i = 0; i < g_.count(kind); ++i) rest_.push_back(item_id(kind, i));
    boxes_.resize(rest_.size());
    tbb::parallel_for(size_t(0), rest_.size(), [&](size_t i) { boxes_[i] = g_.bounds(rest_[i]); });
  }

  Box3f bounds_of_rest() const {
    Box3f all;
    for (const Box3f& b : boxes_) all.extend(b);
    return all;
  }

  // Again and again, since what is left without one giant may have its own.
  void pull_giants() {
    const size_t most = giants.size() + kMaxGiants;
    while (!rest_.empty()) {
      const float limit = kGiantShare * bounds_of_rest().half_area();
      std::vector<uint32_t> large;
      for (uint32_t i = 0; i < rest_.size() && large.size() <= kMaxGiants; ++i)
        if (boxes_[i].half_area() >= limit) large.push_back(i);
      if (large.empty() || giants.size() + large.size() > most) break;
      for (const uint32_t i : large) giants.push_back(rest_[i]), rest_[i] = kNoItem;
      size_t kept = 0;
      for (size_t i = 0; i < rest_.size(); ++i)
        if (rest_[i] != kNoItem) rest_[kept] = rest_[i], boxes_[kept++] = boxes_[i];
      rest_.resize(kept), boxes_.resize(kept);
    }
  }

  std::optional<std::string> choose_resolution(const AccelOptions& options) {
    const Box3f tight = bounds_of_rest();
    reach = max_component(max(abs(Vec3d(tight.lo)), abs(Vec3d(tight.hi))));
    Box3d box{Vec3d(tight.lo), Vec3d(tight.hi)};
    // Gives a flat scene's box a thickness.
    box.pad(hit_error(std::max(reach, double(std::numeric_limits<float>::min()))));
    // Cells are so much wider than they seem.
    near = std::max(kNear * reach, 2 * double(max_component(abs(g_.scene().camera.from))));
    pad_ = hit_error(near);

    const bool forced = options.grid_resolution[0] > 0;
    double factor = options.grid_factor > 0 ? options.grid_factor : kReportFactor;
    lattice = Lattice(box, forced ? options.grid_resolution
                                  : report_resolution(box.size(), double(rest_.size()), factor));
    // Many primitives that each span many cells would take a list beyond any memory; cells grow
    // until the lists are in proportion to the scene.
    const double most_visits = 1e7 + 100.0 * double(rest_.size());
    while (!forced && (visits() > most_visits || double(lattice.cells()) > most_visits)) {
      factor *= 0.8;
      lattice = Lattice(box, report_resolution(box.size(), double(rest_.size()), factor));
    }
    const double bytes = 4.0 * double(lattice.cells()) + 16.0 * (forced ? visits() : 0);
    const double available = double(available_memory_bytes());
    if (bytes > 0.8 * available || double(lattice.cells()) >= 4e9)
      return fmt::format(
          "a grid of {}x{}x{} cells would take up to {:.1f} GB and {:.1f} GB are free; choose "
          "fewer cells",
          lattice.n[0], lattice.n[1], lattice.n[2], bytes * 1e-9, available * 1e-9);
    return std::nullopt;
  }

  // The cells that a box touches: [lo, hi] per axis.
  struct Range {
    std::array<int, 3> lo, hi;
    double count() const {
      return double(hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1);
    }
  };
  Range range(const Box3f& b) const {
    Range r;
    for (int a = 0; a < 3; ++a) {
      r.lo[a] = lattice.coordinate(double(b.lo[a]) - pad_, a);
      r.hi[a] = lattice.coordinate(double(b.hi[a]) + pad_, a);
    }
    return r;
  }
  double visits() const {
    double sum = 0;
    for (const Box3f& b : boxes_) sum += range(b).count();
    return sum;
  }

  // Of a polygon.
  bool is_piece(ItemId id) const {
    return item_kind(id) == ItemKind::triangle && item_index(id) >= g_.scene().triangles.size();
  }

  template <class F>
  void for_each_cell(size_t i, F&& f) const {
    const Range r = range(boxes_[i]);
    const bool all = r.count() == 1 || (by_boxes_ && !is_piece(rest_[i]));
    for (int z = r.lo[2]; z <= r.hi[2]; ++z)
      for (int y = r.lo[1]; y <= r.hi[1]; ++y)
        for (int x = r.lo[0]; x <= r.hi[0]; ++x) {
          Box3d cell{{lattice.plane(x, 0), lattice.plane(y, 1), lattice.plane(z, 2)},
                     {lattice.plane(x + 1, 0), lattice.plane(y + 1, 1), lattice.plane(z + 1, 2)}};
          cell.pad(pad_);
          if (all || touches(g_, rest_[i], cell)) f(lattice.index(x, y, z));
        }
  }

  // Chunks of items find their cells in parallel; then one counting sort over the chunks in order,
  // which leaves each list ascending whatever the number of threads.
  void list_references() {
    constexpr size_t kChunk = 1024;
    struct Reference {
      uint32_t cell;
      ItemId item;
    };
    std::vector<std::vector<Reference>> chunks((rest_.size() + kChunk - 1) / kChunk);
    tbb::parallel_for(size_t(0), chunks.size(), [&](size_t c) {
      for (size_t i = c * kChunk; i < std::min(rest_.size(), (c + 1) * kChunk); ++i)
        for_each_cell(i, [&](size_t cell) { chunks[c].push_back({uint32_t(cell), rest_[i]}); });
    });
    begin.assign(lattice.cells() + 1, 0);
    for (const auto& chunk : chunks)
      for (const Reference& r : chunk) ++begin[r.cell + 1];
    for (size_t c = 0; c < lattice.cells(); ++c) begin[c + 1] += begin[c];
    items.resize(begin.back());
    std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
    for (auto& chunk : chunks) {
      for (const Reference& r : chunk) items[next[r.cell]++] = r.item;
      chunk = {};
    }
  }

  const Geometry& g_;
  std::vector<ItemId> rest_;  // all but giants
  std::vector<Box3f> boxes_;  // theirs
  double pad_ = 0;
  bool by_boxes_ = false;  // list what is no piece in all cells that its box touches
};

// The primitives that a ray met last, so that one listed in several cells is mostly tested once: a
// table of a few entries, kept with the ray and not with the primitive, so that threads do not meet
// in it.
class Mailbox {
 public:
  Mailbox() { seen_.fill(kNoItem); }
  bool first_time(ItemId id) {
    ItemId& slot = seen_[id % seen_.size()];
    if (slot == id) return false;
    slot = id;
    return true;
  }

 private:
  std::array<ItemId, 8> seen_;
};

class Grid final : public Accel {
 public:
  Grid(Geometry geometry, GridBuilder&& built, const AccelOptions& options)
      : Accel(std::move(geometry)),
        lattice_(built.lattice),
        reach_(built.reach),
        near_(built.near),
        giants_(std::move(built.giants)),
        begin_(std::move(built.begin)),
        items_(std::move(built.items)),
        counters_(options.counters),
        plain_(options.grid_plain) {}

  void closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
      hits.set(i, (counters_ ? trace<false, true>(rays[i], context)
                             : trace<false, false>(rays[i], context))
                      .best);
  }

  void occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
      hit[i] =
          (counters_ ? trace<true, true>(rays[i], context) : trace<true, false>(rays[i], context))
              .best.found();
  }

  AccelInfo info() const override {
    return {.name = "grid",
            .bytes = geometry_.bytes() + begin_.size() * sizeof(begin_[0]) +
                     items_.size() * sizeof(items_[0]),
            .cells = lattice_.cells(),
            .references = items_.size(),
            .resolution = lattice_.n,
            .giants = giants_.size()};
  }

 private:
  template <bool any, bool count>
  RayQuery trace(const Ray& ray, TraceContext& context) const {
    RayQuery query(ray);
    if (!(ray.tmax > 0)) return query;
    for (const ItemId id : giants_) {
      if (count) ++context.tests;
      if (test_item(geometry_, id, query) && any) return query;
    }
    if (!items_.empty()) walk<any, count>(query, context);
    return query;
  }

  template <bool any, bool count>
  void all(RayQuery& query, TraceContext& context) const {
    for (const ItemKind kind : {ItemKind::sphere, ItemKind::triangle, ItemKind::cone})
      for (uint32_t i = 0; i < geometry_.count(kind); ++i) {
        if (count) ++context.tests;
        if (test_item(geometry_, item_id(kind, i), query) && any) return;
      }
  }

  // In double throughout: in scalar code it costs the same, and the cell that the ray is in is then
  // never in doubt, however far the ray comes from.
  template <bool any, bool count>
  void walk(RayQuery& query, TraceContext& context) const {
    const Vec3d o(query.ray.origin), d(query.ray.dir);
    const double size = max_component(abs(o)), slack = hit_error(std::max(size, reach_));
    Box3d box = lattice_.box;
    box.pad(slack);
    Vec3d inverse;
    double enter = 0, leave = query.best.t + slack;
    for (int a = 0; a < 3; ++a) {
      inverse[a] = 1 / d[a];
      if (d[a] == 0) {
        if (o[a] < box.lo[a] || o[a] > box.hi[a]) return;
        continue;
      }
      const double t0 = (box.lo[a] - o[a]) * inverse[a];
      const double t1 = (box.hi[a] - o[a]) * inverse[a];
      enter = std::max(enter, std::min(t0, t1));
      leave = std::min(leave, std::max(t0, t1));
    }
    if (!(enter <= leave)) return;
    if (size > near_) return all<any, count>(query, context);

    // Per axis: cells left before the ray leaves the grid, the step through the lists, and the
    // parameter of the next plane as start + i * stride, which does not drift as a running sum
    // would. Taken earlier by the error of a hit, so that one near it does not end the walk.
    struct Axis {
      int left = 0;
      ptrdiff_t step = 0;
      double next = std::numeric_limits<double>::infinity(), start = 0, stride = 0, i = 0;
    };
    Axis axes[3];
    size_t cell = 0, pitch = 1;
    for (int a = 0; a < 3; ++a) {
      const int c = lattice_.coordinate(o[a] + enter * d[a], a);
      cell += size_t(c) * pitch;
      if (d[a] != 0) {
        const bool up = d[a] > 0;
        Axis& axis = axes[a];
        axis.left = up ? lattice_.n[a] - 1 - c : c;
        axis.step = up ? ptrdiff_t(pitch) : -ptrdiff_t(pitch);
        axis.start = (lattice_.plane(c + up, a) - o[a]) * inverse[a] - slack;
        axis.stride = lattice_.cell[a] * std::abs(inverse[a]);
        axis.next = axis.start;
      }
      pitch *= size_t(lattice_.n[a]);
    }
    Mailbox mailbox;
    while (true) {
      if (count) ++context.steps;
      for (uint32_t r = begin_[cell]; r < begin_[cell + 1]; ++r) {
        const ItemId id = items_[r];
        if (!mailbox.first_time(id) && !(count && plain_)) continue;
        if (count) ++context.tests;
        if (test_item(geometry_, id, query) && any) return;
      }
      const bool x = axes[0].next < axes[1].next;
      Axis& axis = x ? (axes[0].next < axes[2].next ? axes[0] : axes[2])
                     : (axes[1].next < axes[2].next ? axes[1] : axes[2]);
      // A hit beyond this cell may be hidden by one in a cell between. Also the end of the ray.
      if (query.best.t <= axis.next || axis.left == 0) return;
      --axis.left;
      cell = size_t(ptrdiff_t(cell) + axis.step);
      axis.i += 1;
      axis.next = axis.start + axis.i * axis.stride;
    }
  }

  Lattice lattice_;
  double reach_, near_;
  std::vector<ItemId> giants_;
  std::vector<uint32_t> begin_;
  std::vector<ItemId> items_;
  bool counters_, plain_;
};

}  // namespace

AccelResult make_grid(Geometry geometry, const AccelOptions& options) {
  GridBuilder builder(geometry);
  if (auto error = builder.build(options)) return std::unexpected(std::move(*error));
  return std::make_unique<Grid>(std::move(geometry), std::move(builder), options);
}

}  // namespace raio
