// Atoms whose lines are rows of words, of which the format says what they are.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/atoms/lines.h"

namespace raio {

/// What a word of a row is.
enum class Word : uint8_t {
  skipped,
  x,
  y,
  z,
  species,  // the symbol or number of an element
  type,     // a whole number from 1
  residue,  // a whole number
  image,    // a whole number: in which copy of the box
  radius,
  diameter
};

struct RowLayout {
  std::vector<Word> words;
  std::map<std::string, uint32_t, std::less<>> types;  // that have names, by these
  uint32_t most_types = UINT32_MAX;
  size_t value = SIZE_MAX;  // the word that Atoms::values has
  // From the coordinates of the file to angstroms: three rows of four numbers.
  std::array<double, 12> to_place = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  bool has(Word word) const { return std::ranges::count(words, word) > 0; }
};

/// Reads `count` rows, the first of which is line `first` from 0. Notices say which labels are not
/// plain symbols of elements.
std::expected<void, Diagnostics> read_rows(const LineIndex& index, std::string_view file,
                                           size_t first, size_t count, const RowLayout& layout,
                                           Atoms& out);

/// The words of a line that blanks part.
std::vector<std::string_view> words_of(std::string_view line);

}  // namespace raio
