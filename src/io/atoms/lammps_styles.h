// The columns of the section Atoms of a LAMMPS data file, for each atom style.
#pragma once

#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/rows.h"

namespace raio::core {

struct LammpsStyle {
  std::string_view name;
  /// A letter per column: i, atom id; m, molecule id; t, type; x, y and z; d, diameter; n, a whole
  /// number; p, a number from 0; v, a number above 0; r, any number; a final * allows more columns.
  std::string_view columns;

  /// Whether rows of this many words fit the style, with or without three image flags.
  bool has(size_t words) const;
  /// The meaning of each word of a row.
  std::vector<Word> layout(size_t words) const;
};

/// The style of this name; null if there is none.
const LammpsStyle* find_lammps_style(std::string_view name);
/// "angle, atomic, ...".
std::string lammps_style_names();

/// Properties of a data file that help to guess its style.
struct LammpsHints {
  uint32_t types = 0;  // 0: unknown
  bool bonds = false;
  std::string_view section;  // used by one style only: "ellipsoids", "lines", ...; or empty
  std::optional<Cell> cell;
  const std::map<std::string, uint32_t, std::less<>>* labels = nullptr;  // of types
};

/// The styles that match the rows best, all with type and position in the same columns; or an error
/// that lists the candidates. tdpd and hybrid are never guessed, since their rows may have any
/// numbers after the position.
std::expected<std::vector<const LammpsStyle*>, std::string> guess_lammps_style(
    std::span<const std::vector<std::string_view>> rows, const LammpsHints& hints);

}  // namespace raio::core
