// A lattice of cells over the centres replaces the items: one pass computes each cell's box and
// count, splits are between layers of cells, and a second pass moves the items.
#include <array>
#include <utility>

#include "accel/bvh/bins.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

constexpr int kCellBits = 12;
constexpr size_t kCells = size_t(1) << kCellBits;
constexpr int kMaxBits = 6;  // along an axis
constexpr int kMaxLayers = 1 << kMaxBits;
constexpr size_t kLeaf = size_t(1) << 15;  // items that need no further plan
constexpr size_t kMaxChunks = 32, kChunk = size_t(1) << 15;
constexpr size_t kBuffer = 256;

using Make = std::function<void(size_t, BuildRange)>;

// Calls f(item) for items first .. end - 1.
template <class F>
void for_items(const Make& make, size_t first, size_t end, F&& f) {
  std::array<BuildItem, kBuffer> buffer;
  for (; first < end; first += kBuffer) {
    check_stop();
    const BuildRange some(buffer.data(), std::min(kBuffer, end - first));
    make(first, some);
    for (const BuildItem& item : some) f(item);
  }
}

// Cells as close to cubes as powers of two allow.
std::array<int, 3> layers(Vec3f size) {
  std::array<int, 3> n{1, 1, 1};
  for (int bit = 0; bit < kCellBits; ++bit) {
    int widest = -1;
    for (int a = 0; a < 3; ++a)
      if (n[a] < kMaxLayers &&
          (widest < 0 || size[a] / float(n[a]) > size[widest] / float(n[widest])))
        widest = a;
    n[widest] *= 2;
  }
  return n;
}

// The bounds of the centres, from a sample: outliers that it misses do not matter to the rest.
Binning sampled_binning(size_t count, const Make& make, std::array<int, 3>& n) {
  constexpr size_t kSamples = 4096, kStride = 2654435761;  // prime
  Float4 from = splat(std::numeric_limits<float>::infinity()), to = -from;
  for (size_t i = 0; i < kSamples; ++i) {
    BuildItem item;
    make(i * kStride % count, {&item, 1});
    from = min(from, item.center2());
    to = max(to, item.center2());
  }
  n = layers(BuildBox{from, -to}.box().size());
  return Binning(from, to, n);
}

class Planner {
 public:
  Planner(std::span<PrimitiveId> out, const Make& make)
      : out_(out), make_(make), binning_(sampled_binning(out.size(), make, n_)) {
    chunks_ = std::clamp<size_t>(out.size() / kChunk, 1, kMaxChunks);
  }

  BuildPlan plan() {
    std::vector<Column<Cell>> tables(chunks_);
    parallel_for(chunks_, [&](size_t c) { fill(c, tables[c]); });
    cells_.assign(kCells, Cell());
    for (const Column<Cell>& table : tables)
      for (size_t i = 0; i < kCells; ++i) {
        cells_[i].box.extend(table[i].box);
        cells_[i].count += table[i].count;
      }
    leaf_of_.resize(kCells);
    plan_.nodes.emplace_back();
    plan_.nodes[0].end = out_.size();
    for (const Cell& cell : cells_) plan_.nodes[0].box.extend(cell.box);
    split(0, {{0, 0, 0}, n_}, 0);

    // Where each chunk writes its next item of each leaf.
    std::vector<std::vector<size_t>> next(chunks_, std::vector<size_t>(leaf_begin_.size()));
    for (size_t c = 0; c < chunks_; ++c)
      for (size_t i = 0; i < kCells; ++i) next[c][leaf_of_[i]] += tables[c][i].count;
    for (size_t leaf = 0; leaf < leaf_begin_.size(); ++leaf) {
      size_t at = leaf_begin_[leaf];
      for (size_t c = 0; c < chunks_; ++c) at += std::exchange(next[c][leaf], at);
    }
    parallel_for(chunks_, [&](size_t c) {
      for_items(make_, begin(c), begin(c + 1), [&](const BuildItem& item) {
        out_[next[c][leaf_of_[cell_of(item)]]++] = item.id();
      });
    });
    return std::move(plan_);
  }

 private:
  struct Cell {
    BuildBox box;
    size_t count = 0;
  };
  // Layers lo .. hi - 1 along each axis.
  struct Region {
    std::array<int, 3> lo, hi;
  };

  size_t begin(size_t chunk) const { return out_.size() * chunk / chunks_; }

  size_t cell(int x, int y, int z) const { return (size_t(z) * n_[1] + y) * n_[0] + x; }
  size_t cell_of(const BuildItem& item) const {
    const Int4 at = binning_.of(item.center2());
    return cell(at[0], at[1], at[2]);
  }

  void fill(size_t chunk, Column<Cell>& table) const {
    table.assign(kCells, Cell());
    for_items(make_, begin(chunk), begin(chunk + 1), [&](const BuildItem& item) {
      Cell& cell = table[cell_of(item)];
      cell.box.extend(item);
      ++cell.count;
    });
  }

  template <class F>
  void for_cells(const Region& r, F&& f) const {
    for (int z = r.lo[2]; z < r.hi[2]; ++z)
      for (int y = r.lo[1]; y < r.hi[1]; ++y)
        for (int x = r.lo[0]; x < r.hi[0]; ++x) f(x, y, z);
  }

  void split(uint32_t node, const Region& region, int depth) {
    const size_t begin = plan_.nodes[node].begin, end = plan_.nodes[node].end;
    Bins<kMaxLayers> bins;
    BinSplit best;
    if (end - begin > kLeaf && depth < kPlanDepth) {
      for_cells(region, [&](int x, int y, int z) {
        const Cell& c = cells_[cell(x, y, z)];
        const Int4 at = {x - region.lo[0], y - region.lo[1], z - region.lo[2], 0};
        if (c.count > 0) bins.add(c.box, at, int32_t(c.count));
      });
      int most = 0;
      for (int a = 0; a < 3; ++a) most = std::max(most, region.hi[a] - region.lo[a]);
      best = bins.best(int32_t(end - begin), most);
    }
    if (best.axis < 0) {
      for_cells(region, [&](int x, int y, int z) {
        leaf_of_[cell(x, y, z)] = uint32_t(leaf_begin_.size());
      });
      leaf_begin_.push_back(begin);
      return;
    }
    const int a = best.axis;
    Region below = region, above = region;
    below.hi[a] = above.lo[a] = region.lo[a] + best.bin;
    size_t middle = begin;
    for_cells(below, [&](int x, int y, int z) { middle += cells_[cell(x, y, z)].count; });
    const uint32_t kid = uint32_t(plan_.nodes.size());
    plan_.nodes[node].below = kid, plan_.nodes[node].above = kid + 1;
    plan_.nodes.push_back({begin, middle, bins.box(a, 0, best.bin)});
    plan_.nodes.push_back({middle, end, bins.box(a, best.bin, kMaxLayers)});
    split(kid, below, depth + 1);
    split(kid + 1, above, depth + 1);
  }

  std::span<PrimitiveId> out_;
  const Make& make_;
  std::array<int, 3> n_;
  Binning binning_;
  size_t chunks_;
  std::vector<Cell> cells_;
  std::vector<uint32_t> leaf_of_;   // per cell
  std::vector<size_t> leaf_begin_;  // per leaf of the plan
  BuildPlan plan_;
};

}  // namespace

BuildPlan make_plan(std::span<PrimitiveId> out, const Make& make) {
  return Planner(out, make).plan();
}

}  // namespace raio::core
