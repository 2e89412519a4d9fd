// Scenes for the tests of the window's parts.
#pragma once

#include <memory>

#include "scenes.h"
#include "view/camera_control.h"

namespace raio::core::view {

inline Camera camera() {
  Camera c;
  c.from = {1, -6, 2}, c.at = {0, 0, 0.5f}, c.up = {0, 0, 1}, c.fov_deg = 40;
  return c;
}

inline std::shared_ptr<const Scene> scene() {
  Scene s = core::tests::random_scene(20, 3);
  s.camera = camera();
  s.name = "some";
  return std::make_shared<const Scene>(std::move(s));
}

}  // namespace raio::core::view
