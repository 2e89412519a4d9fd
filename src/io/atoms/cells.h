// Periodic images of a cell, and atoms on its faces.
#pragma once

#include <array>
#include <vector>

#include "base/vec.h"
#include "io/atoms/atoms.h"
#include "io/atoms/gemmi.h"

namespace raio::core {

Cell cell_of(const cif::UnitCell& from);

/// Translations from the cell to its images; the first image is the cell itself.
std::vector<Vec3d> shifts_of(const Atoms& atoms, const std::array<int, 3>& images);

/// The atoms of all images, so that bonds connect neighbouring images. `shifts` are from
/// shifts_of().
Atoms repeated(const Atoms& atoms, const std::vector<Vec3d>& shifts,
               const std::array<int, 3>& images);

/// Whether the atoms span more than half of the cell along two of its sides, or are as dense as in
/// a crystal. False if the cell is flat.
bool fill_cell(const Atoms& atoms);

/// Repeats atoms on a face, edge or corner of the block of all `images` on the opposite ones,
/// unless there is an atom already. A notice counts them.
void complete_border(Atoms& atoms, const std::array<int, 3>& images);

}  // namespace raio::core
