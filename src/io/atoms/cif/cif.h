// CIF and mmCIF by gemmi. What includes its documents is C++17: later versions evaluate containers
// of incomplete types at compile time, which clang refuses.
#pragma once

#include <gemmi/cifdoc.hpp>
#include <gemmi/elem.hpp>
#include <gemmi/unitcell.hpp>

#include "io/atoms/atom_site.h"
#include "io/atoms/atoms.h"

namespace raio {

inline uint8_t number_of(gemmi::Element element) { return uint8_t(element.atomic_number()); }

Cell cell_of(const gemmi::UnitCell& from);

/// A crystal by the parts of its cell, as the CIF of chemistry has it.
void add_crystal(gemmi::cif::Block& block, Atoms& out);

/// A ligand of the PDB's dictionary, by its ideal coordinates, else by those of a model or, of a
/// library of restraints, without a prefix: the first of these that no atom lacks.
void add_component(gemmi::cif::Block& block, Atoms& out);

/// Rows of _atom_site that were read from the text and cut out of what gemmi got of it.
struct CutRows {
  int line = 0;  // of the loop that they are from
  AtomSite rows;
};

/// The model of the number, negative from the end, of mmCIF; `cut` may be null.
void add_molecule(gemmi::cif::Block& block, CutRows* cut, int frame, Atoms& out);

}  // namespace raio
