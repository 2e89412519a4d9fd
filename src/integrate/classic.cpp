#include "integrate/classic.h"

#include "scene/columns.h"

namespace raio {

double radiance_bound(const Scene& scene, int depth) {
  double light = 0.1;  // ambient
  for (const Light& l : scene.lights) light += l.color ? max_component(*l.color) : 1.0;
  float own_color = 0;  // the brightest that takes the place of a material's
  for_each_pool(scene, [&](PoolKind, auto&, auto&, const Array<Rgb>& colors, auto&) {
    for (const Rgb& color : colors) own_color = std::max(own_color, max_component(color));
  });
  double brightest = 0, gain = 0;
  for (const Material& m : scene.materials) {
    const float color = std::max(max_component(m.color), own_color);
    brightest = std::max(brightest, light * (color * (1.0 + m.kd) + m.ks));
    gain = std::max(gain, double(m.ks) + m.transmission);
  }
  brightest += max_component(scene.background);
  double sum = 0, weight = 1;
  for (int level = 0; level <= depth; ++level, weight *= gain) sum += weight * brightest;
  return sum;
}

ClassicScene::ClassicScene(const Scene& s, const Accel& a, const RenderOptions& o)
    : scene(s),
      accel(a),
      options(o),
      eye(camera_of(s, o), o.width, o.height, o.angle_to_centers),
      sampler(o) {
  const bool any_color =
      std::ranges::any_of(s.lights, [](const Light& l) { return l.color.has_value(); });
  ambient = any_color ? Rgb() : Rgb(0.1f);
  const Rgb uncolored(float(1 / std::sqrt(double(std::max<size_t>(1, s.lights.size())))));
  const Vec3f looked_at = camera_of(s, o).at;
  for (const Light& l : s.lights) {
    Emitter e{l.position, l.color.value_or(uncolored), {}, {}};
    if (o.soft_shadows) {
      const Vec3f to_at = looked_at - l.position;
      const float distance = length(to_at);
      const Frame<float> frame(distance > 0 ? to_at / distance : Vec3f(0, 0, 1));
      const float size = o.light_size > 0 ? o.light_size : 0.1f * distance;
      e.edge_u = frame.u * size, e.edge_v = frame.v * size;
    }
    emitters.push_back(e);
  }
  for (const Material& m : s.materials) {
    any_mirror |= m.ks > 0 && !o.no_reflection;
    any_transparent |= m.transmission > 0 && !o.no_refraction;
  }
}

}  // namespace raio
