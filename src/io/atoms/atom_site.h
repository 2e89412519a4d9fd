// The rows of _atom_site of mmCIF and the atoms made of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/element_names.h"
#include "io/atoms/gemmi.h"
#include "io/atoms/names.h"

namespace raio::core {

/// The columns that are read.
enum class SiteColumn : uint8_t {
  id,
  symbol,
  name,
  name_of_element,  // name and residue for guessing the element
  residue_of_element,
  conformer,
  residue,
  chain,
  part,
  label_number,
  number,
  insertion,
  x,
  y,
  z,
  occupancy,
  b_factor,
  charge,
  model
};
inline constexpr size_t kSiteColumns = size_t(SiteColumn::model) + 1;

/// The values of a row as in the file, with quotes.
struct SiteValues : std::array<std::string_view, kSiteColumns> {
  using std::array<std::string_view, kSiteColumns>::operator[];
  std::string_view& operator[](SiteColumn column) { return (*this)[size_t(column)]; }
  std::string_view operator[](SiteColumn column) const { return (*this)[size_t(column)]; }
};

/// Columns of whole numbers; gemmi ignores values that do not fit in an int.
inline constexpr SiteColumn kWholeNumbers[] = {SiteColumn::id, SiteColumn::label_number,
                                               SiteColumn::number, SiteColumn::charge};

struct SiteRow {
  const char* line = nullptr;           // the start of its text, or
  const std::string* values = nullptr;  // the values from gemmi
  std::array<float, 3> place{};
  float occupancy = 1, b_factor = 0;
  uint8_t element = 0;
  char conformer = 0;       // 0: none
  bool is_readable = true;  // whether gemmi can read it
};

/// Consecutive rows of one residue.
struct SiteRun {
  size_t first = 0;  // index in its part
  const SiteRow *begin = nullptr, *end = nullptr;
  std::string_view model, chain, residue, part;
  cif::ResidueNumber number;
  bool has_label_number = true;  // the label number is readable, or missing
  size_t next = SIZE_MAX;        // the next run of the same residue
};

/// The loop of _atom_site in a text.
struct SiteLoop {
  std::vector<std::string> tags;
  size_t line = 0;             // line of the word loop_, from 1
  const char* rows = nullptr;  // the start of the rows
};

/// The first such loop, if each tag is on its own line.
std::optional<SiteLoop> find_atom_site(std::string_view text);

/// Reads rows in parallel and groups them into models, chains and residues as gemmi does.
class AtomSite {
 public:
  /// For columns with these tags; positions are relative to the origin.
  AtomSite(const std::vector<std::string>& tags, const std::array<double, 3>& origin);

  /// Reads rows at the beginning of the text that have one line each. Returns the start of the last
  /// one, or of the text if there is none.
  const char* add_lines(std::string_view text);
  /// Reads the rows from gemmi; the first one is skipped if lines were read, since these end in it.
  void add_values(std::vector<std::string> values);

  /// Finds residues, chains and models. Notices report guessed and skipped values.
  void group(Notices& notices);
  size_t models() const { return models_.size(); }

  /// Rows for gemmi, with the tags that it needs: the first row of each model or residue, and the
  /// first row that gemmi cannot read.
  static std::vector<std::string> sample_tags();
  std::vector<std::string> sample(bool of_residues) const;

  /// Adds the atoms of a model with their residues, without alternates. Returns the atoms with the
  /// given addresses, or kNoAtom if there is none or it was left out.
  std::vector<uint32_t> fill(size_t model, Names& parts, const std::vector<cif::AtomAddress>& ends,
                             Atoms& out);
  static constexpr uint32_t kNoAtom = UINT32_MAX;
  /// Adds the marks of all atoms that fill() added.
  void add_marks(AtomMarks& marks) const;
  /// The name of an atom that fill() added.
  std::string name_of(const Atoms& atoms, uint32_t atom) const;
  std::array<double, 3> place_of(uint32_t atom) const;

 private:
  struct Source {
    size_t column = SIZE_MAX;
    std::string_view instead;  // used if the column is missing
  };
  struct Part {
    std::vector<SiteRow> rows;
    std::vector<SiteRun> runs;
    std::vector<std::pair<uint8_t, std::string_view>> guesses;       // elements by names
    std::vector<std::pair<SiteColumn, std::string_view>> too_large;  // values
  };
  struct Residue {
    size_t run = 0, last_run = 0, model = 0, chain = 0;
  };
  class Reader;

  SiteValues values_of(const SiteRow& row) const;
  template <class Words>
  SiteValues select(const Words& words) const;
  void tell_of_parts(Notices& notices) const;
  std::string name_of(const Residue& residue) const;
  bool stands_in_place_of(const Residue& first, const Residue& second) const;
  void add_atoms(const Residue& residue, uint32_t chain, uint32_t part, Cases& conformers,
                 Atoms& out);
  uint32_t atom_of(const cif::AtomAddress& end, const Residue& residue, size_t first_atom) const;
  template <class Use>
  void for_rows(const Residue& residue, const Use& use) const;

  std::array<Source, kSiteColumns> sources_;
  size_t width_;
  bool has_places_ = true;
  std::array<double, 3> origin_;
  const char* text_end_ = nullptr;
  std::vector<std::string> values_;
  std::vector<Part> parts_;
  std::vector<SiteRun> runs_;
  std::vector<Residue> residues_;
  std::vector<std::string_view> models_;
  // Residues and rows of the model that fill() read last.
  std::vector<const Residue*> taken_;
  std::vector<const SiteRow*> rows_;
};

}  // namespace raio::core
