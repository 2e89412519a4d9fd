// Bakes the lists of grid cells into blocks: chunks of cells in parallel, each into its own part of
// the pools, so the result does not depend on threads.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "accel/grid/grid.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

using Counts = std::array<uint32_t, kPools>;  // the nodes are groups

// Calls f(pool, items) for the blocks formed by ascending items.
template <class F>
void for_blocks(const Geometry& g, std::span<const PrimitiveId> items, F&& f) {
  while (!items.empty()) {
    const PrimitiveKind kind = g.kind_of(items[0]);
    size_t n = 1;
    while (n < std::min(items.size(), size_t(kBlockWidth)) && g.kind_of(items[n]) == kind) ++n;
    f(pool_of(kind), items.first(n));
    items = items.subspan(n);
  }
}

class Baker {
 public:
  Baker(const Geometry& geometry, const GridCells& cells) : g_(geometry), cells_(cells) {}

  std::expected<GridBlocks, std::string> bake(const AvailableMemory& available) {
    set_lattice();
    const std::vector<PrimitiveId> oversized = bounded_oversized();
    const size_t count = cells_.lattice.cells();
    std::vector<Counts> blocks(chunks_of(count));
    for_chunks(count, [&](size_t c, size_t first, size_t end) {
      StopCheck look;
      for (size_t cell = first; cell < end; ++cell, look()) count_blocks(list(cell), blocks[c]);
    });
    // The first block of each chunk in the pools. Blocks of oversized primitives come first.
    Counts next{};
    for_blocks(g_, oversized, [&](Pool pool, auto) {
      out_.shared.push_back(pool_ref(pool, next[size_t(pool)]++));
    });
    for (Counts& chunk : blocks)
      for (size_t p = 0; p < next.size(); ++p) next[p] += std::exchange(chunk[p], next[p]);
    const double bytes =
        double(next[0]) * sizeof(BlockGroup) + Blocks::bytes_of(next) + 5.0 * double(count);
    if (bytes > 0.9 * double(available.bytes))
      return std::unexpected(
          fmt::format("the cells of the grid would take {:.1f} GB and {}; choose fewer cells",
                      bytes * 1e-9, available.text()));
    out_.groups.resize(next[0]);
    out_.resize(next);
    out_.begin.resize(count + 1);
    out_.begin[count] = next[0];
    size_t giant = 0, primitives = 0;
    for_each_bounded_kind([&]<PrimitiveKind kind> { primitives += g_.count(kind); });
    for_blocks(g_, oversized,
               [&](Pool, auto items) { out_.fill(g_, out_.shared[giant++], items); });
    for_chunks(count, [&](size_t c, size_t first, size_t end) {
      StopCheck look;
      for (size_t cell = first; cell < end; ++cell, look()) fill(cell, blocks[c]);
      add_work(primitives * (end - first) / count);
    });
    measure_emptiness();
    return std::move(out_);
  }

 private:
  void count_blocks(std::span<const PrimitiveId> items, Counts& counts) const {
    uint32_t n = 0;
    for_blocks(g_, items, [&](Pool pool, auto) { ++counts[size_t(pool)], ++n; });
    counts[0] += (n + kBlockWidth - 1) / kBlockWidth;
  }

  // Fills the cell's groups and blocks from `next`, and advances it.
  void fill(size_t cell, Counts& next) {
    out_.begin[cell] = next[0];
    const Box3f around = box_of(cell);
    size_t n = 0;
    for_blocks(g_, list(cell), [&](Pool pool, auto items) {
      const uint32_t ref = pool_ref(pool, next[size_t(pool)]++);
      out_.fill(g_, ref, items);
      Box3f box;
      for (const PrimitiveId id : items) box.extend(g_.bounds(id));
      box.lo = max(box.lo, around.lo), box.hi = min(box.hi, around.hi);
      const size_t lane = n++ % kBlockWidth;
      if (lane == 0) {
        BlockGroup& fresh = out_.groups[next[0]++];
        fresh.boxes.set_empty();
        std::ranges::fill(fresh.block, kNoPrimitive);
      }
      BlockGroup& group = out_.groups[next[0] - 1];
      group.boxes.set(lane, box), group.block[lane] = ref;
    });
  }

