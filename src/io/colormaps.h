// Maps from numbers to colours, which are linear.
#pragma once

#include <array>
#include <expected>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec.h"

namespace raio {

inline constexpr std::string_view kColormaps[] = {"viridis", "plasma", "cividis", "coolwarm"};

/// How many colours a map has.
inline constexpr int kMapColors = 256;

/// The colour of a part, 0 to 1, in a map of that name; nothing: there is none.
std::optional<Rgb> map_color(std::string_view name, float part);

/// Which numbers have which colours: those of the map from its first for `least` to its last for
/// `most`.
struct ColorScale {
  std::string name;  // of the numbers
  std::string map;
  double least = 0, most = 0;
};
/// A number of the scale, with as many digits as tell its ends apart.
std::string scale_text(const ColorScale& scale, double value);

struct MappedColors {
  std::vector<Rgb> colors;
  ColorScale scale;
};

/// A colour for each value. The scale is the range, beyond which values have the colours of its
/// ends, or else goes from the least to the largest of the values; what is no number has the map's
/// first colour. Without a map's name viridis. The error says which maps there are.
std::expected<MappedColors, std::string> map_colors(
    std::span<const float> values, std::string_view name,
    std::optional<std::array<double, 2>> range = std::nullopt);

}  // namespace raio
