// Copies of a cell, and of what is on its border.
#pragma once

#include <array>
#include <vector>

#include "base/vec.h"
#include "io/atoms/atoms.h"

namespace raio {

/// From the cell to its copies, of which the first is the cell itself.
std::vector<Vec3d> shifts_of(const Atoms& atoms, const std::array<int, 3>& images);

/// With the copies of the cell as atoms, so that bonds lead from one to the next. `shifts` are
/// those of the images.
Atoms repeated(const Atoms& atoms, const std::vector<Vec3d>& shifts,
               const std::array<int, 3>& images);

/// Do the atoms reach over half of the cell along two of its sides, or have they no more room than
/// those of crystals? Not if it is flat.
bool fill_cell(const Atoms& atoms);

/// Adds the atoms that lie on a face, edge or corner of all `images` of the cell on the opposite
/// ones, too, where there is none yet. A notice counts them.
void complete_border(Atoms& atoms, const std::array<int, 3>& images);

}  // namespace raio
