#include <algorithm>
#include <cmath>

#include "io/atoms/colors.h"
#include "io/atoms/read.h"

namespace raio {
namespace {

constexpr float kTolerance = 0.45f, kLeast = 0.4f;
// Matter has some dozens in a cell of a few angstroms.
constexpr size_t kMostInCell = 1000;

float squared_distance(const Atom& a, const Atom& b) {
  float sum = 0;
  for (size_t i = 0; i < 3; ++i) sum += (a.place[i] - b.place[i]) * (a.place[i] - b.place[i]);
  return sum;
}

// A cell of a lattice as one number. Cells far apart may share one; what is in them is too far
// apart to be bonded anyway.
uint64_t cell_key(const std::array<int64_t, 3>& cell) {
  uint64_t key = 0;
  for (const int64_t c : cell) key = key << 21 | (uint64_t(c) & 0x1fffff);
  return key;
}

}  // namespace

std::optional<Bonds> find_bonds(const std::vector<Atom>& atoms) {
  Bonds bonds;
  float largest = 0;
  for (const Atom& atom : atoms) largest = std::max(largest, covalent_radius(atom.element));
  const double side = double(2 * largest + kTolerance);
  const auto cell_of = [&](const Atom& atom) {
    std::array<int64_t, 3> cell{};
    for (size_t i = 0; i < 3; ++i)
      cell[i] = int64_t(std::clamp(std::floor(double(atom.place[i]) / side), -1e15, 1e15));
    return cell;
  };
  std::vector<std::pair<uint64_t, uint32_t>> in_cells(atoms.size());
  for (uint32_t i = 0; i < atoms.size(); ++i) in_cells[i] = {cell_key(cell_of(atoms[i])), i};
  std::ranges::sort(in_cells);
  for (size_t i = kMostInCell; i < in_cells.size(); ++i)
    if (in_cells[i].first == in_cells[i - kMostInCell].first) return std::nullopt;
  for (uint32_t i = 0; i < atoms.size(); ++i) {
    const Atom& a = atoms[i];
    const auto cell = cell_of(a);
    const size_t first = bonds.size();
    for (int64_t n = 0; n < 27; ++n) {
      const uint64_t key =
          cell_key({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      auto at = std::ranges::lower_bound(in_cells, std::pair(key, i + 1));
      for (; at != in_cells.end() && at->first == key; ++at) {
        const Atom& b = atoms[at->second];
        if ((a.element == 1 && b.element == 1) || a.element == 0 || b.element == 0) continue;
        const float most = covalent_radius(a.element) + covalent_radius(b.element) + kTolerance;
        const float distance2 = squared_distance(a, b);
        if (distance2 <= most * most && distance2 >= kLeast * kLeast)
          bonds.push_back({i, at->second});
      }
    }
    std::sort(bonds.begin() + ptrdiff_t(first), bonds.end());
  }
  return bonds;
}

}  // namespace raio
