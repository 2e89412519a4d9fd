// Atoms in rows of words; the format gives the meaning of each word.
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

namespace raio::core {

/// The meaning of a word.
enum class Word : uint8_t {
  skipped,
  x,
  y,
  z,
  species,  // element symbol or atomic number
  type,     // a whole number from 1
  residue,  // a whole number
  image,    // a whole number: the periodic image
  radius,
  diameter
};

struct RowLayout {
  std::vector<Word> words;
  std::map<std::string, uint32_t, std::less<>> types;  // numbers of named types
  uint32_t most_types = UINT32_MAX;
  size_t value = SIZE_MAX;   // index of the word for Atoms::values
  size_t number = SIZE_MAX;  // index of the word with the atom's number
  // The map from the file's coordinates to angstroms: three rows of four numbers.
  std::array<double, 12> to_place = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

  bool has(Word word) const { return std::ranges::count(words, word) > 0; }
};

/// Reads `count` rows from line `first` on (from 0). Notices list labels that are not plain element
/// symbols.
std::expected<void, Diagnostics> read_rows(const LineIndex& index, std::string_view file,
                                           size_t first, size_t count, const RowLayout& layout,
                                           Atoms& out);

/// The words of a line, separated by blanks.
std::vector<std::string_view> words_of(std::string_view line);

}  // namespace raio::core
