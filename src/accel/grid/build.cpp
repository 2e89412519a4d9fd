// Finds the cells of each primitive in parallel and sorts the references by cell.
#include <fmt/core.h>

#include "accel/grid/grid.h"
#include "base/exact_math.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

// A primitive as large as the scene would be listed in every cell that it crosses, and one larger
// than all the rest together would leave the rest only a few cells (the "teapot in a stadium").
// Such oversized primitives, and infinite planes, stay outside; every ray is tested with them
// first, so only few are worthwhile.
constexpr size_t kMaxOversized = 16;
constexpr float kGiantShare = 0.5f;  // of the surface area of the box of the remaining ones

// The technical report of 2018 uses 2 (mFactor), for cells that list single primitives. With blocks
// of eight in groups of eight, cells with some dozens are best (docs/performance.md).
constexpr double kFactor = 0.3;
// This few primitives are one cell, unless a resolution is requested.
constexpr size_t kFew = 32;

// Rays from beyond the camera, and from this many times the extent of the primitives, are not
// traversed through cells but tested with everything: their hits are dominated by rounding.
constexpr double kNear = 16;

bool touches(const Geometry& g, PrimitiveId id, const Box3d& box) {
  return with_kind(g.kind_of(id), [&]<PrimitiveKind kind> {
    if constexpr (kIsBounded<kind>)
      return overlaps(g.get<kind>(g.index_of(kind, id)), box);
    else
      return true;
  });
}

// M * side / s + 1 cells along each side, s = cbrt(volume / N): cells are cubes, M^3 * N of them.
// An axis on which the box is thinner than a cell gets one and leaves the formula, so a flat scene
// gets square cells and not a line of infinitely many.
std::array<int, 3> report_resolution(Vec3d size, double count, double factor) {
  constexpr int kMaxPerAxis = 1 << 20;
  std::array<int, 3> n{1, 1, 1};
  std::array<bool, 3> thin{};
  for (int pass = 0; pass < 3; ++pass) {
    double measure = 1;
    int axes = 0;
    for (int a = 0; a < 3; ++a)
      if (!thin[a]) measure *= size[a], ++axes;
    if (axes == 0) break;
    const double s = exact_pow(measure / count, 1.0 / axes);
    bool again = false;
    for (int a = 0; a < 3; ++a) {
      if (thin[a]) continue;
      if (!(factor * size[a] > s)) {
        thin[a] = again = true;
        n[a] = 1;
      } else {
        n[a] = int(std::min(factor * size[a] / s + 1, double(kMaxPerAxis)));
      }
    }
    if (!again) break;
  }
  return n;
}

class GridBuilder : GridCells {
 public:
  explicit GridBuilder(const Geometry& geometry) : g_(geometry) {}

  std::expected<GridCells, std::string> build(const AccelOptions& options) {
    by_boxes_ = options.grid_plain;
    collect_items();
    if (!options.grid_plain) pull_oversized();
    if (rest_.empty()) {
      begin.assign(2, 0);
      lattice = Lattice(Box3d{Vec3d(0.0), Vec3d(1.0)}, {1, 1, 1});
    } else {
      if (auto error = choose_resolution(options)) return std::unexpected(std::move(*error));
      list_references();
    }
    return std::move(static_cast<GridCells&>(*this));
  }

 private:
  void collect_items() {
    size_t most = 0;
    for_each_bounded_kind([&]<PrimitiveKind kind> { most += g_.count(kind); });
    rest_.reserve(most);
    StopCheck look;
    for_each_kind([&]<PrimitiveKind kind> {
      auto& to = kIsBounded<kind> ? rest_ : oversized;
      for (uint32_t i = 0; i < g_.count(kind); ++i, look())
        if (g_.is_opaque(kind, i)) to.push_back(g_.id_of(kind, i));
    });
    boxes_.resize(rest_.size());
    for_each_index(rest_.size(), [&](size_t i) { boxes_[i] = g_.bounds(rest_[i]); });
  }

