// Values of CIF, as gemmi reads them.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "io/atoms/atom_site.h"
#include "io/atoms/colors.h"
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

/// A number with optional digits of uncertainty in parentheses, as in 1.23(8).
inline double number_of(std::string_view value, double instead = NAN) {
  if (value.starts_with('+')) value.remove_prefix(1);
  const std::string_view digits = value.substr(value.starts_with('-'));
  if (digits.empty() || !(digits[0] == '.' || (digits[0] >= '0' && digits[0] <= '9')))
    return instead;
  double number = instead;
  const char* const end = value.data() + value.size();
  const auto [stop, error] = std::from_chars(value.data(), end, number);
  if (error == std::errc::result_out_of_range)
    number = digits.find('-') == std::string_view::npos ? INFINITY : 0;
  else if (error != std::errc())
    return instead;
  const std::string_view rest(stop, end);
  const bool has_uncertainty = rest.size() > 1 && rest.front() == '(' &&
                               rest.find_first_not_of("0123456789", 1) == rest.size() - 1 &&
                               rest.back() == ')';
  return rest.empty() || has_uncertainty ? number : instead;
}

/// The element of a type symbol such as "Fe" or "FE3+", by its first two letters.
inline uint8_t element_of_type(std::string_view symbol) {
  symbol = without_blanks(symbol);
  // Charges and blanks come before digits and letters.
  const bool has_two = symbol.size() > 1 && symbol[1] > '-' && symbol[1] <= 'z';
  return uint8_t(element_number(symbol.substr(0, has_two ? 2 : 1)));
}

/// The single character of a value; 0 if it is empty.
inline std::optional<char> char_of(std::string_view value, char null) {
  if (is_null(value)) return null;
  const std::string_view text = value.size() < 2 ? value : text_of(value);
  if (text.size() > 1) return std::nullopt;
  return text.empty() ? '\0' : text[0];
}

inline bool is_whole(std::string_view text) {
  text = without_blanks(text);
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
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
inline std::optional<ResidueNumber> residue_number_of(std::string_view number,
                                                      std::string_view insertion) {
  ResidueNumber out;
  const auto code = char_of(insertion, ' ');
  if (!code) return std::nullopt;
  out.insertion = *code;
  std::string_view text = text_of(number);
  if (text.empty() || is_null(text)) return out;
  if (text.back() >= 'A' && text.back() <= 'z') {
    if (out.insertion != ' ' && out.insertion != text.back()) return std::nullopt;
    out.insertion = text.back();
    text.remove_suffix(1);
  }
  if (!is_whole(text)) return std::nullopt;
  text = without_blanks(text);
  if (text[0] == '+') text.remove_prefix(1);
  (void)std::from_chars(text.data(), text.data() + text.size(), out.number.emplace());
  return out;
}

}  // namespace raio::core::cif
