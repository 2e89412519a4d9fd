// The classic shading's renderer, compiled once per instruction set (Highway's foreach_target) and
// selected at run time.
#include "integrate/classic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/classic.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/classic-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

std::unique_ptr<TileRenderer> make_renderer(const PreparedScene& scene, WorkControl& control) {
  return std::make_unique<Wavefront<ClassicShading>>(scene, control);
}

}  // namespace
}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

HWY_EXPORT(make_renderer);

std::unique_ptr<TileRenderer> make_classic_renderer(const PreparedScene& scene,
                                                    WorkControl& control) {
  if (needs_models(scene.scene, scene.settings)) return make_model_renderer(scene, control);
  return HWY_DYNAMIC_DISPATCH(make_renderer)(scene, control);
}

double classic_bound(const Scene& scene, const RenderSettings& settings) {
  double light = 0.1;  // ambient
  for (const Light& l : scene.lights) light += l.color ? max_component(*l.color) : 1.0;
  const float own_color = brightest_color(scene);  // may override a material's
  const float tint = brightest_tint(scene);
  double brightest = 0, gain = 0;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const float color = std::max(max_component(m.color), own_color) * tint;
    const double mirrored = double(m.ks) * max_component(scene.specular_of(MaterialId(i)));
    brightest = std::max(brightest, light * (color * (1.0 + m.kd) + mirrored));
    const bool divides = settings.fresnel != Fresnel::none && m.transmission > 0;
    gain = std::max(gain, divides ? 1.0 : mirrored + m.transmission);
  }
  brightest += settings.sky ? double(settings.sky->largest) / 255
                            : double(max_component(settings.background));
  double sum = 0, weight = 1;
  for (int level = 0; level <= settings.depth; ++level, weight *= gain) sum += weight * brightest;
  return sum;
}

}  // namespace raio::core
#endif
