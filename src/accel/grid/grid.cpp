// Both traversals of the grid: with counters that of Amanatides and Woo 1987, "A Fast Voxel
// Traversal Algorithm for Ray Tracing", Eurographics, cell by cell, one ray at a time, so tests and
// steps are those of the textbook; else the fast one through the same cells.
#include "accel/grid/grid.h"

#include "accel/intersect.h"
#include "accel/structures.h"

namespace raio::core {
namespace {

AccelInfo info_of(const GridCells& cells, size_t bytes) {
  return {.name = "grid",
          .bytes = bytes,
          .cells = cells.lattice.cells(),
          .references = cells.items.size(),
          .resolution = cells.lattice.n,
          .oversized = cells.oversized.size()};
}

// `listed` returns the number of primitives in a cell.
template <class Listed>
void see_cells(const Lattice& lattice, Listed&& listed,
               const std::function<void(const AccelBox&)>& see) {
  const auto& n = lattice.n;
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        if (const size_t count = listed(lattice.index(x, y, z)); count > 0)
          see({.box = lattice.box_of({x, y, z}), .primitives = count});
}

// The primitives that a ray was tested with last, so that one listed in several cells is mostly
// tested once. A table of a few entries per ray, not per primitive, so threads share nothing.
class Mailbox {
 public:
  Mailbox() { seen_.fill(kNoPrimitive); }
  bool first_time(PrimitiveId id) {
    PrimitiveId& slot = seen_[id % seen_.size()];
    if (slot == id) return false;
    slot = id;
    return true;
  }

 private:
  std::array<PrimitiveId, 8> seen_;
};

// Events of a traversal, discarded or sent to a TraceLog.
struct Unlogged {
  void enter(double) {}
  template <class Axes>
  void step(size_t, const Axes&) {}
  void test(PrimitiveId, bool = false) {}
};
class Logged {
 public:
  Logged(TraceLog& log, const Lattice& lattice) : log_(log), lattice_(lattice) {}

  void enter(double t) { log_.enter = t; }
  template <class Axes>
  void step(size_t cell, const Axes& axes) {
    const auto& n = lattice_.n;
    TraceLog::Step step{.first_test = log_.tests.size()};
    for (int a = 0; a < 3; cell /= size_t(n[size_t(a)]), ++a) {
      step.cell[size_t(a)] = int(cell % size_t(n[size_t(a)]));
      step.t_max[a] = axes[a].next, log_.t_delta[a] = axes[a].stride;
    }
    step.box = lattice_.box_of(step.cell);
    log_.steps.push_back(step);
  }
  void test(PrimitiveId id, bool repeated = false) { log_.add_test(id, repeated); }

 private:
  TraceLog& log_;
  const Lattice& lattice_;
};

class CountingGrid final : public Accel {
 public:
  CountingGrid(Geometry geometry, GridCells cells, bool plain)
      : Accel(std::move(geometry)), cells_(std::move(cells)), plain_(plain) {}

  void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
      hits.set(i, trace<false>(rays[i], context, Unlogged()).best);
  }
  void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    for (size_t i = 0; i < rays.size() && !context.stopped(); ++i)
      hit[i] = trace<true>(rays[i], context, Unlogged()).best.found();
  }
  std::optional<TraceLog> log(const Ray& ray, bool any) const override {
    TraceLog log;
    TraceContext context;
    const Logged logged(log, cells_.lattice);
    (void)(any ? trace<true>(ray, context, logged) : trace<false>(ray, context, logged));
    judge_tests(log, geometry_, ray);
    return log;
  }
  void boxes(int, const std::function<void(const AccelBox&)>& see) const override {
    if (cells_.items.empty()) return;
    see_cells(cells_.lattice, [&](size_t c) { return cells_.begin[c + 1] - cells_.begin[c]; }, see);
  }
  AccelInfo describe() const override {
    return info_of(cells_, geometry_.bytes() + cells_.begin.size() * sizeof(cells_.begin[0]) +
                               cells_.items.size() * sizeof(cells_.items[0]));
  }

 private:
  template <bool any, class Log>
  RayQuery trace(const Ray& ray, TraceContext& context, Log log) const {
    RayQuery query(ray);
    if (!(ray.tmax > 0)) return query;
    for (const PrimitiveId id : cells_.oversized) {
      ++context.tests, log.test(id);
      if (test_primitive(geometry_, id, query) && any) return query;
    }
    if (!cells_.items.empty()) traverse<any>(query, context, log);
    return query;
  }

