// The classic shading (docs/shading.md): Phong's light, hard or soft shadows, mirror reflection and
// refraction, as in NFF tracers since Whitted 1980, "An Improved Illumination Model for Shaded
// Display", CACM 23(6).
#pragma once

#include <algorithm>

#include "integrate/prepared_scene.h"

namespace raio::core {

/// Whether rays are spread by `roughness` or, without it, by that of any material.
inline bool spreads(const Scene& scene, const std::optional<float>& roughness) {
  if (roughness) return *roughness > 0;
  return std::ranges::any_of(scene.material_roughness, [](float r) { return r > 0; });
}

/// Whether mirrored or refracted rays are spread.
inline bool is_rough(const Scene& scene, const RenderSettings& s) {
  return (!s.no_reflection && spreads(scene, s.gloss)) ||
         (!s.no_refraction && spreads(scene, s.translucency));
}

/// Whether the picture needs more than NFF's light and a uniform background.
inline bool needs_models(const Scene& scene, const RenderSettings& s) {
  return s.shading != ShadingModel::nff || s.fresnel != Fresnel::none || s.sky ||
         !scene.material_specular.empty() || is_rough(scene, s);
}

/// The ambient light: a material's colour is multiplied by it.
inline float ambient_factor(const Scene& scene, const RenderSettings& s) {
  const bool any_color =
      std::ranges::any_of(scene.lights, [](const Light& l) { return l.color.has_value(); });
  return any_color || s.shading != ShadingModel::nff ? 0 : 0.1f;
}

/// The side of a light of soft shadows without a size of its own, for a camera that looks at `at`.
inline float usual_light_size(const Light& light, Vec3f at) {
  return 0.1f * length(at - light.position);
}

double classic_bound(const Scene& scene, const RenderSettings& settings);

}  // namespace raio::core
