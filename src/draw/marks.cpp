#include "draw/marks.h"

#include <numbers>

#include "base/exact_math.h"
#include "draw/annotations.h"

namespace raio::core {

std::expected<void, Error> draw_marks(Picture& picture, const Marks& marks, bool linear) {
  const auto& [color_bar, legend, scale_bar, left] = marks;
  std::expected<void, Error> done;
  if (color_bar) done = draw_color_bar_on(picture, *color_bar, left, linear);
  if (done && !legend.empty()) done = draw_legend_on(picture, legend, !left, linear);
  if (done && scale_bar)
    done = draw_scale_bar_on(picture, scale_bar->pixels_per_unit, scale_bar->unit, linear);
  return done;
}

double pixels_per_unit(const RenderSettings& s) {
  const double distance = double(length(s.camera.at - s.camera.from));
  return s.height / (2 * distance * exact_tan(double(s.camera.fov_deg) * std::numbers::pi / 360));
}

}  // namespace raio::core
