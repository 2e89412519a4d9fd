// The integrator `ambient` for figures (docs/ambient.md): diffuse surfaces with ambient occlusion
// under a white sky, and one key light that moves with the camera.
#pragma once

#include "integrate/wavefront.h"

namespace raio::core {

double ambient_bound(const Scene& scene, const RenderSettings& settings);

std::unique_ptr<TileRenderer> make_ambient_renderer(const PreparedScene& scene,
                                                    WorkControl& control);

}  // namespace raio::core
