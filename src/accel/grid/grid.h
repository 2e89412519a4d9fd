// The uniform grid: equal cells over the bounds of all primitives, each with a list of the
// primitives that overlap it. Built by grid/build.cpp. With counters it is traversed cell by cell,
// one ray at a time (grid.cpp); otherwise the lists are baked into blocks (grid/bake.cpp), and
// batches of rays traverse them (grid/trace.cpp).
//
// Fujimoto, Tanaka and Iwata 1986, "ARTS: Accelerated Ray-Tracing System", IEEE CG&A 6(4).
#pragma once

#include <array>
#include <expected>
#include <limits>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "accel/blocks/blocks.h"

namespace raio::core {

struct Lattice {
  Box3d box;
  std::array<int, 3> n{1, 1, 1};
  Vec3d cell, per_unit;  // the size of a cell and its reciprocal

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
  Box3f box_of(std::array<int, 3> c) const {
    Box3f out;
    for (int a = 0; a < 3; ++a) {
      out.lo[a] = float(plane(c[size_t(a)], a));
      out.hi[a] = float(plane(c[size_t(a)] + 1, a));
    }
    return out;
  }
};

/// The resolution of an automatic grid, as AccelOptions::grid_factor; 0: one cell.
double usual_grid_factor(size_t primitives);

/// The error of a hit computed in floats: a few roundings of the largest number involved, of the
/// ray's origin or of the scene.
constexpr double hit_error(double largest) {
  return 16 * double(std::numeric_limits<float>::epsilon()) * largest;
}

struct GridCells {
  Column<PrimitiveId> oversized;  // in no cell; every ray is tested with them first
  Lattice lattice;
  Column<uint32_t> begin;     // per cell, plus one: where its list starts
  Column<PrimitiveId> items;  // ascending in each cell
  double reach = 0;           // the largest absolute coordinate of listed primitives
  double near = 0;            // rays with origins up to this coordinate find them in their cells
};

/// The result does not depend on the number of threads. The error is one line.
std::expected<GridCells, std::string> build_grid(const Geometry& geometry,
                                                 const AccelOptions& options);

/// Up to eight blocks of a cell, with the boxes around their parts inside it.
struct BlockGroup {
  EightBoxes boxes;
  uint32_t block[kBlockWidth];
};

/// The maximum of GridBlocks::empty_around.
inline constexpr int kFarthest = 255;

/// The cells for the fast traversal: their lists as blocks of eight primitives.
struct GridBlocks : Blocks {
  std::array<int, 3> n{0, 0, 0};
  std::array<float, 3> lo{}, per_unit{};
  Column<uint32_t> begin;  // per cell, plus one: where its groups start
  Column<BlockGroup> groups;
  // Per cell, the number of steps between neighbours, straight or diagonal, to the nearest
  // non-empty cell, or a lower bound.
  Column<uint8_t> empty_around;

  bool empty() const { return groups.empty() && shared.empty(); }
  size_t bytes() const {
    return Blocks::bytes() + begin.size() * sizeof(uint32_t) + groups.size() * sizeof(BlockGroup) +
           empty_around.size();
  }
};

/// The error is one line: more than `available` bytes would be needed.
std::expected<GridBlocks, std::string> bake_grid(
    const Geometry& geometry, const GridCells& cells,
    const AvailableMemory& available = available_memory());

/// Traversal with the machine's best instruction set. Hits are exactly those of brute force.
void grid_closest(const Geometry& geometry, const GridBlocks& blocks, const RayBatch& rays,
                  HitBatch& hits, TraceContext& context);
void grid_occluded(const Geometry& geometry, const GridBlocks& blocks, const RayBatch& rays,
                   uint8_t* hit, TraceContext& context);

}  // namespace raio::core
