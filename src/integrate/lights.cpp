#include "integrate/lights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/exact_math.h"

namespace raio::core {
namespace {

constexpr float kNearest = 1e-3f;  // relative to the scene's size

double radians(float degrees) { return double(degrees) * std::numbers::pi / 180; }

// Sets edges that span a disc of this radius perpendicular to the unit vector n.
void span_disc(SampledLight& light, Vec3f n, float radius) {
  const Frame<float> frame(n);
  light.edge_u = frame.u * radius, light.edge_v = frame.v * radius;
}

// A distant light of half the angle a is the disc of radius sin a below the hemisphere around its
// direction, which makes equal areas of the disc equally bright (Malley).
void prepare_directional(const PhysicalLight& l, SampledLight& light) {
  light.is_distant = true;
  light.position = -light.axis;
  span_disc(light, light.axis, float(exact_sin(radians(l.angular_diameter) / 2)));
}

// As in pbrt, the border is smooth in the cosine.
void prepare_cone(const PhysicalLight& l, SampledLight& light) {
  constexpr double kSharpest = 1e-6;
  const double outer = exact_cos(radians(l.opening) / 2);
  const double inner = exact_cos(radians(l.opening) / 2 - radians(l.falloff));
  light.least_cosine = float(outer);
  light.steepness = float(1 / std::max(inner - outer, kSharpest));
}

void prepare_quad(const PhysicalLight& l, SampledLight& light) {
  const Vec3f across = cross(l.edge1, l.edge2);
  light.is_round = false, light.has_area = true, light.is_two_sided = l.front && l.back;
  light.edge_u = l.edge1, light.edge_v = l.edge2;
  light.axis = normalize(l.front ? across : -across);
  light.emission = l.color * length(across);
  light.least_cosine = 0, light.steepness = std::numeric_limits<float>::max();
}

void prepare_ring(const PhysicalLight& l, SampledLight& light) {
  prepare_cone(l, light);
  if (l.radius == 0) return;
  const float part = l.inner_radius / l.radius;
  light.hole = part * part, light.has_area = true;
  light.emission = l.color * (float(std::numbers::pi) * l.radius * l.radius * (1 - light.hole));
  span_disc(light, light.axis, l.radius);
}

SampledLight prepared(const PhysicalLight& l) {
  SampledLight light;
  light.emission = l.color, light.position = l.position, light.axis = normalize(l.direction);
  switch (l.kind) {
    case LightKind::point:
      break;
    case LightKind::directional:
      prepare_directional(l, light);
      break;
    case LightKind::spot:
      prepare_cone(l, light);
      break;
    case LightKind::quad:
      prepare_quad(l, light);
      break;
    case LightKind::ring:
      prepare_ring(l, light);
      break;
  }
  return light;
}

}  // namespace

double SampledLight::brightest() const {
  const double sine = is_distant ? double(length(edge_u)) : 0;
  const double nearest = decreases && !is_distant ? double(nearest_squared) : 1;
  return double(max_component(emission)) / (std::sqrt(1 - sine * sine) * nearest);
}

SampledLight key_light(const EyeRays& eye, Vec3f forward, const StyleParams& look) {
  constexpr float kRadius = 0.1f;
  SampledLight light;
  light.is_distant = true;
  light.position = normalize(eye.right * -0.45f + eye.up * 0.7f - forward * 0.75f);
  light.emission = Rgb(look.key * float(std::numbers::pi));
  span_disc(light, light.position, kRadius);
  return light;
}

double brightest_texel(const Scene& scene) {
  float brightest = 0;
  for (const Rgb& texel : scene.environment_texels)
    brightest = std::max(brightest, max_component(texel));
  return double(brightest);
}

Rgb uncolored_intensity(const Scene& scene) {
  return Rgb(float(1 / std::sqrt(double(std::max<size_t>(1, scene.lights.size())))));
}

std::vector<SampledLight> sampled_lights(const Scene& scene, const Camera& camera) {
  std::vector<SampledLight> lights;
  for (const Light& l : scene.lights) {
    SampledLight& light = lights.emplace_back();
    light.decreases = false, light.position = l.position;
    // A white surface that faces the light of the intensity I has the radiance I, so its irradiance
    // is pi I.
    light.emission = l.color.value_or(uncolored_intensity(scene)) * float(std::numbers::pi);
  }
  for (const PhysicalLight& l : scene.physical_lights) lights.push_back(prepared(l));
  Box3f box = bounds(scene);
  box.extend(camera.from), box.extend(camera.at);
  for (const SampledLight& light : lights)
    if (!light.is_distant)
      box.extend(light.position), box.extend(light.position + light.edge_u + light.edge_v);
  const float nearest = kNearest * length(box.size());
  for (SampledLight& light : lights) light.nearest_squared = nearest * nearest;
  return lights;
}

}  // namespace raio::core
