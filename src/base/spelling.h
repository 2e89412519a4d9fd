// Words in texts: trims and cuts them, and suggests the intended one in messages about unknown
// words.
#pragma once

#include <algorithm>
#include <cctype>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raio::core {

/// The text without blanks and ends of lines at both ends.
inline std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n\v\f";
  const size_t first = std::min(text.find_first_not_of(kBlanks), text.size());
  return text.substr(first, text.find_last_not_of(kBlanks) + 1 - first);
}

/// The text, or of one with more than `most` bytes the beginning and dots.
inline std::string cut_text(std::string_view text, size_t most) {
  if (text.size() <= most) return std::string(text);
  size_t end = most - 3;
  while (end > 0 && (text[end] & 0xc0) == 0x80) --end;  // not within a letter of UTF-8
  return std::string(text.substr(0, end)) + "...";
}

/// Edit distance (Levenshtein 1966), computed row by row.
inline size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i);
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t replaced = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

/// The nearest of the lower-case `candidates`, or nothing if none is near: long words may have two
/// wrong letters, words of one letter only a wrong case.
inline std::string_view nearest_word(std::string_view word,
                                     std::span<const std::string_view> candidates) {
  constexpr size_t kLongest = 24;
  if (word.size() > kLongest) return {};
  std::string wanted(word);
  for (char& c : wanted) c = char(std::tolower(static_cast<unsigned char>(c)));
  std::string_view best;
  size_t best_distance = std::min<size_t>(wanted.size() / 2, 2) + 1;
  for (const std::string_view candidate : candidates) {
    const size_t distance = edit_distance(wanted, candidate);
    if (distance < best_distance) best = candidate, best_distance = distance;
  }
  return best;
}

}  // namespace raio::core
