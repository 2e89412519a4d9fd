// The colour of a texture at a place, for shading and all who want to know it.
#pragma once

#include "scene/scene.h"

namespace raio {

/// In linear light, bilinear between the four nearest texels, which are made linear before. The
/// scene must pass validate(); coordinates that are no numbers count as 0.
Rgb texture_color(const Scene& scene, uint32_t texture, Uv at);

}  // namespace raio
