#include "integrate/color_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/spelling.h"

namespace raio::core {
namespace {

// The values of CSS, where "green" is half as bright as "lime".
constexpr std::array<std::pair<std::string_view, uint32_t>, 24> kNames = {{
    {"black", 0x000000},   {"silver", 0xc0c0c0},  {"gray", 0x808080},    {"grey", 0x808080},
    {"white", 0xffffff},   {"maroon", 0x800000},  {"red", 0xff0000},     {"purple", 0x800080},
    {"fuchsia", 0xff00ff}, {"magenta", 0xff00ff}, {"green", 0x008000},   {"lime", 0x00ff00},
    {"olive", 0x808000},   {"yellow", 0xffff00},  {"navy", 0x000080},    {"blue", 0x0000ff},
    {"teal", 0x008080},    {"aqua", 0x00ffff},    {"cyan", 0x00ffff},    {"orange", 0xffa500},
    {"brown", 0xa52a2a},   {"pink", 0xffc0cb},    {"skyblue", 0x87ceeb}, {"beige", 0xf5f5dc},
}};

Rgb rgb_of(uint32_t bits) {
  const auto part = [&](int shift) { return float(bits >> shift & 255) / 255; };
  return {part(16), part(8), part(0)};
}

// Parses the digits after '#', three or six.
std::optional<Rgb> parse_digits(std::string_view digits) {
  if (digits.size() != 3 && digits.size() != 6) return std::nullopt;
  uint32_t bits = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), bits, 16);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  if (digits.size() == 6) return rgb_of(bits);
  return rgb_of(((bits & 0xf00) << 8 | (bits & 0xf0) << 4 | (bits & 0xf)) * 0x11);
}

std::optional<Rgb> parse_numbers(std::string_view text, double brightest) {
  Rgb color;
  for (int c = 0; c < 3; ++c) {
    const size_t size = std::min(c < 2 ? text.find(',') : text.size(), text.size());
    const auto [end, error] = std::from_chars(text.data(), text.data() + size, color[c]);
    if (error != std::errc() || end != text.data() + size) return std::nullopt;
    if (!(color[c] >= 0 && double(color[c]) <= brightest)) return std::nullopt;
    if (c < 2 && size == text.size()) return std::nullopt;
    text.remove_prefix(std::min(size + 1, text.size()));
  }
  return color;
}

std::string suggestion(std::string_view word, bool transparent) {
  std::vector<std::string_view> names;
  if (transparent) names.push_back("transparent");
  for (const auto& [name, bits] : kNames) names.push_back(name);
  const std::string_view nearest = nearest_word(word, names);
  return nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest);
}

}  // namespace

std::expected<WrittenColor, std::string> parse_color(std::string_view text,
                                                     const ColorLimits& limits) {
  std::string word(text);
  for (char& c : word) c = char(std::tolower(static_cast<unsigned char>(c)));
  if (word == "transparent" && limits.transparent) return WrittenColor{{}, true, true};
  const auto named = std::ranges::find(kNames, word, [](const auto& name) { return name.first; });
  if (named != kNames.end()) return WrittenColor{rgb_of(named->second), false, true};
  const auto color = word.starts_with('#') ? parse_digits(std::string_view(word).substr(1))
                                           : parse_numbers(word, limits.brightest);
  if (color) return WrittenColor{*color, false, word.starts_with('#')};
  return std::unexpected(fmt::format(
      "expected a colour: a name as in white, #rrggbb, {}three numbers from 0{} as in "
      "0.1,0.2,0.4{}, found '{}'{}",
      limits.transparent ? "" : "or ", limits.brightest == 1 ? " to 1" : "",
      limits.transparent ? ", or transparent" : "", text, suggestion(word, limits.transparent)));
}

}  // namespace raio::core
