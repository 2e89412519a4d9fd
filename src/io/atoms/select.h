// Selects the atoms to draw and to colour: `only`, `hide`, `show` and `color-atoms` of ReadOptions.
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "io/read_scene.h"

namespace raio::core {

struct Atoms;

/// The error in a selection, with its column; empty if there is none.
///
///     water   hydrogen   ion   ligand   protein   nucleic   all
///     element C,N   type 1,3-5   chain A,B   residue ALA,5-12   index 0-99
///
/// Terms are joined by `not`, `and`, `or` (or a comma) and parentheses; `not` binds tightest, then
/// `and`.
std::string selection_problem(std::string_view text);

/// Whether there are amino acids or nucleotides.
bool has_polymer(const Atoms& atoms);

/// Sets Atom::own_color, and removes unselected atoms and their bonds. `fills`: the style is
/// space-filling, in which water and ions hide a protein. The error names the option that does not
/// fit the file.
std::expected<void, std::string> select_atoms(Atoms& atoms, const ReadOptions& options, bool fills);

}  // namespace raio::core
