// The part of the panel that changes the scene: camera, background, lights, materials.
#pragma once

#include "view/state.h"

namespace raio::view {

/// Whether it changed the state's scene or camera.
bool draw_scene(ViewState& state);

}  // namespace raio::view
