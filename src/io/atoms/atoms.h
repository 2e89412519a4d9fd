// Atoms as files have them, in any format.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/atoms/marks.h"
#include "io/notices.h"

namespace raio::core {

struct Atom {
  std::array<float, 3> place{};  // angstroms
  uint8_t element = 0;           // atomic number; 0: unknown
  uint8_t own_color = 0;         // of ReadOptions::color_atoms, from 1; 0: none
  uint32_t chain = 0;            // index into Atoms::chains
  uint32_t part = 0;             // what assemblies name, as `chain` where they name chains; or the
                                 // type, from 1, of LAMMPS
  uint32_t residue = 0;          // counted through the file
  float occupancy = 1, b_factor = 0;
};

struct Residue {
  std::array<char, 8> name{};  // ends with zeros; longer names are cut
  char insertion = ' ';        // the letter after the number
  int number = 0;              // as in the file

  std::string_view view() const {
    size_t size = 0;
    while (size < name.size() && name[size] != 0) ++size;
    return {name.data(), size};
  }
};
/// From a name and a number such as "12A".
Residue residue_of(std::string_view name, std::string_view number);

/// A biological assembly: parts, each transformed by the matrices.
struct Assembly {
  struct Copies {
    std::vector<uint32_t> parts;
    std::vector<std::array<float, 12>> matrices;  // three rows of four numbers
  };
  std::vector<Copies> copies;
};

/// The unit cell or simulation box, repeated without end.
struct Cell {
  std::array<double, 3> origin{};
  std::array<std::array<double, 3>, 3> sides{};   // a, b and c
  std::array<bool, 3> repeats{true, true, true};  // by axis
};

/// A bond to an atom in another image of the cell, this many sides away.
struct BondAcross {
  std::array<uint32_t, 2> atoms{};
  std::array<int, 3> cells{};  // from the first atom's image to the second's
};

struct Atoms {
  std::array<double, 3> origin{};  // positions of atoms are relative to it
  std::vector<Atom> atoms;
  std::vector<std::string> chains;
  std::vector<Residue> residues;  // indexed by Atom::residue, or empty
  std::vector<Assembly> assemblies;
  std::map<std::string, uint32_t, std::less<>> types;  // numbers of named types
  std::optional<Cell> cell;
  size_t frames = 1;                 // in the file
  std::vector<float> radii;          // per atom, or empty
  std::vector<float> values;         // per atom, of the column that `color_by` names, or empty
  std::vector<std::string> columns;  // names of numeric columns that `color_by` may take
  std::vector<std::array<uint32_t, 2>> bonds;  // listed in the file
  std::vector<BondAcross> bonds_across;        // likewise
  std::optional<AtomMarks> marks;              // of the atoms read, if asked for
  // With marks: the index of each atom among those read; empty: its own.
  std::vector<uint32_t> indices;
  bool finds_bonds = true;  // whether bonds are also found by distance
  Notices notices;          // on what the reader guessed, cut or left out
  // Whether the file has these, for `color_by`.
  bool has_residues = false, has_b_factors = false, has_occupancies = false;

  /// A position of the file, relative to the origin.
  std::array<float, 3> local(const std::array<double, 3>& place) const {
    return {float(place[0] - origin[0]), float(place[1] - origin[1]), float(place[2] - origin[2])};
  }
  /// The index of the atom among those read, as in the selection `index`.
  uint32_t index_of(uint32_t atom) const { return indices.empty() ? atom : indices[atom]; }
  /// The position of the atom in the file.
  std::array<double, 3> place_of(const Atom& atom) const {
    return {origin[0] + double(atom.place[0]), origin[1] + double(atom.place[1]),
            origin[2] + double(atom.place[2])};
  }
};

/// Whether the element of any atom is known.
inline bool any_element(const Atoms& atoms) {
  return std::any_of(atoms.atoms.begin(), atoms.atoms.end(),
                     [](const Atom& a) { return a.element > 0; });
}

/// Reads a CIF text into `out`: the frame with this index, negative from the end, and the first
/// conformer of each residue. A crystal given by its asymmetric unit becomes all atoms of one unit
/// cell. Returns the fault, or nothing. A frame that does not exist is not a fault, but leaves
/// `out` without atoms.
struct CifFault {
  std::string message;
  size_t line = 0, column = 0;  // from 1; 0: about the whole file
};
/// With `cuts_rows`, atoms of mmCIF with one line each are read from the text directly, with the
/// same result.
std::optional<CifFault> read_structure(const char* text, size_t size, int frame, Atoms& out,
                                       bool cuts_rows = true);

/// Adds a notice about atoms at the same position; name_of() gives the name of an atom by its
/// index.
void note_coincident(Atoms& atoms, const std::function<std::string(uint32_t)>& name_of);

}  // namespace raio::core
