// The meaning of a view's colours, as a scale with units, and what is under the cursor.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "render/session.h"
#include "view/stage.h"
#include "view/state.h"

namespace raio::core::view {

struct Legend {
  struct Stop {
    Rgb color;
    std::string label;
  };
  std::string title;        // with the unit
  std::vector<Stop> stops;  // evenly spaced along the scale
  bool discrete = false;    // swatches without values in between
};

/// Empty for the picture.
Legend legend_of(const ViewState& state);

/// The count that heat_color() (integrate/views.h) shows in this colour, between two stops the
/// nearest. 1024 stands for all larger ones.
double heat_count(const Rgb& color);

struct ReadOut {
  std::string text;          // one line: the view's value with its unit, then what was hit
  std::optional<double> at;  // on the legend's scale, 0 to 1
};

/// At a position of the picture, 0 to 1; nothing outside.
ReadOut read_out(const ViewState& state, const SessionPicture& picture, double x, double y,
                 const Pick& pick);
/// For a pixel with this colour. Without `accel`, only what the colour says.
ReadOut read_out(const ViewState& state, const Pick& pick, const Accel* accel, const Rgb& color,
                 int picture_height);

/// At the lower right of the picture. Returns the covered area; empty without a legend.
Rect draw_legend(const Rect& picture, const Legend& legend, std::optional<double> at);

}  // namespace raio::core::view
