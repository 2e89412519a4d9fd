// Unit cells by gemmi.
#include <gemmi/unitcell.hpp>

#include "io/atoms/cif/cif.h"

namespace raio::core {
namespace {

gemmi::UnitCell unit_cell(const PdbCrystal& crystal, bool* disagrees = nullptr) {
  gemmi::UnitCell cell;
  const auto& n = crystal.lengths_and_angles;
  cell.set(n[0], n[1], n[2], n[3], n[4], n[5]);
  if (crystal.scale) {
    gemmi::Transform fraction;
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k)
        fraction.mat[row][k] = (*crystal.scale)[4 * size_t(row) + size_t(k)];
      fraction.vec.at(row) = (*crystal.scale)[4 * size_t(row) + 3];
    }
    cell.set_matrices_from_fract(fraction);
    if (disagrees) *disagrees = cell.explicit_matrices;
  }
  return cell;
}

}  // namespace

Cell cell_of(const gemmi::UnitCell& from) {
  Cell cell;
  for (size_t side = 0; side < 3; ++side)
    for (size_t i = 0; i < 3; ++i) cell.sides[side][i] = from.orth.mat[i][side];
  return cell;
}

std::optional<Cell> cell_of(const PdbCrystal& crystal, Notices& notices) try {
  bool disagrees = false;
  const gemmi::UnitCell cell = unit_cell(crystal, &disagrees);
  if (!cell.is_crystal()) return std::nullopt;
  if (disagrees)
    notices.add_whole(Severity::warning,
                      "the SCALE records disagree with CRYST1; SCALE is used for the cell");
  return cell_of(cell);
} catch (const std::runtime_error&) {
  notices.add_whole(Severity::left_out, "the cell, since the angles in CRYST1 are impossible");
  return std::nullopt;
}

bool is_nearest_copy(const PdbCrystal& crystal, const std::array<double, 3>& from,
                     const std::array<double, 3>& to) try {
  gemmi::UnitCell cell = unit_cell(crystal);
  if (!cell.is_crystal()) return true;
  cell.set_cell_images_from_spacegroup(
      gemmi::find_spacegroup_by_name(crystal.group, cell.alpha, cell.gamma));
  return cell
      .find_nearest_image({from[0], from[1], from[2]}, {to[0], to[1], to[2]}, gemmi::Asu::Any)
      .same_asu();
} catch (const std::runtime_error&) {
  return true;
}

}  // namespace raio::core
