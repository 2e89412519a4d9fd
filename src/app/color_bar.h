#pragma once

#include <expected>
#include <string>

#include "app/canvas.h"
#include "base/error.h"
#include "io/colormaps.h"
#include "io/image/image.h"

namespace raio::app {

/// A picture of the scale for a figure: its colours with numbers below them and their name above.
std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format);

/// The same on a picture, upright at its right or left edge, in an ink that stands out there. Other
/// pixels stay as they are. `linear`: see Overlay (render/picture.h).
std::expected<void, Error> draw_color_bar_on(Picture& picture, const ColorScale& scale, bool left,
                                             bool linear);

}  // namespace raio::app
