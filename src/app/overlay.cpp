#include "app/overlay.h"

#include <numbers>

#include "app/annotations.h"
#include "base/exact_math.h"

namespace raio::core::app {
namespace {

// At the point looked at.
double pixels_per_unit(const RenderSettings& s) {
  const double distance = double(length(s.camera.at - s.camera.from));
  return s.height / (2 * distance * exact_tan(double(s.camera.fov_deg) * std::numbers::pi / 360));
}

}  // namespace

std::string arguments_of(const Annotations& wanted) {
  std::string out;
  if (wanted.color_bar) out += " --color-bar";
  if (wanted.color_bar && wanted.color_bar_side == "left") out += " --color-bar-side left";
  if (wanted.legend) out += " --legend";
  if (wanted.scale_bar) out += " --scale-bar";
  return out;
}

Overlay overlay_of(const Annotations& wanted, const ReadScene& read,
                   const RenderSettings& settings) {
  if (!wanted.any_annotation()) return {};
  return
      [wanted, left = wanted.color_bar_side == "left", colors = read.colors, legend = read.legend,
       unit = read.unit, scale = pixels_per_unit(settings)](Picture& picture, bool linear) {
        std::expected<void, Error> done;
        if (wanted.color_bar) done = draw_color_bar_on(picture, *colors, left, linear);
        if (done && wanted.legend) done = draw_legend_on(picture, legend, !left, linear);
        if (done && wanted.scale_bar) done = draw_scale_bar_on(picture, scale, unit, linear);
        return done;
      };
}

}  // namespace raio::core::app
