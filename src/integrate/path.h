// Path tracing: Kajiya 1986, "The Rendering Equation". docs/light.md.
#pragma once

#include "integrate/prepared_scene.h"

namespace raio::core {

double path_bound(const Scene& scene, const RenderSettings& settings);

}  // namespace raio::core
