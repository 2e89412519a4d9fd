#include "io/raio/format.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "io/raio/raio.h"

namespace raio::core::scene_file {
namespace {

std::string_view bytes_of_hash(const Hash128& hash) {
  return {reinterpret_cast<const char*>(&hash), sizeof hash};
}

}  // namespace

Hash128 column_hash(std::string_view bytes) {
  constexpr size_t kChunk = 1 << 20;
  if (bytes.size() <= kChunk) return hash128(bytes);
  std::vector<Hash128> hashes((bytes.size() + kChunk - 1) / kChunk);
  parallel_for(hashes.size(),
               [&](size_t i) { hashes[i] = hash128(bytes.substr(i * kChunk, kChunk)); });
  return hash128({reinterpret_cast<const char*>(hashes.data()), hashes.size() * sizeof(Hash128)});
}

Hash128 table_hash(Header header, std::string_view table) {
  header.hash = {};
  const Hash128 parts[] = {hash128({reinterpret_cast<const char*>(&header), sizeof header}),
                           hash128(table)};
  return hash128(std::string(bytes_of_hash(parts[0])) + std::string(bytes_of_hash(parts[1])));
}

Settings settings_of(const Scene& scene) {
  Settings s;
  const Camera& c = scene.camera;
  s.origin = {scene.origin};
  s.camera = {c.from.x,
              c.from.y,
              c.from.z,
              c.at.x,
              c.at.y,
              c.at.z,
              c.up.x,
              c.up.y,
              c.up.z,
              c.fov_deg,
              scene.requests.near_clip};
  s.raster = {uint32_t(c.width), uint32_t(c.height), uint32_t(scene.requests.samples_per_pixel)};
  if (c.lens_radius) s.lens_radius = {*c.lens_radius};
  if (c.focus_distance) s.focus_distance = {*c.focus_distance};
  if (c.horizontal_fov_deg > 0) s.camera_across = {c.horizontal_fov_deg};
  if (c.projection != Projection()) s.camera_projection = {uint32_t(c.projection)};
  if (const auto& m = c.movement)
    s.camera_movement = {m->from.x, m->from.y, m->from.z, m->at.x,
                         m->at.y,   m->at.z,   m->begin,  m->end};
  s.background = {scene.background};
  for (const Light& light : scene.lights) {
    s.light_positions.push_back(light.position);
    s.light_colored.push_back(light.color.has_value());
    s.light_colors.push_back(light.color.value_or(Rgb()));
  }
  if (std::ranges::any_of(scene.lights, [](const Light& l) { return l.extent.has_value(); }))
    for (const Light& light : scene.lights) {
      const LightExtent e = light.extent.value_or(LightExtent{.points = 0});
      s.light_extents.push_back({e.width, e.depth, float(e.points)});
    }
  if (scene.dialect != Dialect::nff || scene.requests.structure != AccelHint::any)
    s.dialect = {uint32_t(scene.dialect), uint32_t(scene.requests.structure)};
  s.sky_folder.insert(s.sky_folder.end(), scene.requests.sky_folder.begin(),
                      scene.requests.sky_folder.end());
  for (const std::string& name : scene.object_names) {
    s.object_names.insert(s.object_names.end(), name.begin(), name.end());
    s.object_name_ends.push_back(uint32_t(s.object_names.size()));
  }
  for (const Object& object : scene.prototypes) {
    const auto bytes =
        std::make_shared<const std::string>(encode_raio_scene(standalone(scene, object)));
    s.prototypes.push_back(Array<char>::borrow(bytes->data(), bytes->size(), bytes));
  }
  return s;
}

namespace {

// Sets the extents of existing lights.
std::string apply_extents(const Array<Vec3f>& extents, Scene& scene) {
  if (extents.empty()) return {};
  if (extents.size() != scene.lights.size()) return "light_extents differs in length from lights";
  bool any = false;
  for (size_t i = 0; i < extents.size(); ++i) {
    const Vec3f e = extents[i];
    if (e == Vec3f()) continue;
    if (!(e.z >= 1 && e.z <= kMaxLightPoints && e.z == std::floor(e.z)))
      return "light_extents has an invalid number of points";
    scene.lights[i].extent = LightExtent{e.x, e.y, int(e.z)};
    any = true;
  }
  return any ? "" : "light_extents has no light with an extent";
}

std::string apply_dialect(const Array<uint32_t>& numbers, Scene& scene) {
  if (numbers.empty()) return {};
  if (numbers.size() != 2 || numbers[0] > uint32_t(Dialect::data) ||
      numbers[1] > uint32_t(AccelHint::bvh) || numbers[0] + numbers[1] == 0)
    return "dialect must be two valid numbers";
  scene.dialect = Dialect(numbers[0]), scene.requests.structure = AccelHint(numbers[1]);
  return {};
}

}  // namespace

std::string apply(const Settings& s, Scene& scene) {
  const size_t lights = s.light_positions.size();
  if (s.origin.size() != 1 || s.camera.size() != 11 || s.raster.size() != 3 ||
      s.background.size() != 1 || s.lens_radius.size() > 1 || s.focus_distance.size() > 1 ||
      s.camera_across.size() > 1 || s.camera_projection.size() > 1 ||
      (!s.camera_movement.empty() && s.camera_movement.size() != 8))
    return "the columns of the settings have wrong lengths";
  if (s.light_colored.size() != lights || s.light_colors.size() != lights)
    return "the columns of the lights differ in length";
  scene.origin = s.origin[0];
  const auto& c = s.camera;
  scene.camera = {.from = {c[0], c[1], c[2]},
                  .at = {c[3], c[4], c[5]},
                  .up = {c[6], c[7], c[8]},
                  .fov_deg = c[9],
                  .horizontal_fov_deg = 0,
                  .projection = {},
                  .width = int(s.raster[0]),
                  .height = int(s.raster[1]),
                  .lens_radius = {},
                  .focus_distance = {},
                  .movement = {}};
  scene.requests.samples_per_pixel = int(s.raster[2]);
  scene.requests.near_clip = c[10];
  if (!s.camera_across.empty()) {
    scene.camera.horizontal_fov_deg = s.camera_across[0];
    if (!(scene.camera.horizontal_fov_deg > 0)) return "camera_across is not positive";
  }
  if (!s.camera_projection.empty()) {
    scene.camera.projection = Projection(s.camera_projection[0]);
    if (scene.camera.projection == Projection()) return "camera_projection is perspective";
  }
  if (!s.lens_radius.empty()) scene.camera.lens_radius = s.lens_radius[0];
  if (!s.focus_distance.empty()) scene.camera.focus_distance = s.focus_distance[0];
  if (const auto& m = s.camera_movement; !m.empty())
    scene.camera.movement = {{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, m[6], m[7]};
  scene.background = s.background[0];
  for (size_t i = 0; i < lights; ++i) {
    if (s.light_colored[i] > 1) return "light_colored is neither 0 nor 1";
    scene.lights.push_back({s.light_positions[i], {}, {}});
    if (s.light_colored[i]) scene.lights.back().color = s.light_colors[i];
    // Bit for bit, since a scene has exactly one file.
    else if (std::bit_cast<std::array<uint32_t, 3>>(s.light_colors[i]) != std::array<uint32_t, 3>())
      return "a light without a colour has a nonzero one";
  }
  if (std::string wrong = apply_extents(s.light_extents, scene); !wrong.empty()) return wrong;
  if (std::string wrong = apply_dialect(s.dialect, scene); !wrong.empty()) return wrong;
  scene.requests.sky_folder.assign(s.sky_folder.begin(), s.sky_folder.end());
  size_t begin = 0;
  for (const uint32_t end : s.object_name_ends) {
    if (end < begin || end > s.object_names.size()) return "object_name_ends is out of range";
    scene.object_names.emplace_back(s.object_names.data() + begin, end - begin);
    begin = end;
  }
  if (begin != s.object_names.size()) return "object_names has bytes after the last name";
  return {};
}

}  // namespace raio::core::scene_file
