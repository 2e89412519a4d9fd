#include "integrate/prepared_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "integrate/classic.h"
#include "integrate/path_scene.h"
#include "integrate/pixel_filter.h"
#include "scene/enclosing.h"

namespace raio::core {

PreparedScene::PreparedScene(const Scene& s, const Accel& a, const RenderSettings& r)
    : scene(s),
      accel(a),
      settings(r),
      eye(r.camera, r.width, r.height, r.angle_to_centers),
      forward(normalize(r.camera.at - r.camera.from)),
      sampler(r) {
  if (r.filter == PixelFilter::blackman_harris) filter_places = core::filter_places().data();
  if (r.figure.depth_cue > 0) measure_depth();
  if (r.figure.shadow_catcher) lay_floor();
  if (r.figure.key_light == KeyLight::scene) lights = sampled_lights(s, r.camera);
  const Rgb uncolored = uncolored_intensity(s);
  for (const Light& l : s.lights) {
    Emitter e{l.position, l.color.value_or(uncolored), {}, {}};
    if (r.soft_shadows) {
      const Vec3f to_at = r.camera.at - l.position;
      const float distance = length(to_at);
      const Frame<float> frame(distance > 0 ? to_at / distance : Vec3f(0, 0, 1));
      const float size = r.light_size > 0 ? r.light_size : usual_light_size(l, r.camera.at);
      e.edge_u = frame.u * size, e.edge_v = frame.v * size;
      if (l.extent && !(r.light_size > 0))
        e.edge_u = {l.extent->width, 0, 0}, e.edge_v = {0, 0, l.extent->depth};
    }
    emitters.push_back(e);
  }
  if (r.integrator == IntegratorKind::path) prepare_path();
}

PreparedScene::~PreparedScene() = default;

void PreparedScene::prepare_path() {
  std::vector<SampledLight> all;
  if (settings.figure.key_light == KeyLight::scene) {
    all = sampled_lights(scene, settings.camera);
    for (size_t i = 0; i < emitters.size() && settings.soft_shadows; ++i) {
      all[i].is_round = false, all[i].edge_u = emitters[i].edge_u,
      all[i].edge_v = emitters[i].edge_v;
      all[i].position = all[i].position - (emitters[i].edge_u + emitters[i].edge_v) / 2;
    }
  } else if (settings.figure.key_light == KeyLight::on) {
    all.push_back(key_light(eye, forward, params_of(settings.figure.look)));
  }
  path = std::make_unique<const PathScene>(scene, accel.geometry(), all);
}

void PreparedScene::measure_depth() {
  const Box3f box = bounds(scene);
  if (box.empty()) return;
  float farthest = -std::numeric_limits<float>::infinity();
  nearest = -farthest;
  for_each_edge(box, [&](Vec3f from, Vec3f to) {
    for (const Vec3f corner : {from, to}) {
      const float depth =
          eye.omnidirectional ? length(corner - eye.from) : dot(corner - eye.from, forward);
      nearest = std::min(nearest, depth), farthest = std::max(farthest, depth);
    }
  });
  nearest = std::max(nearest, 0.0f), extent = farthest - nearest;
}

// Perpendicular to the camera's up direction, under the lowest point. If the camera looks along the
// floor or from below, the floor is tilted towards the eye, to the angle of the default view of
// data (io/fit_camera.cpp).
void PreparedScene::lay_floor() {
  struct Lowest {
    double height = std::numeric_limits<double>::infinity();
    void join(const Lowest& b) { height = std::min(height, b.height); }
  };
  constexpr double kMinSine = 0.479;
  const Vec3d up = normalize(Vec3d(settings.camera.up)), along(forward);
  Vec3d normal = up;
  if (dot(up, along) > -kMinSine) {
    const Vec3d upright = normalize(up - along * dot(up, along));
    normal = normalize(upright * std::sqrt(1 - kMinSine * kMinSine) - along * kMinSine);
  }
  const Lowest lowest = sum_up<Lowest>(scene, [&](Lowest& l, Vec3f center, float radius) {
    l.height = std::min(l.height, dot(Vec3d(center), normal) - double(radius));
  });
  if (!std::isfinite(lowest.height)) return;
  const Box3f box = bounds(scene);
  constexpr float kFar = 100;  // times the scene's size, beyond which shadows are not visible
  floor_normal = Vec3f(normal), floor_height = float(lowest.height);
  floor_distance = kFar * (length(box.hi - box.lo) + length(settings.camera.at - eye.from));
}

}  // namespace raio::core
