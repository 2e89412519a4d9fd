// Values of CIF as gemmi reads them, without exceptions.
#pragma once

#include <algorithm>
#include <charconv>
#include <gemmi/atox.hpp>
#include <gemmi/seqid.hpp>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "io/atoms/atom_site.h"
#include "io/atoms/element_names.h"

namespace raio::core::cif {

inline bool is_null(std::string_view value) { return value == "?" || value == "."; }

/// The text of a value without quotes or enclosing semicolon lines.
inline std::string_view text_of(std::string_view value) {
  if (value.empty() || is_null(value)) return {};
  if (value[0] == '"' || value[0] == '\'') return value.substr(1, value.size() - 2);
  if (value[0] == ';' && value.size() > 2 && value[value.size() - 2] == '\n')
    return value.substr(1, value.size() - (value[value.size() - 3] == '\r' ? 4 : 3));
  return value;
}

/// The single character of a value; 0 if it is empty.
inline std::optional<char> char_of(std::string_view value, char null) {
  if (is_null(value)) return null;
  const std::string_view text = value.size() < 2 ? value : text_of(value);
  if (text.size() > 1) return std::nullopt;
  return text.empty() ? '\0' : text[0];
}

inline bool is_whole(std::string_view text) {
  while (!text.empty() && gemmi::is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && gemmi::is_space(text.back())) text.remove_suffix(1);
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return !text.empty() && std::ranges::all_of(text, gemmi::is_digit);
}

/// Whether a whole number does not fit in an int.
inline bool is_too_large(std::string_view value) {
  if (value.size() <= std::numeric_limits<int>::digits10) return false;
  value = without_blanks(text_of(value));
  if (value.starts_with('+')) value.remove_prefix(1);
  int number;
  return std::from_chars(value.data(), value.data() + value.size(), number).ec ==
         std::errc::result_out_of_range;
}

/// Replaces whole numbers that do not fit in an int by "?" and calls dropped(column, value).
template <class Dropped>
void drop_large_numbers(SiteValues& values, const Dropped& dropped) {
  for (const SiteColumn column : kWholeNumbers)
    if (is_too_large(values[column])) {
      dropped(column, values[column]);
      values[column] = "?";
    }
}

/// A residue number, optionally followed by an insertion code, as in old files.
inline std::optional<gemmi::SeqId> seqid_of(std::string_view number, std::string_view insertion) {
  gemmi::SeqId out;
  const auto code = char_of(insertion, ' ');
  if (!code) return std::nullopt;
  out.icode = *code;
  std::string_view text = text_of(number);
  if (text.empty() || is_null(text)) return out;
  if (text.back() >= 'A') {
    if (out.icode != ' ' && out.icode != text.back()) return std::nullopt;
    out.icode = text.back();
    text.remove_suffix(1);
  }
  if (!is_whole(text)) return std::nullopt;
  out.num = gemmi::string_to_int(std::string(text), false);
  return out;
}

}  // namespace raio::core::cif
