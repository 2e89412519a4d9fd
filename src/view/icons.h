// The icons of the window, drawn as lines and areas at any size.
#pragma once

#include <imgui.h>

#include <cstdint>

namespace raio::core::view {

enum class Icon : uint8_t {
  open,
  save_scene,
  undo,
  redo,
  antialiasing,
  soft_shadows,
  depth_of_field,
  reflection,
  refraction,
  gloss,
  translucency,
  motion,
  structure,
  view,
  split,
  boxes,
  inspect,
  pause,
  play,
  fit,
  home,
  picture,
  copy,
  theme,
  full_screen,
  panel,
  help,
  more,
};

/// About `center`, `size` window units high.
void draw_icon(ImDrawList& draw, Icon icon, ImVec2 center, float size, ImU32 color);

}  // namespace raio::core::view
