// Maps from numbers to colours, which are linear.
#pragma once

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
std::optional<Rgb> map_color(std::string_view map, float part);

/// A colour for each value, from the map's first for the least to its last for the largest; what is
/// no number has the first. Without a name viridis. The error says which maps there are.
std::expected<std::vector<Rgb>, std::string> map_colors(std::span<const float> values,
                                                        std::string_view map);

}  // namespace raio
