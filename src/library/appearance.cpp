// Scene of the public interface: lights, environment, materials and textures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "library/library.h"

namespace raio::inline v1 {

using namespace core;           // NOLINT(google-build-using-namespace)
using namespace core::library;  // NOLINT(google-build-using-namespace)

void Scene::add_light(Triple position, std::optional<Triple> color, double size) {
  core::Light light{Vec3f(vec(position) - data_->scene.origin), {}};
  if (color) light.color = rgb(*color);
  if (size > 0) light.extent = {.width = float(size), .depth = float(size)};
  data_->scene.lights.push_back(light);
}

namespace {

// Refuses what no scene may contain.
void check_part_of_scene(core::Scene alone) {
  alone.materials.emplace_back();
  if (const auto problems = validate(alone); !problems.empty()) refuse(problems.front());
}

}  // namespace

void Scene::add_light(const Light& l) {
  guarded([&] {
    core::Scene alone;
    alone.physical_lights.push_back({.kind = LightKind(l.kind),
                                     .color = rgb(l.color),
                                     .position = Vec3f(vec(l.position) - data_->scene.origin),
                                     .direction = Vec3f(vec(l.direction)),
                                     .angular_diameter = float(l.angular_diameter),
                                     .opening = float(l.opening),
                                     .falloff = float(l.falloff),
                                     .edge1 = Vec3f(vec(l.edge1)),
                                     .edge2 = Vec3f(vec(l.edge2)),
                                     .front = l.front,
                                     .back = l.back,
                                     .radius = float(l.radius),
                                     .inner_radius = float(l.inner_radius)});
    check_part_of_scene(alone);
    data_->scene.physical_lights.append(alone.physical_lights);
  });
}

void Scene::set_environment(uint32_t width, uint32_t height, const float* rgb, Triple up,
                            Triple direction, bool visible) {
  guarded([&] {
    core::Scene& scene = data_->scene;
    const size_t count = size_t(width) * height;
    if (count > kMaxTexels || (count > 0 && !rgb) || !width != !height)
      refuse(fmt::format("an environment has 1 to {} pixels, or is 0 x 0; found {} x {}{}",
                         kMaxTexels, width, height, rgb ? "" : " at a null pointer"));
    core::Scene alone;
    if (count > 0) {
      alone.environment = {{width, height, Vec3f(vec(up)), Vec3f(vec(direction)), visible}};
      const auto* const texels = reinterpret_cast<const Rgb*>(rgb);
      alone.environment_texels = Array<Rgb>(texels, texels + count);
      check_part_of_scene(alone);
    }
    scene.environment = alone.environment, scene.environment_texels = alone.environment_texels;
  });
}

namespace {

core::Material classic_of(const Material& m) {
  return {rgb(m.color),   float(m.kd),           float(m.ks),
          float(m.shine), float(m.transmission), float(m.ior)};
}

// The distance at which light is attenuated, as the core has it.
float attenuation_of(const StandardMaterial& m) {
  const auto distance = float(m.attenuation_distance);
  return std::isinf(distance) && distance > 0 ? 0 : distance;
}

core::StandardSurface surface_of(const StandardMaterial& m) {
  return {.metallic = float(m.metallic),
          .roughness = float(m.roughness),
          .specular = float(m.specular),
          .specular_color = rgb(m.specular_color),
          .transmission = float(m.transmission),
          .is_thin = m.thin,
          .attenuation_color = rgb(m.attenuation_color),
          .attenuation_distance = attenuation_of(m),
          .emission = rgb(m.emission),
          .coat = float(m.clearcoat),
          .coat_roughness = float(m.clearcoat_roughness),
          .sheen_color = rgb(m.sheen_color),
          .sheen_roughness = float(m.sheen_roughness),
          .is_two_sided = m.two_sided,
          .is_unlit = m.unlit,
          .alpha_mode = core::AlphaMode(m.alpha_mode),
          .alpha_cutoff = float(m.alpha_cutoff),
          .normal_scale = float(m.normal_scale),
          .metallic_roughness_texture = m.metallic_roughness_texture.value_or(kNoTexture),
          .normal_texture = m.normal_texture.value_or(kNoTexture),
          .emission_texture = m.emission_texture.value_or(kNoTexture),
          .transmission_texture = m.transmission_texture.value_or(kNoTexture)};
}

void check_texture(const core::Scene& scene, std::string_view name,
                   const std::optional<uint32_t>& texture) {
  if (texture && *texture >= scene.textures.size())
    refuse(fmt::format("unknown {} {}, expected a number below {}", name, *texture,
                       scene.textures.size()));
}

// Refuses parameters that the core would ignore.
void check(const core::Scene& scene, const StandardMaterial& m) {
  check_texture(scene, "texture", m.texture);
  check_texture(scene, "metallic_roughness_texture", m.metallic_roughness_texture);
  check_texture(scene, "normal_texture", m.normal_texture);
  check_texture(scene, "emission_texture", m.emission_texture);
  check_texture(scene, "transmission_texture", m.transmission_texture);
  for (const double x : m.color)
    if (!(x >= 0 && x <= 1))
      refuse(fmt::format("color is ({}), expected 0 to 1", fmt::join(m.color, ", ")));
  if (!(m.opacity >= 0 && m.opacity <= 1))
    refuse(fmt::format("opacity is {}, expected 0 to 1", m.opacity));
  if (!(m.attenuation_distance > 0))
    refuse(fmt::format("attenuation_distance is {}, expected a number above 0 or infinity",
                       m.attenuation_distance));
  if (m.thin && attenuation_of(m) > 0)
    refuse("attenuation_distance has no effect on thin surfaces; set thin to false");
  if (m.emission_texture && m.emission == Triple{0, 0, 0})
    refuse("emission_texture is multiplied by the emission, which is 0");
  if (m.transmission_texture && m.transmission == 0)
    refuse("transmission_texture is multiplied by the transmission, which is 0");
  const auto fault = fault_of(surface_of(m), float(m.ior), scene.textures.size());
  if (!fault.empty()) refuse(fault);
}

}  // namespace

uint32_t Scene::add_material(const Material& m) {
  return guarded([&] {
    core::Scene& scene = data_->scene;
    check_texture(scene, "texture", m.texture);
    return scene.add_material(classic_of(m), rgb(m.specular), float(m.roughness), float(m.opacity),
                              m.texture.value_or(kNoTexture));
  });
}

uint32_t Scene::add_material(const StandardMaterial& m, const Material& classic) {
  return guarded([&] {
    core::Scene& scene = data_->scene;
    check(scene, m);
    core::Material others = classic_of(classic);
    others.color = rgb(m.color), others.ior = float(m.ior);
    return scene.add_standard_material(surface_of(m), others, float(m.opacity),
                                       m.texture.value_or(kNoTexture), rgb(classic.specular),
                                       float(classic.roughness));
  });
}

uint32_t Scene::add_texture(uint32_t width, uint32_t height, const uint8_t* texels,
                            TextureWrap wrap_u, TextureWrap wrap_v, int channels) {
  return guarded([&] {
    core::Scene& scene = data_->scene;
    const auto problem = [&](uint32_t side) { return side < 1 || side > kLargestTexture; };
    if (problem(width) || problem(height) || !texels)
      refuse(fmt::format("a texture has 1 to {} pixels a side; found {} x {}", kLargestTexture,
                         width, height));
    if (channels != 3 && channels != 4)
      refuse(fmt::format("a texture has 3 or 4 channels; found {}", channels));
    const size_t first = scene.texels.size(), count = size_t(width) * height;
    if (count > kMaxTexels - first)
      refuse(fmt::format("the textures have more than {} pixels", kMaxTexels));
    scene.texels.resize(first + count);
    uint32_t* to = scene.texels.data() + first;
    for (size_t i = 0; i < count; ++i, texels += channels) {
      const uint32_t hidden = channels == 4 ? 255u - texels[3] : 0u;
      to[i] =
          uint32_t(texels[0]) | uint32_t(texels[1]) << 8 | uint32_t(texels[2]) << 16 | hidden << 24;
    }
    scene.textures.push_back(
        {uint32_t(first), width, height, core::TextureWrap(wrap_u), core::TextureWrap(wrap_v)});
    return uint32_t(scene.textures.size() - 1);
  });
}

}  // namespace raio::inline v1
