// Guesses elements of atoms that have only names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/notices.h"

namespace raio::core {

/// The alignment of a name in its field: in PDB files a symbol ends in the second of four columns,
/// so " CA " is carbon and "CA  " is calcium.
enum class NameField : uint8_t { free, one_letter, two_letters };

/// The element of an atom by its name and its residue's name; 0 if unknown. Atoms of amino acids,
/// nucleotides, water and lipids have one-letter symbols; an ion has the name of its residue.
uint8_t element_of_names(std::string_view residue, std::string_view atom,
                         NameField field = NameField::free);

enum class ResidueKind : uint8_t { protein, nucleic, water, other };
/// By residue names of common force fields, else by a table of modified residues.
ResidueKind residue_kind(std::string_view residue);

/// Whether atoms of this residue have one-letter symbols, apart from selenium.
bool is_organic_residue(std::string_view residue);

/// The element at the start of a symbol with a charge or a number, such as "Fe3+"; 0 if none.
uint8_t element_of_symbol(std::string_view symbol);

std::string_view without_blanks(std::string_view text);

/// Collects the cases of one notice in the order of the file.
class Cases {
 public:
  void add(std::string_view name, size_t line = 0);
  void tell(Notices& notices, Severity severity, std::string_view message) const;
  size_t count() const { return count_; }

 private:
  size_t count_ = 0, line_ = 0;
  std::vector<std::string> names_;
};

/// Notices about guessed and unknown elements.
struct ElementCases {
  Cases guessed, unknown;

  void add(uint8_t element, std::string_view name, size_t line = 0) {
    (element > 0 ? guessed : unknown).add(name, line);
  }
  void tell(Notices& notices) const;
};

}  // namespace raio::core
