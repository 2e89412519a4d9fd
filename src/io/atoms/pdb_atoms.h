// Atom lines of PDB and PQR, and the atoms made of them.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/element_names.h"
#include "io/atoms/lines.h"
#include "io/atoms/names.h"
#include "io/atoms/pdb_records.h"

namespace raio::core {

/// A part of a line.
struct Span {
  uint8_t at = 0, size = 0;
};

/// A line; it is an atom if it has a text.
struct PdbRow {
  const char* text = nullptr;
  std::array<float, 3> place{};
  float occupancy = 1, b_factor = 0;  // charge and radius in PQR
  bool has_occupancy = false, has_b_factor = false;
  Span serial, name, residue, chain, sequence;
  char conformer = ' ';
  uint8_t element = 0;
  NameField field = NameField::free;
  bool has_place = true, needs_guess = false, has_numbers = true;

  std::string_view part(Span span) const { return {text + span.at, span.size}; }
};

/// Reads a row of atoms that will be added to `out`.
std::optional<LineFault> read_pdb_row(std::string_view line, const Atoms& out, PdbRow& row);
std::optional<LineFault> read_pqr_row(std::string_view line, const Atoms& out, PdbRow& row);

/// Whether this is an atom line with fields separated by blanks that does not fit the columns of
/// PDB.
bool is_pqr_line(std::string_view line);

/// Guesses elements of rows that have none.
void guess_elements(std::vector<PdbRow>& rows);

/// A bond of a LINK or SSBOND record.
struct PdbLink {
  struct End {
    std::string_view residue, chain, sequence, name;  // no name: the first sulphur
    char conformer = ' ';
    uint32_t atom = kLeftOut;
  };
  std::array<End, 2> ends;
  bool says_copy = false, leads_elsewhere = false;
};

std::optional<PdbLink> link_of(std::string_view line, bool is_ssbond);

/// Converts rows to atoms, one at a time.
class PdbAssembler {
 public:
  PdbAssembler(Atoms& out, Names& chains, size_t first_line)
      : out_(out), chains_(chains), first_line_(first_line) {}

  void add(const std::vector<PdbRow>& rows, bool is_pqr, bool with_serials,
           std::vector<PdbLink>& links);

  Serials serials;
  std::vector<float> charges;
  std::vector<uint32_t> row_of;  // by atom

 private:
  struct Chosen {
    char conformer = ' ';
    uint32_t atom = 0;
  };

  bool takes(const PdbRow& row, size_t line);
  bool takes_residue(const PdbRow& row, size_t line);
  void begin_position(const PdbRow& row);
  void find_chosen();
  void find_ends(const PdbRow& row, std::vector<PdbLink>& links);

  Atoms& out_;
  Names& chains_;
  const size_t first_line_;
  const PdbRow* position_ = nullptr;  // the first row of this chain and residue number
  const PdbRow* residue_ = nullptr;   // the last residue that was kept
  std::string_view left_out_;         // name of a residue at the position of another
  std::vector<std::pair<std::string_view, Chosen>>
      taken_;  // at this chain and number; moved to chosen_ when searched
  std::unordered_map<std::string_view, Chosen> chosen_;  // by atom name
  bool is_searched_ = false;
  std::unordered_map<std::string, std::vector<PdbLink::End*>> ends_;  // ends of links by residue
  const std::vector<PdbLink::End*>* ends_here_ = nullptr;
  Cases conformers_, residues_, placeless_, numberless_, radiusless_;
};

}  // namespace raio::core
