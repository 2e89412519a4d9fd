// The classic shading (docs/shading.md): Phong's light, hard or soft shadows, mirror reflection and
// refraction, as NFF tracers have had it since Whitted 1980, "An Improved Illumination Model for
// Shaded Display", CACM 23(6).
#pragma once

#include <algorithm>

#include "integrate/wavefront.h"

namespace raio {

/// Do mirrored or refracted rays spread?
inline bool is_rough(const Scene& scene, const RenderSettings& s) {
  const bool rough = std::ranges::any_of(scene.material_roughness, [](float r) { return r > 0; });
  const auto spreads = [&](const std::optional<float>& set) { return set ? *set > 0 : rough; };
  return (s.reflection && spreads(s.gloss)) || (s.refraction && spreads(s.translucency));
}

/// Does the picture take more than the light of NFF and a background of one colour?
inline bool needs_models(const Scene& scene, const RenderSettings& s) {
  return s.shading != ShadingModel::nff || s.fresnel != Fresnel::none || s.sky ||
         !scene.material_specular.empty() || is_rough(scene, s);
}

double classic_bound(const Scene& scene, const RenderSettings& settings);

std::unique_ptr<TileRenderer> make_classic_renderer(const PreparedScene& scene,
                                                    RenderControl& control);

/// The same for what needs_models(), which make_classic_renderer() chooses.
std::unique_ptr<TileRenderer> make_model_renderer(const PreparedScene& scene,
                                                  RenderControl& control);

}  // namespace raio
