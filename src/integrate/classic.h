// The classic shading (docs/shading.md): Phong's light, hard or soft shadows, mirror reflection and
// refraction, as NFF tracers have had it since Whitted 1980, "An Improved Illumination Model for
// Shaded Display", CACM 23(6).
#pragma once

#include "integrate/wavefront.h"

namespace raio {

/// Does the picture take more than the light of NFF and a background of one colour?
inline bool needs_models(const Scene& scene, const RenderSettings& s) {
  return s.shading != ShadingModel::nff || s.fresnel != Fresnel::none || s.sky ||
         !scene.material_specular.empty() || !scene.material_roughness.empty();
}

double classic_bound(const Scene& scene, const RenderSettings& settings);

std::unique_ptr<TileRenderer> make_classic_renderer(const PreparedScene& scene,
                                                    RenderControl& control);

/// The same for what needs_models(), which make_classic_renderer() chooses.
std::unique_ptr<TileRenderer> make_model_renderer(const PreparedScene& scene,
                                                  RenderControl& control);

}  // namespace raio