  Box3f bounds_of_rest() const {
    Box3f all;
    StopCheck look;
    for (const Box3f& b : boxes_) all.extend(b), look();
    return all;
  }

  // Repeatedly: without one oversized primitive, another may be oversized relative to the rest.
  void pull_oversized() {
    const size_t most = oversized.size() + kMaxOversized;
    StopCheck look;
    while (!rest_.empty()) {
      const float limit = kGiantShare * bounds_of_rest().half_area();
      std::vector<uint32_t> large;
      for (uint32_t i = 0; i < rest_.size() && large.size() <= kMaxOversized; ++i, look())
        if (boxes_[i].half_area() >= limit) large.push_back(i);
      if (large.empty() || oversized.size() + large.size() > most) break;
      for (const uint32_t i : large) oversized.push_back(rest_[i]), rest_[i] = kNoPrimitive;
      size_t kept = 0;
      for (size_t i = 0; i < rest_.size(); ++i, look())
        if (rest_[i] != kNoPrimitive) rest_[kept] = rest_[i], boxes_[kept++] = boxes_[i];
      rest_.resize(kept), boxes_.resize(kept);
    }
  }

  // Returns the error in one line, or nothing.
  std::optional<std::string> choose_resolution(const AccelOptions& options) {
    const Box3f tight = bounds_of_rest();
    reach = max_component(max(abs(Vec3d(tight.lo)), abs(Vec3d(tight.hi))));
    Box3d box{Vec3d(tight.lo), Vec3d(tight.hi)};
    // Gives a flat scene's box a thickness.
    box.pad(hit_error(std::max(reach, double(std::numeric_limits<float>::min()))));
    // Cells are effectively this much wider.
    near = kNear * reach;
    if (&g_.object() == &g_.scene())  // the camera is in the space of the grid
      near = std::max(near, 2 * double(max_component(abs(g_.scene().camera.from))));
    pad_ = hit_error(near);

    const bool forced = options.grid_resolution[0] > 0;
    double factor = options.grid_factor > 0 ? options.grid_factor : usual_grid_factor(rest_.size());
    lattice = Lattice(box, forced ? options.grid_resolution
                                  : report_resolution(box.size(), double(rest_.size()), factor));
    // If many primitives span many cells each, the lists would exceed any memory; cells grow until
    // the lists are proportional to the scene.
    const double most_visits = options.grid_factor > 0 ? 1e7 + 100.0 * double(rest_.size())
                                                       : 2.5e5 + 16.0 * double(rest_.size());
    while (!forced && (visits() > most_visits || double(lattice.cells()) > most_visits)) {
      factor *= 0.8;
      lattice = Lattice(box, report_resolution(box.size(), double(rest_.size()), factor));
    }
    const double bytes = 4.0 * double(lattice.cells()) + 16.0 * (forced ? visits() : 0);
    const AvailableMemory available = available_memory();
    constexpr double kMost = 4e9;  // of cells, and of references
    if (bytes > 0.8 * double(available.bytes) || double(lattice.cells()) >= kMost ||
        visits() >= kMost)
      return fmt::format(
          "a grid of {}x{}x{} cells would take up to {:.1f} GB and {}; choose fewer cells",
          lattice.n[0], lattice.n[1], lattice.n[2], bytes * 1e-9, available.text());
    return std::nullopt;
  }

