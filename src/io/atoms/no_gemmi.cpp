// In place of cif/ in builds with RAIO_GEMMI=OFF.
#include "io/atoms/atoms.h"

namespace raio {
namespace {

// A cell with a side of 1 or without angles is that of no crystal, as gemmi has it.
bool is_crystal(const PdbCrystal& crystal) {
  return crystal.lengths_and_angles[0] != 1 && crystal.lengths_and_angles[5] != 0;
}

}  // namespace

std::optional<CifFault> read_structure(const char*, size_t, int, Atoms&, bool) {
  return CifFault{"this build reads no CIF; use one with RAIO_GEMMI=ON, or a file in PDB format"};
}

std::optional<Cell> cell_of(const PdbCrystal& crystal, Notices& notices) {
  if (is_crystal(crystal))
    notices.add_whole(Severity::left_out,
                      "the cell, and links to an atom of which the nearest copy counts, as this "
                      "build has no gemmi; use one with RAIO_GEMMI=ON");
  return std::nullopt;
}

bool is_nearest_copy(const PdbCrystal& crystal, const std::array<double, 3>&,
                     const std::array<double, 3>&) {
  return !is_crystal(crystal);
}

}  // namespace raio
