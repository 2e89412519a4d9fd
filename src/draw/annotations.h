// Annotations of pictures: a colour scale, a legend, a scale bar. Their ink contrasts with the
// picture; other pixels do not change. Text is 7 points high if the picture has a print size, else
// a fraction of its height. `linear`: see Overlay (render/picture.h).
#pragma once

#include <expected>
#include <span>
#include <string>

#include "base/error.h"
#include "draw/canvas.h"
#include "io/colormaps.h"
#include "io/image/image.h"
#include "io/read_scene.h"

namespace raio::core {

/// A picture of the scale for a figure: its colours with numbers below and their name above.
std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format);

/// The same on a picture, vertical at its right or left edge.
std::expected<void, Error> draw_color_bar_on(Picture& picture, const ColorScale& scale, bool left,
                                             bool linear);

/// Names with discs of their colours, in the upper corner. If there are too many, the last line
/// says how many more.
std::expected<void, Error> draw_legend_on(Picture& picture, std::span<const LegendEntry> entries,
                                          bool left, bool linear);

/// Whether a picture of this size has room for a legend: two lines of a few letters.
bool has_room_for_legend(int width, int height, float dpi);

/// A bar of a round length, at most a quarter of the picture's width, in the lower left corner.
/// `pixels_per_unit` is the size of a scene unit in the picture.
std::expected<void, Error> draw_scale_bar_on(Picture& picture, double pixels_per_unit,
                                             std::string_view unit, bool linear);

}  // namespace raio::core