  // The cells that a box overlaps: [lo, hi] per axis.
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
    StopCheck look;
    for (const Box3f& b : boxes_) sum += range(b).count(), look();
    return sum;
  }

  // Whether it is a piece of a polygon.
  bool is_piece(PrimitiveId id) const {
    return g_.kind_of(id) == PrimitiveKind::triangle &&
           g_.index_of(PrimitiveKind::triangle, id) >= g_.object().triangles.size();
  }

  template <class F>
  void for_each_cell(size_t i, StopCheck& look, F&& f) const {
    const Range r = range(boxes_[i]);
    const bool all = r.count() == 1 || (by_boxes_ && !is_piece(rest_[i]));
    for (int z = r.lo[2]; z <= r.hi[2]; ++z)
      for (int y = r.lo[1]; y <= r.hi[1]; ++y)
        for (int x = r.lo[0]; x <= r.hi[0]; ++x) {
          look();
          Box3d cell{{lattice.plane(x, 0), lattice.plane(y, 1), lattice.plane(z, 2)},
                     {lattice.plane(x + 1, 0), lattice.plane(y + 1, 1), lattice.plane(z + 1, 2)}};
          cell.pad(pad_);
          if (all || touches(g_, rest_[i], cell)) f(lattice.index(x, y, z));
        }
  }

  // Chunks of items find their cells in parallel; then one counting sort over the chunks in order
  // keeps each list ascending for any number of threads.
  void list_references() {
    constexpr size_t kItemsPerChunk = 1024;
    struct Reference {
      uint32_t cell;
      PrimitiveId item;
    };
    // Chunks share a thread's large blocks: the system takes long to get many small ones back.
    constexpr size_t kBlock = size_t(1) << 18;
    struct Found {
      std::vector<Reference> in_chunk;
      std::vector<Column<Reference>> blocks;
    };
    PerThread<Found> found_by_thread{[] { return Found(); }};
    std::vector<std::span<const Reference>> chunks((rest_.size() + kItemsPerChunk - 1) /
                                                   kItemsPerChunk);
    parallel_for(chunks.size(), [&](size_t c) {
      const size_t first = c * kItemsPerChunk, end = std::min(rest_.size(), first + kItemsPerChunk);
      auto& [in_chunk, blocks] = found_by_thread.local();
      in_chunk.clear();
      StopCheck look;
      for (size_t i = first; i < end; ++i)
        for_each_cell(i, look,
                      [&](size_t cell) { in_chunk.push_back({uint32_t(cell), rest_[i]}); });
      if (blocks.empty() || blocks.back().capacity() - blocks.back().size() < in_chunk.size())
        blocks.emplace_back().reserve(
            std::max(std::min(kBlock, 2 * rest_.size()), in_chunk.size()));
      Column<Reference>& block = blocks.back();
      const size_t before = block.size();
      block.insert(block.end(), in_chunk.begin(), in_chunk.end());
      chunks[c] = std::span(block).subspan(before);
      add_work(end - first);
    });
    begin.resize(lattice.cells() + 1);
    for_each_index(begin.size(), [&](size_t i) { begin[i] = 0; });
    for (const auto& chunk : chunks) {
      check_stop();
      for (const Reference& r : chunk) ++begin[r.cell + 1];
    }
    StopCheck look;
    for (size_t c = 0; c < lattice.cells(); ++c, look()) begin[c + 1] += begin[c];
    items.resize(begin.back());
    // The items of a chunk are spread over all pages, which the system first fills with zeros.
    for_each_index(items.size(), [&](size_t i) { items[i] = kNoPrimitive; });
    Column<uint32_t> next(lattice.cells());
    for_each_index(next.size(), [&](size_t i) { next[i] = begin[i]; });
    for (const auto& chunk : chunks) {
      check_stop();
      for (const Reference& r : chunk) items[next[r.cell]++] = r.item;
    }
  }

  const Geometry& g_;
  Column<PrimitiveId> rest_;  // all except oversized primitives
  Column<Box3f> boxes_;       // of rest_
  double pad_ = 0;
  bool by_boxes_ = false;  // list all except pieces in every cell that their box overlaps
};

}  // namespace

double usual_grid_factor(size_t primitives) { return primitives <= kFew ? 0 : kFactor; }

std::expected<GridCells, std::string> build_grid(const Geometry& geometry,
                                                 const AccelOptions& options) {
  return GridBuilder(geometry).build(options);
}

}  // namespace raio::core
