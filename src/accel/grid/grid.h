// The uniform grid: equal cells over the bounds of all primitives, each with the list of those that
// touch it. grid/build.cpp makes it. With counters it is walked cell by cell, one ray at a time
// (grid.cpp); else what the cells list is baked into blocks (grid/bake.cpp), through which the rays
// of a batch are swept (grid/trace.cpp).
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

namespace raio {

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
  Box3f box_of(std::array<int, 3> c) const {
    Box3f out;
    for (int a = 0; a < 3; ++a) {
      out.lo[a] = float(plane(c[size_t(a)], a));
      out.hi[a] = float(plane(c[size_t(a)] + 1, a));
    }
    return out;
  }
};

/// A hit is computed in floats: from where it belongs it may lie a few roundings of the largest
/// number away, that of the ray's origin or of the scene.
constexpr double hit_error(double largest) {
  return 16 * double(std::numeric_limits<float>::epsilon()) * largest;
}

struct GridCells {
  std::vector<PrimitiveId> oversized;  // in no cell; every ray tests them first
  Lattice lattice;
  std::vector<uint32_t> begin;     // per cell, and one more: where its list starts
  std::vector<PrimitiveId> items;  // ascending in each cell
  double reach = 0;                // the largest coordinate of what is listed
  double near = 0;  // rays that start with coordinates up to this find it in its cells
};

/// The same for any number of threads. The error is one line.
std::expected<GridCells, std::string> build_grid(const Geometry& geometry,
                                                 const AccelOptions& options);

/// Up to eight blocks of a cell, with the boxes around what of them lies in it.
struct BlockGroup {
  EightBoxes boxes;
  uint32_t block[kBlockWidth];
};

/// The most that GridBlocks::empty_around tells.
inline constexpr int kFarthest = 255;

/// The cells as the fast walk wants them: what they list, eight primitives at a time.
struct GridBlocks : Blocks {
  std::array<int, 3> n{0, 0, 0};
  std::array<float, 3> lo{}, per_unit{};
  Column<uint32_t> begin;  // per cell, and one more: where its groups start
  Column<BlockGroup> groups;
  // Per cell, how many steps from neighbour to neighbour, straight or diagonal, lead to one that
  // lists something, or more.
  Column<uint8_t> empty_around;

  bool empty() const { return groups.empty() && shared.empty(); }
  size_t bytes() const {
    return Blocks::bytes() + begin.size() * sizeof(uint32_t) + groups.size() * sizeof(BlockGroup) +
           empty_around.size();
  }
};

/// The error is one line: more than `available` bytes would be needed.
std::expected<GridBlocks, std::string> bake_grid(const Geometry& geometry, const GridCells& cells,
                                                 size_t available = available_memory_bytes());

/// The walks, for the best instruction set that this machine has. Hits are those of brute force, to
/// the last bit.
void grid_closest(const Geometry& geometry, const GridBlocks& blocks, const RayBatch& rays,
                  HitBatch& hits, TraceContext& context);
void grid_occluded(const Geometry& geometry, const GridBlocks& blocks, const RayBatch& rays,
                   uint8_t* hit, TraceContext& context);

}  // namespace raio
