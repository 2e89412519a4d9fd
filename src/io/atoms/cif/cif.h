// CIF and mmCIF: the atoms of a parsed block.
#pragma once

#include "io/atoms/atom_site.h"
#include "io/atoms/atoms.h"
#include "io/atoms/gemmi.h"

namespace raio::core::cif {

/// A crystal given by its asymmetric unit, as in small-molecule CIF.
void add_crystal(Block block, Atoms& out);

/// A ligand of the PDB's chemical component dictionary, by its ideal coordinates, those of a model
/// or, in a library of restraints, those without a prefix: the first of these that all atoms have.
void add_component(const Block& block, Atoms& out);

/// Rows of _atom_site that were read from the text and removed before gemmi parsed it.
struct CutRows {
  int line = 0;  // line of their loop
  AtomSite rows;
};

/// The model of mmCIF with this index, negative from the end; `cut` may be null.
void add_molecule(Block block, CutRows* cut, int frame, Atoms& out);

}  // namespace raio::core::cif
