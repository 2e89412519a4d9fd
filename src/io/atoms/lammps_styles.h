// How LAMMPS writes an atom in the section Atoms of a data file: in each of its styles otherwise.
#pragma once

#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/rows.h"

namespace raio {

struct LammpsStyle {
  std::string_view name;
  /// A letter a column: i, the atom's number; m, its molecule; t, its type; x, y and z; d, a
  /// diameter; n, a whole number; p, a number from 0; v, one above 0; r, any number; and, at the
  /// end, *, further ones.
  std::string_view columns;

  /// Whether rows of so many words are those of this style, which three image flags may follow.
  bool has(size_t words) const;
  /// What is in the columns of rows of so many words.
  std::vector<Word> layout(size_t words) const;
};

/// The style of the name; null: there is none.
const LammpsStyle* find_lammps_style(std::string_view name);
/// "angle, atomic, ...".
std::string lammps_style_names();

/// What a data file says that styles differ by.
struct LammpsHints {
  uint32_t types = 0;  // 0: it does not say
  bool bonds = false;
  std::string_view section;  // that only one style has: "ellipsoids", "lines", ...; or empty
  std::optional<Cell> cell;
  const std::map<std::string, uint32_t, std::less<>>* labels = nullptr;  // of types
};

/// The styles that rows of words fit best: all of them have type and place in the same columns; or
/// an error that names the styles they might have. tdpd and hybrid, whose rows may have any numbers
/// behind the place, are never guessed.
std::expected<std::vector<const LammpsStyle*>, std::string> guess_lammps_style(
    std::span<const std::vector<std::string_view>> rows, const LammpsHints& hints);

}  // namespace raio
