// Atoms as files have them, whatever the format. Also included by cif/, which is C++17.
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

#include "io/notices.h"

namespace raio {

struct Atom {
  std::array<float, 3> place{};  // angstroms
  uint8_t element = 0;           // its number; 0: unknown
  uint32_t chain = 0;            // into Atoms::chains
  uint32_t part = 0;             // what assemblies name, as `chain` where they name chains; or the
                                 // type, from 1, of LAMMPS
  uint32_t residue = 0;          // counted through the file
  float occupancy = 1, b_factor = 0;
};

struct Residue {
  std::array<char, 8> name{};  // ends with zeros; longer names are cut
  int number = 0;              // as the file has it

  std::string_view view() const {
    size_t size = 0;
    while (size < name.size() && name[size] != 0) ++size;
    return {name.data(), size};
  }
};
/// Of a name and a number such as "12A", whose letter does not count.
Residue residue_of(std::string_view name, std::string_view number);

/// A biological assembly: copies of parts, each moved by the matrices.
struct Assembly {
  struct Copies {
    std::vector<uint32_t> parts;
    std::vector<std::array<float, 12>> matrices;  // three rows of four numbers
  };
  std::vector<Copies> copies;
};

/// The box that atoms repeat in without end.
struct Cell {
  std::array<double, 3> origin{};
  std::array<std::array<double, 3>, 3> sides{};   // a, b and c
  std::array<bool, 3> repeats{true, true, true};  // along these
};

/// A bond to an atom of another copy of the cell, so many sides away.
struct BondAcross {
  std::array<uint32_t, 2> atoms{};
  std::array<int, 3> cells{};  // from the first atom's to the second one's
};

struct Atoms {
  std::array<double, 3> origin{};  // what the atoms' places are relative to
  std::vector<Atom> atoms;
  std::vector<std::string> chains;
  std::vector<Residue> residues;  // by Atom::residue, or empty
  std::vector<Assembly> assemblies;
  std::map<std::string, uint32_t, std::less<>> types;  // the numbers of those that have a name
  std::optional<Cell> cell;
  size_t frames = 1;         // that the file has
  std::vector<float> radii;  // of the atoms, or empty
  std::vector<float>
      values;  // the atoms' numbers of the column that colours were asked of, or empty
  std::vector<std::string> columns;            // of numbers, which colours could be asked of
  std::vector<std::array<uint32_t, 2>> bonds;  // that the file lists
  std::vector<BondAcross> bonds_across;        // likewise
  bool finds_bonds = true;                     // whether there are others by distance
  Notices notices;                             // of what the reader guessed, cut or left out
  // Whether the file has what colours are asked of: chains, residues, B factors and occupancies.
  bool has_residues = false, has_b_factors = false, has_occupancies = false;

  /// A place of the file as an atom has it.
  std::array<float, 3> local(const std::array<double, 3>& place) const {
    return {float(place[0] - origin[0]), float(place[1] - origin[1]), float(place[2] - origin[2])};
  }
  /// Where the atom is in the file.
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

/// The records CRYST1 and SCALE of a PDB file.
struct PdbCrystal {
  std::array<double, 6> lengths_and_angles{};   // zeros: there is none
  std::string group;                            // Hermann-Mauguin
  std::optional<std::array<double, 12>> scale;  // three rows of four numbers
};

/// The cell of these records, by gemmi; nothing where the file says that it is no crystal. Where
/// SCALE disagrees with CRYST1 it is that of SCALE, and a notice says so.
std::optional<Cell> cell_of(const PdbCrystal& crystal, Notices& notices);

/// Whether of all copies of the crystal the second place is nearest to the first as it stands.
bool is_nearest_copy(const PdbCrystal& crystal, const std::array<double, 3>& from,
                     const std::array<double, 3>& to);

/// Reads a CIF text into `out`, of its frames that of the number, negative from the end. Where a
/// residue has several conformers it is the first. Of a file that gives a crystal by the parts of
/// its cell, all atoms in one cell. Returns what is wrong, or nothing; a frame that there is not is
/// no error, but leaves `out` without atoms.
struct CifFault {
  std::string message;
  size_t line = 0, column = 0;  // from 1; 0: about the file as a whole
};
/// With `cuts_rows` atoms of mmCIF are read from the lines of the text where they have one each,
/// with the same result.
std::optional<CifFault> read_structure(const char* text, size_t size, int frame, Atoms& out,
                                       bool cuts_rows = true);

/// Tells of atoms that are at one place; name_of() gives the name of an atom by its index.
void note_coincident(Atoms& atoms, const std::function<std::string(uint32_t)>& name_of);

}  // namespace raio