  template <bool any, class Log>
  void all(RayQuery& query, TraceContext& context, Log& log) const {
    bool done = false;
    for_each_bounded_kind([&]<PrimitiveKind kind> {
      for (uint32_t i = 0; !done && i < geometry_.count(kind); ++i) {
        if (!geometry_.is_opaque(kind, i)) continue;
        ++context.tests, log.test(geometry_.id_of(kind, i));
        done = test<kind>(geometry_, i, query) && any;
      }
    });
  }

  // In double throughout: in scalar code it costs the same, and the ray's cell is never in doubt,
  // however far away it starts.
  template <bool any, class Log>
  void traverse(RayQuery& query, TraceContext& context, Log& log) const {
    const Vec3d o(query.ray.origin), d(query.ray.dir);
    const double size = max_component(abs(o)), slack = hit_error(std::max(size, cells_.reach));
    Box3d box = cells_.lattice.box;
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
    log.enter(enter);
    if (size > cells_.near) return all<any>(query, context, log);

    // Per axis: cells left before the ray leaves the grid, the step through the lists, and the
    // parameter of the next plane as start + i * stride, which does not drift like a running sum.
    // Reduced by the error of a hit, so that a hit near the plane does not end the traversal.
    struct Axis {
      int left = 0;
      ptrdiff_t step = 0;
      double next = std::numeric_limits<double>::infinity(), start = 0, stride = 0, i = 0;
    };
    Axis axes[3];
    size_t cell = 0, pitch = 1;
    for (int a = 0; a < 3; ++a) {
      const int c = cells_.lattice.coordinate(o[a] + enter * d[a], a);
      cell += size_t(c) * pitch;
      if (d[a] != 0) {
        const bool up = d[a] > 0;
        Axis& axis = axes[a];
        axis.left = up ? cells_.lattice.n[a] - 1 - c : c;
        axis.step = up ? ptrdiff_t(pitch) : -ptrdiff_t(pitch);
        axis.start = (cells_.lattice.plane(c + up, a) - o[a]) * inverse[a] - slack;
        axis.stride = cells_.lattice.cell[a] * std::abs(inverse[a]);
        axis.next = axis.start;
      }
      pitch *= size_t(cells_.lattice.n[a]);
    }
    Mailbox mailbox;
    while (true) {
      ++context.steps, log.step(cell, axes);
      for (uint32_t r = cells_.begin[cell]; r < cells_.begin[cell + 1]; ++r) {
        const PrimitiveId id = cells_.items[r];
        const bool repeated = !mailbox.first_time(id) && !plain_;
        log.test(id, repeated);
        if (repeated) continue;
        ++context.tests;
        if (test_primitive(geometry_, id, query) && any) return;
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

  GridCells cells_;
  bool plain_;
};

class Grid final : public Accel {
 public:
  Grid(Geometry geometry, const GridCells& cells, GridBlocks blocks)
      : Accel(std::move(geometry)),
        lattice_(cells.lattice),
        blocks_(std::move(blocks)),
        info_(info_of(cells, geometry_.bytes() + blocks_.bytes())) {}

  void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    grid_closest(geometry_, blocks_, rays, hits, context);
  }
  void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    grid_occluded(geometry_, blocks_, rays, hit, context);
  }
  void boxes(int, const std::function<void(const AccelBox&)>& see) const override {
    if (blocks_.groups.empty()) return;
    const auto listed = [&](size_t cell) {
      size_t count = 0;
      for (uint32_t g = blocks_.begin[cell]; g < blocks_.begin[cell + 1]; ++g)
        for (const uint32_t block : blocks_.groups[g].block)
          if (block != kNoPrimitive) count += blocks_.count_primitives(block);
      return count;
    };
    see_cells(lattice_, listed, see);
  }
  AccelInfo describe() const override { return info_; }

 private:
  Lattice lattice_;
  GridBlocks blocks_;
  AccelInfo info_;
};

}  // namespace

AccelResult make_grid(Geometry geometry, const AccelOptions& options) {
  auto cells = build_grid(geometry, options);
  if (!cells) return std::unexpected(std::move(cells.error()));
  if (options.counters || options.grid_plain)
    return std::make_unique<CountingGrid>(std::move(geometry), std::move(*cells),
                                          options.grid_plain);
  auto blocks = bake_grid(geometry, *cells);
  if (!blocks) return std::unexpected(std::move(blocks.error()));
  return std::make_unique<Grid>(std::move(geometry), *cells, std::move(*blocks));
}

}  // namespace raio::core
