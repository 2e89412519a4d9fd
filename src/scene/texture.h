// The values of a texture at given coordinates.
#pragma once

#include "scene/scene.h"

namespace raio::core {

/// Bilinear between the four nearest texels, which are converted to linear light first. The scene
/// must pass validate(); NaN coordinates count as 0.
Rgb texture_color(const Scene& scene, uint32_t texture, Uv at);
/// The same for data, which is linear: 0 to 1 in each channel.
Rgb texture_value(const Scene& scene, uint32_t texture, Uv at);
/// The same for alpha; 1 for a picture without.
float texture_alpha(const Scene& scene, uint32_t texture, Uv at);
/// The alpha of a material with cutouts: 0 or 1 if it is a mask.
float cutout_alpha(const Scene& scene, MaterialId id, Uv at);

}  // namespace raio::core
