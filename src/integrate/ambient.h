// The integrator `ambient` for figures (docs/ambient.md): diffuse surfaces under a white sky, which
// is hidden from them where other things are near, and one key light that goes with the camera.
#pragma once

#include "integrate/wavefront.h"

namespace raio {

double ambient_bound(const Scene& scene, const RenderSettings& settings);

std::unique_ptr<TileRenderer> make_ambient_renderer(const PreparedScene& scene,
                                                    RenderControl& control);

}  // namespace raio
