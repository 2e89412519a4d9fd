// Conversion of texts to values of options.
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace raio::core {

/// A number that is the whole text.
template <class T>
std::optional<T> parse_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// One of `names`; its index is the value.
template <class Enum, class Value>
std::expected<void, std::string> parse_word(std::span<const std::string_view> names,
                                            std::string_view text, Value& value) {
  for (size_t i = 0; i < names.size(); ++i)
    if (names[i] == text) return value = Enum(i), std::expected<void, std::string>();
  std::string accepted(names.front());
  for (size_t i = 1; i < names.size(); ++i)
    accepted += fmt::format("{}{}", i + 1 < names.size() ? ", " : " or ", names[i]);
  return std::unexpected(fmt::format("expected {}, found '{}'", accepted, text));
}

}  // namespace raio::core
