#include "measure/effects.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "integrate/classic.h"

namespace raio::core {
namespace {

// Whether a primitive has one of these materials.
template <class Fits>
bool any_material(const Scene& scene, Fits&& fits) {
  std::vector<uint8_t> wanted;
  wanted.reserve(scene.materials.size());
  for (const Material& m : scene.materials) wanted.push_back(fits(m) ? 1 : 0);
  if (std::ranges::count(wanted, 1) == 0) return false;
  const auto is_wanted = [&](MaterialId id) { return wanted[id] != 0; };
  bool any = false;
  for_each_pool(
      [&](auto pool) { any = any || std::ranges::any_of(scene.*pool.materials, is_wanted); });
  return any || std::ranges::any_of(scene.meshes, [&](const Mesh& mesh) {
           return !mesh.triangles.empty() && std::ranges::any_of(mesh.materials, is_wanted);
         });
}

// Sets nothing if the materials already say the same.
void switch_roughness(std::optional<float>& given, bool on, const Scene& scene) {
  if (on == spreads(scene, given)) return;
  const bool by_materials = spreads(scene, std::nullopt);
  given = on == by_materials ? std::nullopt : std::optional(on ? kUsualRoughness : 0);
}

// A picture without motion shows the time at which its shutter opens.
void switch_motion(RenderOptions& o, bool on, const Scene& scene) {
  if (on == is_on(Effect::motion, o, scene)) return;
  const float open = resolve_options(o, scene).shutter_open;
  o.shutter = on ? std::nullopt : std::optional(std::array{open, open});
}

}  // namespace

bool is_on(Effect effect, const RenderOptions& options, const Scene& scene) {
  const RenderSettings s = resolve_options(options, scene);
  switch (effect) {
    case Effect::antialiasing:
      return s.aa != 1;
    case Effect::soft_shadows:
      return s.soft_shadows;
    case Effect::depth_of_field:
      return s.dof;
    case Effect::reflection:
      return !s.no_reflection;
    case Effect::refraction:
      return !s.no_refraction;
    case Effect::gloss:
      return spreads(scene, s.gloss);
    case Effect::translucency:
      return spreads(scene, s.translucency);
    case Effect::motion:
      return scene.moves() && s.shutter_open < s.shutter_close;
    case Effect::structure:
      return s.accel.kind != AccelKind::none;
  }
  return false;
}

RenderOptions with_effect(RenderOptions o, Effect effect, bool on, const Scene& scene) {
  switch (effect) {
    case Effect::antialiasing:
      o.aa = on ? 3 : 1;
      break;
    case Effect::soft_shadows:
      o.soft_shadows = on;
      break;
    case Effect::depth_of_field:
      o.dof = on, o.lens_samples = on ? 3 : 1;
      break;
    case Effect::reflection:
      o.no_reflection = !on;
      break;
    case Effect::refraction:
      o.no_refraction = !on;
      break;
    case Effect::gloss:
      switch_roughness(o.gloss, on, scene);
      break;
    case Effect::translucency:
      switch_roughness(o.translucency, on, scene);
      break;
    case Effect::motion:
      switch_motion(o, on, scene);
      break;
    case Effect::structure:
      if (on != is_on(effect, o, scene)) o.accel = {.kind = on ? AccelKind::bvh : AccelKind::none};
      break;
  }
  return o;
}

bool is_in_scene(Effect effect, const Scene& scene, Fresnel fresnel) {
  if (scene.primitive_count() == 0) return false;
  switch (effect) {
    case Effect::soft_shadows:
      return !scene.lights.empty();
    case Effect::reflection:
    case Effect::gloss:
      return any_material(scene, [divides = fresnel != Fresnel::none](const Material& m) {
        return m.ks > 0 || (divides && m.transmission > 0);
      });
    case Effect::refraction:
    case Effect::translucency:
      return any_material(scene, [](const Material& m) { return m.transmission > 0; });
    case Effect::motion:
      return scene.moves();
    default:
      return true;
  }
}

}  // namespace raio::core
