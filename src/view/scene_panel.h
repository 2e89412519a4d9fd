// The section of the panel that edits the scene: camera, background, lights, materials.
#pragma once

#include "view/state.h"

namespace raio::core::view {

/// Returns whether it changed the state's scene or camera.
bool draw_scene(ViewState& state);

}  // namespace raio::core::view
