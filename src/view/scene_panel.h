// The section of the panel that edits the scene: camera, background, lights, materials.
#pragma once

#include "view/state.h"

namespace raio::core::view {

/// Returns whether it changed the state's scene or camera.
bool draw_scene(ViewState& state);

/// The colour of a material, of which the scene has several; returns whether it changed.
bool draw_material_color(ViewState& state, MaterialId id);

}  // namespace raio::core::view
