// The integrator `ambient` for figures (docs/ambient.md): diffuse surfaces with ambient occlusion
// under a white sky, and one key light that moves with the camera.
#pragma once

#include "integrate/prepared_scene.h"

namespace raio::core {

double ambient_bound(const Scene& scene, const RenderSettings& settings);

}  // namespace raio::core
