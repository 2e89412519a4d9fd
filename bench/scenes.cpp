// The scenes and structures of the suites.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "app/terminal.h"
#include "base/random.h"
#include "bench/suites.h"
#include "io/generate/generate.h"

namespace raio::core::bench {
namespace {

// Random in 0..1, a function of `key`.
float unit(uint32_t key) { return float(scramble(scramble(key)) >> 8) * 0x1p-24f; }

// Seen from a corner of the unit cube.
Scene unit_cube_scene() {
  Scene scene;
  scene.camera = {.from = {1.6f, 1.9f, 1.5f},
                  .at = {0.5f, 0.5f, 0.4f},
                  .up = {0, 0, 1},
                  .lens_radius = {},
                  .focus_distance = {},
                  .movement = {}};
  scene.background = {0.3f, 0.5f, 0.8f};
  scene.lights = {{{3, 1, 4}, {}}, {{-1, 2, 3}, {}}};
  scene.materials = {{.color = {0.8f, 0.7f, 0.5f}, .kd = 0.7f, .ks = 0.3f, .shine = 20}};
  return scene;
}

// Random centres in the unit cube; the radius is a quarter of the mean distance of neighbours or,
// mixed, from a hundredth of it to the whole, log-uniformly.
Scene sphere_cloud(uint32_t count, bool mixed) {
  Scene scene = unit_cube_scene();
  const float spacing = float(std::cbrt(1.0 / count));
  scene.spheres.reserve(count);
  for (uint32_t i = 0; i < count; ++i) {
    const float part = mixed ? std::pow(10.0f, -2 * unit(4 * i + 3)) : 0.25f;
    scene.spheres.push_back({{unit(4 * i), unit(4 * i + 1), unit(4 * i + 2)}, part * spacing});
  }
  scene.sphere_materials.assign(count, 0);
  return scene;
}

// Ridges of seven octaves and some roughness, over the unit square: two triangles per cell.
Scene terrain(uint32_t count) {
  Scene scene = unit_cube_scene();
  const uint32_t side = std::max(1u, uint32_t(std::sqrt(count / 2.0)));
  for (uint32_t y = 0; y <= side; ++y)
    for (uint32_t x = 0; x <= side; ++x) {
      const float u = float(x) / float(side), v = float(y) / float(side);
      float height = 0.2f / float(side) * unit(y * (side + 1) + x), part = 0.12f;
      for (float f = 6; f < 800; f *= 2.2f, part *= 0.45f)
        height += part * std::sin(f * (u + 0.3f * v) + f) * std::cos(f * (v - 0.4f * u));
      scene.positions.push_back({u, v, height + 0.2f});
    }
  for (uint32_t y = 0; y < side; ++y)
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t a = y * (side + 1) + x, b = a + side + 1;
      scene.triangles.push_back({a, a + 1, b + 1});
      scene.triangles.push_back({a, b + 1, b});
    }
  scene.triangle_materials.assign(scene.triangles.size(), 0);
  return scene;
}

}  // namespace

Scene get_scene(const std::string& request) {
  if (std::filesystem::exists(request)) {
    auto scene = app::load_scene(request, true);
    if (!scene) give_up(scene.error(), request + " cannot be read");
    return std::move(*scene);
  }
  const size_t colon = std::min(request.find(':'), request.size());
  const std::string name = request.substr(0, colon);
  uint32_t size = 0;
  if (colon < request.size()) {
    const char* end = request.data() + request.size();
    const auto parsed = std::from_chars(request.data() + colon + 1, end, size);
    if (parsed.ec != std::errc() || parsed.ptr != end || size == 0 || size > 100'000'000)
      give_up(2, fmt::format("{}: expected a size of 1 to 100000000 behind the colon", request));
  }
  Scene scene;
  if (size > 0 && (name == "spheres" || name == "mixed")) {
    scene = sphere_cloud(size, name == "mixed");
  } else if (size > 0 && name == "terrain") {
    scene = terrain(size);
  } else {
    auto generated = generate_scene(name, int(size));
    if (!generated)
      give_up(2, fmt::format("{} is not a file, spheres:N, mixed:N or terrain:N, and {}", request,
                             generated.error().text()));
    scene = std::move(*generated);
  }
  scene.name = request;
  return scene;
}

std::unique_ptr<Accel> build_structure(const Scene& scene, AccelKind kind, const Settings& s) {
  AccelOptions options = s.options.accel;
  options.kind = kind;
  auto accel = build_accel(scene, options);
  if (!accel) give_up(3, accel.error().text());
  return std::move(*accel);
}

Settings Settings::with_defaults(const std::vector<std::string>& its_scenes,
                                 const std::vector<AccelKind>& its_structures,
                                 int its_repeat) const {
  Settings s = *this;
  if (s.scenes.empty()) s.scenes = its_scenes;
  if (s.structures.empty()) s.structures = its_structures;
  if (s.effects.empty()) s.effects = {kEffects[0]};
  if (s.repeat == 0) s.repeat = its_repeat;
  return s;
}

}  // namespace raio::core::bench
