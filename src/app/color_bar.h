#pragma once

#include <expected>
#include <string>

#include "app/canvas.h"
#include "io/colormaps.h"

namespace raio::app {

/// A picture of the scale for a figure: its colours with numbers below them and their name above.
std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format);

}  // namespace raio::app
