// The annotations of a picture as data, and how to draw them all.
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "integrate/settings.h"
#include "io/colormaps.h"
#include "io/image/image.h"
#include "io/read_scene.h"

namespace raio::core {

struct ScaleBar {
  double pixels_per_unit = 0;  // of length, at the distance of the point looked at
  std::string unit;            // empty: unknown
};

struct Marks {
  std::optional<ColorScale> color_bar = {};
  std::vector<LegendEntry> legend = {};
  std::optional<ScaleBar> scale_bar = {};
  bool bar_at_left = false;  // the legend takes the other side
};

/// See draw/annotations.h.
std::expected<void, Error> draw_marks(Picture& picture, const Marks& marks, bool linear);

/// For ScaleBar.
double pixels_per_unit(const RenderSettings& settings);

}  // namespace raio::core
