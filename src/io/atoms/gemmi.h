// What Raio uses of gemmi: the parser of CIF, unit cells and symmetry. Only gemmi.cpp includes
// gemmi's headers, and is C++17: later standards evaluate containers of incomplete types at compile
// time, which clang rejects. It includes nothing of Raio but this header of plain data, so no
// function of ours or of gemmi is compiled by two standards. Errors of gemmi are exceptions.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace raio::core::cif {

/// A loop, or a pair of a tag and its value. Values are as in the file, with quotes.
struct Item {
  std::vector<std::string> tags, values;
  int line = 0;
  bool is_loop = false;
};
struct Block {
  std::string name;
  std::vector<Item> items;
};
struct Document {
  std::vector<Block> blocks;
  std::string duplicates;  // gemmi's message about tags and names of blocks that occur twice
};
/// Calls `look` for each value of a loop; an exception from it ends the work.
Document parse(const char* text, size_t size, const std::function<void()>& look);

/// The CRYST1 and SCALE records of a PDB file.
struct CellRecords {
  std::array<double, 6> lengths_and_angles{};   // zeros: there is none
  std::string group;                            // Hermann-Mauguin symbol
  std::optional<std::array<double, 12>> scale;  // three rows of four numbers
};

struct UnitCell {
  std::array<std::array<double, 3>, 3> matrix{};  // rows; from fractions to angstroms
  std::array<double, 3> shift{};
  std::array<double, 3> reciprocal{};  // lengths
  double alpha = 0, gamma = 0;         // degrees
  bool is_crystal = false;
  bool matrix_disagrees = false;  // the file's matrix, with lengths and angles; it is used
  /// Whether the second position, untransformed, is the nearest of all its symmetry mates to the
  /// first, which it also is if there is no crystal.
  std::function<bool(const std::array<double, 3>&, const std::array<double, 3>&)> is_nearest;
};
/// The exception says why there is none.
UnitCell unit_cell(const CellRecords& records);

/// A symmetry operation on fractions, in parts of kParts.
inline constexpr int kParts = 24;
struct Operation {
  std::array<std::array<int, 3>, 3> rotation;
  std::array<int, 3> translation;
};
/// From text such as "x,y,z+1/2".
Operation parse_operation(const std::string& text);
std::vector<Operation> operations_of_hall(const std::string& symbol);
/// Those of a space group by its name or, without one, its number; nothing if there is no such
/// group.
std::vector<Operation> operations_of_group(const std::string& name, const UnitCell& cell);
std::vector<Operation> operations_of_group(int number);

/// A site of a crystal.
struct Site {
  std::string label;
  std::array<double, 3> place{};  // fractions
  double occupancy = 1, b_factor = 0;
  int disorder_group = 0;
  int element = 0;
};
struct Crystal {
  UnitCell cell;
  std::string group;  // Hermann-Mauguin symbol
  std::vector<Site> sites;
};
Crystal crystal_of(Block block);

struct ResidueNumber {
  std::optional<int> number;
  char insertion = ' ';
};
/// An atom of mmCIF by its names.
struct AtomAddress {
  std::string chain, residue, atom;
  ResidueNumber number;
  char conformer = 0;  // '*': any
};
/// A connection of struct_conn, apart from hydrogen bonds and bonds to symmetry mates.
struct Link {
  AtomAddress ends[2];
  bool may_be_to_mate = false;  // the file does not say whether it leads to a symmetry mate
};
struct Molecule {
  UnitCell cell;
  std::vector<Link> links;
};
Molecule molecule_of(Block block);

}  // namespace raio::core::cif
