// CIF and mmCIF by gemmi. Files that include its documents are C++17: later standards evaluate
// containers of incomplete types at compile time, which clang rejects.
#pragma once

#include <gemmi/cifdoc.hpp>
#include <gemmi/elem.hpp>
#include <gemmi/unitcell.hpp>

#include "io/atoms/atom_site.h"
#include "io/atoms/atoms.h"

namespace raio::core {

inline uint8_t number_of(gemmi::Element element) { return uint8_t(element.atomic_number()); }

Cell cell_of(const gemmi::UnitCell& from);

/// A crystal given by its asymmetric unit, as in small-molecule CIF.
void add_crystal(gemmi::cif::Block& block, Atoms& out);

/// A ligand of the PDB's chemical component dictionary, by its ideal coordinates, those of a model
/// or, in a library of restraints, those without a prefix: the first of these that all atoms have.
void add_component(gemmi::cif::Block& block, Atoms& out);

/// Rows of _atom_site that were read from the text and removed before gemmi parsed it.
struct CutRows {
  int line = 0;  // line of their loop
  AtomSite rows;
};

/// The model of mmCIF with this index, negative from the end; `cut` may be null.
void add_molecule(gemmi::cif::Block& block, CutRows* cut, int frame, Atoms& out);

}  // namespace raio::core
