#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include "base/executor.h"
#include "io/atoms/colors.h"
#include "io/atoms/read.h"

namespace raio::core {
namespace {

constexpr float kTolerance = 0.45f, kLeast = 0.4f;
// Real matter has a few dozen atoms in a cell of a few angstroms.
constexpr size_t kMaxInCell = 1000;

float squared_distance(const Atom& a, const Atom& b) {
  float sum = 0;
  for (size_t i = 0; i < 3; ++i) sum += (a.place[i] - b.place[i]) * (a.place[i] - b.place[i]);
  return sum;
}

// Nitrogen, oxygen, the elements below them and the halogens.
bool is_anion(uint8_t element) {
  static constexpr std::array<uint8_t, 9> kAnions = {7, 8, 9, 16, 17, 34, 35, 52, 53};
  return std::ranges::count(kAnions, element) > 0;
}

// Hashes a cell of the grid. Distant cells may collide; their atoms are too far apart to be bonded.
uint64_t cell_key(const std::array<int64_t, 3>& cell) {
  uint64_t key = 0;
  for (const int64_t c : cell) key = key << 21 | (uint64_t(c) & 0x1fffff);
  return key;
}

// The atoms bonded to each atom.
class Neighbours {
 public:
  Neighbours(size_t atoms, const Bonds& bonds) : first_(atoms + 1) {
    for (const auto& [a, b] : bonds) ++first_[a], ++first_[b];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    others_.resize(2 * bonds.size());
    for (const auto& [a, b] : bonds) others_[--first_[a]] = b, others_[--first_[b]] = a;
  }
  std::span<const uint32_t> of(uint32_t atom) const {
    return std::span(others_).subspan(first_[atom], first_[atom + 1] - first_[atom]);
  }

 private:
  std::vector<uint32_t> first_, others_;
};

// Metals are large, so the sum of radii also bonds them to atoms behind their ligand anions. Such a
// bond is bridged by an anion that is bonded to both ends and closer to the metal.
void drop_bridged(const std::vector<Atom>& atoms, Bonds& bonds) {
  const auto is_any_metal = [&](const auto& bond) {
    return is_metal(atoms[bond[0]].element) || is_metal(atoms[bond[1]].element);
  };
  if (std::ranges::none_of(bonds, is_any_metal)) return;
  const Neighbours neighbours(atoms.size(), bonds);
  const auto is_bridged = [&](uint32_t metal, uint32_t other) {
    if (!is_metal(atoms[metal].element) || is_anion(atoms[other].element)) return false;
    const float distance2 = squared_distance(atoms[metal], atoms[other]);
    return std::ranges::any_of(neighbours.of(metal), [&](uint32_t between) {
      return is_anion(atoms[between].element) &&
             squared_distance(atoms[metal], atoms[between]) < distance2 &&
             std::ranges::count(neighbours.of(other), between) > 0;
    });
  };
  StopCheck look;
  std::erase_if(bonds, [&](const auto& bond) {
    look();
    return is_bridged(bond[0], bond[1]) || is_bridged(bond[1], bond[0]);
  });
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
  StopCheck look;
  std::ranges::sort(in_cells, [&](const auto& a, const auto& b) {
    look();
    return a < b;
  });
  for (size_t i = kMaxInCell; i < in_cells.size(); ++i)
    if (in_cells[i].first == in_cells[i - kMaxInCell].first) return std::nullopt;
  for (uint32_t i = 0; i < atoms.size(); ++i) {
    look();
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
  drop_bridged(atoms, bonds);
  return bonds;
}

size_t add_traces(const std::vector<Atom>& atoms, Bonds& bonds) {
  std::vector<bool> is_bonded(atoms.size());
  for (const auto& [a, b] : bonds) is_bonded[a] = is_bonded[b] = true;
  const size_t before = bonds.size();
  for (uint32_t i = 1; i < atoms.size(); ++i) {
    const Atom &a = atoms[i - 1], &b = atoms[i];
    if (is_bonded[i - 1] || is_bonded[i] || a.element != b.element) continue;
    const float most = a.element == 6 ? 4.5f : a.element == 15 ? 8.f : 0;  // angstroms
    if (a.chain == b.chain && a.residue != b.residue && squared_distance(a, b) <= most * most)
      bonds.push_back({i - 1, i});
  }
  return bonds.size() - before;
}

}  // namespace raio::core
