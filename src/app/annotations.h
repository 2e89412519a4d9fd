// What is drawn on pictures: a scale of colours, a legend, a scale bar; each in an ink that stands
// out there, other pixels stay as they are. Text is 7 points high where the picture has a size in
// print, else a part of the picture's. `linear`: see Overlay (render/picture.h).
#pragma once

#include <expected>
#include <span>
#include <string>

#include "app/canvas.h"
#include "base/error.h"
#include "io/colormaps.h"
#include "io/image/image.h"
#include "io/read_scene.h"

namespace raio::app {

/// A picture of the scale for a figure: its colours with numbers below them and their name above.
std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format);

/// The same on a picture, upright at its right or left edge.
std::expected<void, Error> draw_color_bar_on(Picture& picture, const ColorScale& scale, bool left,
                                             bool linear);

/// Names beside discs of their colours, in the upper corner. Of more than there is room for the
/// last line says how many.
std::expected<void, Error> draw_legend_on(Picture& picture, std::span<const LegendEntry> entries,
                                          bool left, bool linear);

/// Whether a picture of this size has room for some of it: two lines of a few letters.
bool has_room_for_legend(int width, int height, float dpi);

/// A bar of a round length, at most a quarter of the picture wide, in its lower left corner.
/// `pixels_per_unit` is the size of a unit of the scene in the picture.
std::expected<void, Error> draw_scale_bar_on(Picture& picture, double pixels_per_unit,
                                             std::string_view unit, bool linear);

}  // namespace raio::app
