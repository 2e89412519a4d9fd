// Which atoms of a file are drawn: `only`, `hide` and `show` of ReadOptions.
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "io/read_scene.h"

namespace raio {

struct Atoms;

/// What is wrong with the text of a selection, with its column; empty: nothing.
///
///     water   hydrogen   ion   ligand   protein   nucleic   all
///     element C,N   type 1,3-5   chain A,B   residue ALA,5-12   index 0-99
///
/// These are joined by `not`, `and`, `or` (a comma means the same) and parentheses; `not` binds
/// first, then `and`.
std::string selection_problem(std::string_view text);

/// Whether there are amino acids or nucleotides.
bool has_polymer(const Atoms& atoms);

/// Leaves out what `only`, `hide` and `show` do not choose, with its bonds. `fills`: the atoms fill
/// their space, where water and ions would hide a protein. The error says which option does not fit
/// the file.
std::expected<void, std::string> select_atoms(Atoms& atoms, const ReadOptions& options, bool fills);

}  // namespace raio