  // Extended by the rounding of hits from afar.
  Box3f box_of(size_t cell) const {
    const Lattice& cells = cells_.lattice;
    const double pad = 2 * hit_error(cells_.near);
    Box3f box;
    for (int a = 0; a < 3; ++a) {
      const int i = int(cell % size_t(cells.n[a]));
      cell /= size_t(cells.n[a]);
      box.lo[a] = float(cells.plane(i, a) - pad), box.hi[a] = float(cells.plane(i + 1, a) + pad);
    }
    return box;
  }

  std::span<const PrimitiveId> list(size_t cell) const {
    return std::span(cells_.items)
        .subspan(cells_.begin[cell], cells_.begin[cell + 1] - cells_.begin[cell]);
  }

  void set_lattice() {
    const Lattice& cells = cells_.lattice;
    out_.n = cells.n;
    out_.reach = float(max_component(max(abs(cells.box.lo), abs(cells.box.hi))));
    for (int a = 0; a < 3; ++a) {
      out_.lo[a] = float(cells.box.lo[a]);
      out_.per_unit[a] = float(cells.per_unit[a]);
    }
  }

  // Rosenfeld and Pfaltz 1966, "Sequential Operations in Digital Picture Processing", JACM 13(4):
  // earlier neighbours, then, backwards, later ones.
  void measure_emptiness() {
    const auto& n = out_.n;
    const Lattice& cells = cells_.lattice;
    auto& empty = out_.empty_around;
    empty.resize(cells.cells());
    for_each_index(empty.size(),
                   [&](size_t c) { empty[c] = out_.begin[c] == out_.begin[c + 1] ? 255 : 0; });
    const auto pass = [&](int from_end) {
      const auto at = [&](int i, int a) { return from_end ? n[a] - 1 - i : i; };
      StopCheck look;
      for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
          for (int x = 0; x < n[0]; ++x) {
            look();
            uint8_t& here = empty[cells.index(at(x, 0), at(y, 1), at(z, 2))];
            if (here == 0) continue;
            int least = 254;
            for (int dz = z > 0 ? -1 : 0; dz <= 0; ++dz)
              for (int dy = y > 0 ? -1 : 0; dy <= (dz < 0 && y + 1 < n[1]); ++dy)
                for (int dx = x > 0 ? -1 : 0; dx <= ((dz < 0 || dy < 0) && x + 1 < n[0]); ++dx)
                  least = std::min<int>(
                      least, empty[cells.index(at(x + dx, 0), at(y + dy, 1), at(z + dz, 2))]);
            here = std::min<uint8_t>(here, uint8_t(least + 1));
          }
    };
    pass(0), pass(1);
  }

  // In ascending order; the tracer handles planes.
  std::vector<PrimitiveId> bounded_oversized() {
    std::vector<PrimitiveId> oversized;
    for (const PrimitiveId id : cells_.oversized) {
      const bool bounded =
          with_kind(g_.kind_of(id), []<PrimitiveKind kind> { return kIsBounded<kind>; });
      if (!bounded) continue;
      oversized.push_back(id);
      const Box3f box = g_.bounds(id);
      out_.reach = std::max(out_.reach, max_component(max(abs(box.lo), abs(box.hi))));
    }
    std::ranges::sort(oversized);
    return oversized;
  }

  const Geometry& g_;
  const GridCells& cells_;
  GridBlocks out_;
};

}  // namespace

std::expected<GridBlocks, std::string> bake_grid(const Geometry& geometry, const GridCells& cells,
                                                 const AvailableMemory& available) {
  return Baker(geometry, cells).bake(available);
}

}  // namespace raio::core
