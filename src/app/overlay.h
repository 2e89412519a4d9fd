// The annotations that users request on a picture, as an Overlay.
#pragma once

#include <string>

#include "integrate/settings.h"
#include "io/read_scene.h"
#include "render/picture.h"

namespace raio::core::app {

struct Annotations {
  bool color_bar = false, legend = false, scale_bar = false;
  std::string color_bar_side = "right";  // or left; the legend takes the other one

  bool any_annotation() const { return color_bar || legend || scale_bar; }
  friend bool operator==(const Annotations&, const Annotations&) = default;
};

/// Those of `raio render`: " --legend --scale-bar".
std::string arguments_of(const Annotations& wanted);

/// Draws them (draw/annotations.h) on a picture with these settings of what was read; empty if
/// there are none. A colour bar needs a scale, and a legend names.
Overlay overlay_of(const Annotations& wanted, const ReadScene& read,
                   const RenderSettings& settings);

}  // namespace raio::core::app
