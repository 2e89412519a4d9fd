// Maps from numbers to linear colours.
#pragma once

#include <array>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace raio::core {

inline constexpr std::string_view kColormaps[] = {"viridis", "plasma", "cividis", "coolwarm"};

/// The number of colours of a map.
inline constexpr int kMapColors = 256;

/// The colour at a position from 0 to 1 in the map of that name; nothing if unknown.
std::optional<Rgb> map_color(std::string_view name, float part);

/// Maps numbers to colours: the map's first for `least` to its last for `most`.
struct ColorScale {
  std::string name;  // of the numbers
  std::string map;
  double least = 0, most = 0;
  std::vector<Rgb> colors = {};  // kMapColors, of a map without a name; empty: those of `map`
};
/// One of its kMapColors colours.
Rgb scale_color(const ColorScale& scale, int i);
/// A number of the scale, with enough digits to distinguish its ends.
std::string scale_text(const ColorScale& scale, double value);

struct MappedColors {
  std::vector<Rgb> colors;
  ColorScale scale;
};

/// A colour per value. The scale is the given range, beyond which values have the colours of its
/// ends, or else the range of the values; NaN gets the map's first colour. The default map is
/// viridis. The error lists the maps.
std::expected<MappedColors, std::string> map_colors(
    std::span<const float> values, std::string_view name,
    std::optional<std::array<double, 2>> range = std::nullopt);

}  // namespace raio::core
