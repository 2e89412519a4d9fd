// Elements of atoms that have only names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/notices.h"

namespace raio {

/// What the place of a name in its field says: in PDB files symbols end in the second of the four
/// columns, so that " CA " is carbon and "CA  " calcium.
enum class NameField : uint8_t { free, one_letter, two_letters };

/// The element of an atom by its name and its residue's; 0: unknown. Atoms of amino acids,
/// nucleotides, water and lipids have symbols of one letter; an ion is called as its residue.
uint8_t element_of_names(std::string_view residue, std::string_view atom,
                         NameField field = NameField::free);

enum class ResidueKind : uint8_t { protein, nucleic, water, other };
/// By the names of the usual force fields, else by gemmi's table of modified residues.
ResidueKind residue_kind(std::string_view residue);

/// Whether atoms of this residue have symbols of one letter, but for selenium.
bool is_organic_residue(std::string_view residue);

/// The element that a symbol with a charge or a number begins with, such as "Fe3+"; 0: none.
uint8_t element_of_symbol(std::string_view symbol);

std::string_view without_blanks(std::string_view text);

/// Cases of one notice, collected in the order of the file.
class Cases {
 public:
  void add(std::string_view name, size_t line = 0);
  void tell(Notices& notices, Severity severity, std::string_view message) const;
  size_t count() const { return count_; }

 private:
  size_t count_ = 0, line_ = 0;
  std::vector<std::string> names_;
};

/// Elements that were guessed or are unknown, as notices.
struct ElementCases {
  Cases guessed, unknown;

  void add(uint8_t element, std::string_view name, size_t line = 0) {
    (element > 0 ? guessed : unknown).add(name, line);
  }
  void tell(Notices& notices) const;
};

}  // namespace raio
