#include "app/overlay.h"

#include <utility>

#include "draw/marks.h"

namespace raio::core::app {

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
  Marks marks{.bar_at_left = wanted.color_bar_side == "left"};
  if (wanted.color_bar) marks.color_bar = read.colors;
  if (wanted.legend) marks.legend = read.legend;
  if (wanted.scale_bar) marks.scale_bar = {pixels_per_unit(settings), read.unit};
  return [marks = std::move(marks)](Picture& picture, bool linear) {
    return draw_marks(picture, marks, linear);
  };
}

}  // namespace raio::core::app
