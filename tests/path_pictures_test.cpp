// Pictures of the integrator `path`: lights and glass against closed forms, its two ways to find a
// light against each other, and the same bytes for any division of the work.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "io/scene_file.h"
#include "one_picture.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using std::numbers::pi;
using tests::if_sanitized;
using tests::picture_of;
using tests::same_bytes;

// Seen at the origin, from `eye`, in a world of this radiance; material 0 is a grey floor's.
Scene seen_from(Vec3f eye, float world = 0) {
  Scene scene;
  scene.background = Rgb(world);
  scene.camera.from = eye, scene.camera.at = {}, scene.camera.up = {0.1f, 1, 0.2f};
  scene.camera.fov_deg = 0.001f;
  scene.add_material({.color = Rgb(0.5f), .kd = 1});
  scene.set_standard_surface({.is_standard = 0});
  return scene;
}
Scene grey_floor() {
  Scene scene = seen_from({0.3f, -0.4f, 0.5f});
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}}, scene.plane_materials = {0};
  return scene;
}

RenderOptions by_paths(int samples, int depth) {
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 8;
  options.samples = samples, options.depth = depth;
  return options;
}

double mean_of(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += double(pixel.x + pixel.y + pixel.z) / 3;
  return sum / double(image.pixels.size());
}

// A square of side 2 at height 1 that shines down.
Scene under_square() {
  Scene scene = grey_floor();
  scene.add_material({.color = Rgb(0), .kd = 1});
  scene.set_standard_surface({.specular = 0, .emission = Rgb(1), .is_two_sided = 0});
  return scene;
}
void add_square_mesh(Scene& scene, uint32_t cells) {
  Mesh mesh;
  for (uint32_t y = 0; y <= cells; ++y)
    for (uint32_t x = 0; x <= cells; ++x)
      mesh.positions.push_back(
          {2 * float(x) / float(cells) - 1, 2 * float(y) / float(cells) - 1, 1});
  for (uint32_t y = 0; y < cells; ++y)
    for (uint32_t x = 0; x < cells; ++x) {
      const uint32_t at = y * (cells + 1) + x, above = at + cells + 1;
      mesh.triangles.push_back({at, above, above + 1});
      mesh.triangles.push_back({at, above + 1, at + 1});
    }
  mesh.materials = {1};
  scene.meshes = {mesh};
}
double square_irradiance() {  // over pi
  const double a = 1 / std::sqrt(2.0);
  return 4 * (2 * a * std::atan(a)) / (2 * pi);
}

TEST(PathPictures, DistantAndSpotLights) {
  Scene scene = grey_floor();
  PhysicalLight light;
  light.kind = LightKind::directional, light.color = Rgb(3), light.direction = {-3, 0, -4};
  scene.physical_lights = {light};
  EXPECT_NEAR(mean_of(picture_of(scene, by_paths(4, 2))), 0.5 / pi * 3 * 0.8, 1e-5);
  // An angle of 22 degrees from the axis, in the border from 20 to 30: a cubic of the cosine.
  const double angle = 22 * pi / 180, outer = std::cos(pi / 6), inner = std::cos(pi / 9);
  light.kind = LightKind::spot, light.position = {0, 0, 2}, light.opening = 60, light.falloff = 10;
  light.direction = Vec3f(Vec3d(std::sin(angle), 0, -std::cos(angle)));
  scene.physical_lights = {light};
  const double t = (std::cos(angle) - outer) / (inner - outer);
  EXPECT_NEAR(mean_of(picture_of(scene, by_paths(4, 2))), 0.5 / pi * 3 / 4 * t * t * (3 - 2 * t),
              1e-5);
}

// A convex body that reflects all light, in light from everywhere.
TEST(PathPictures, AWhiteSphereIsAsBrightAsItsWorld) {
  Scene scene = seen_from({0, -3, 1}, 0.75f);
  scene.add_material({.color = Rgb(1), .kd = 1});
  scene.set_standard_surface({.is_standard = 0});
  scene.spheres = {{{0, 0, 0}, 1}}, scene.sphere_materials = {1};
  scene.camera.fov_deg = 50;
  for (const Rgb& pixel : picture_of(scene, by_paths(16, 2)).pixels)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], 0.75f, 1e-5f);
  // Eye rays alone see no reflected light.
  EXPECT_EQ(picture_of(scene, by_paths(1, 1)).at(4, 4), Rgb(0));
}

// Tables of other scenes are kept from picture to picture.
TEST(PathPictures, DoNotDependOnEarlierOnes) {
  const auto picture = [](float ior, float coat) {
    Scene scene = seen_from({0, -3, 1}, 0.75f);
    scene.add_material({.color = Rgb(0.5f), .kd = 1, .ior = ior});
    scene.set_standard_surface({.roughness = 0.5f, .coat = coat, .coat_roughness = 0.2f});
    scene.spheres = {{{0, 0, 0}, 1}}, scene.sphere_materials = {1};
    scene.camera.fov_deg = 50;
    return picture_of(scene, by_paths(4, 3));
  };
  const Image first = picture(1.37f, 0.6f);
  (void)picture(1.71f, 0.3f), (void)picture(1.37f, 0);
  EXPECT_TRUE(same_bytes(first, picture(1.37f, 0.6f)));
}

TEST(PathPictures, EmissionIsSeenDirectly) {
  Scene scene = under_square();
  scene.camera.from = {0.1f, 0.2f, -1}, scene.camera.at = {0.1f, 0.2f, 1};
  scene.planes = {}, scene.plane_materials = {};
  add_square_mesh(scene, 2);
  for (const int depth : {1, 5}) EXPECT_EQ(picture_of(scene, by_paths(4, depth)).pixels[0], Rgb(1));
  scene.camera.from.z = 3;  // its back
  EXPECT_EQ(picture_of(scene, by_paths(4, 5)).pixels[0], Rgb(0));
}

// Reflected many times between the faces of a sheet, at 45 degrees.
TEST(PathPictures, ASheetOfGlassTintsWhatItTransmits) {
  Scene scene = seen_from({0, 2, 2}, 1);
  scene.add_material({.color = Rgb(0.25f), .kd = 1, .ior = 1.5f});
  scene.set_standard_surface({.roughness = 0, .transmission = 1, .is_thin = 1});
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}}, scene.plane_materials = {1};
  const double cosine = std::sqrt(0.5), behind = std::sqrt(1 - 0.5 / 2.25);
  const double s = (cosine - 1.5 * behind) / (cosine + 1.5 * behind);
  const double p = (1.5 * cosine - behind) / (1.5 * cosine + behind);
  const double one = (s * s + p * p) / 2, both = 2 * one / (1 + one);
  EXPECT_NEAR(mean_of(picture_of(scene, by_paths(1024, 4))), both + 0.25 * (1 - both), 2e-3);
}

// A slab of a medium, seen head-on: of the light of a white world, what all orders of internal
// reflection leave.
TEST(PathPictures, ASlabAbsorbsAlongAllItsReflections) {
  Scene scene = seen_from({0, 0, 2}, 1);
  scene.add_material({.color = Rgb(1), .kd = 1, .ior = 2});
  scene.set_standard_surface({.roughness = 0,
                              .transmission = 1,
                              .is_thin = 0,
                              .attenuation_color = Rgb(0.5f),
                              .attenuation_distance = 2});
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}, {{0, 0, -1}, {0, 0, -1}}};
  scene.plane_materials = {1, 1};
  const double r = 1.0 / 9, a = std::sqrt(0.5);
  const double all = r + (1 - r) * (1 - r) * a / (1 - r * a);
  EXPECT_NEAR(mean_of(picture_of(scene, by_paths(2048, 16))), all, 2e-3);
}

// Triangles are sampled as lights, a polygon is found by reflected rays alone.
TEST(PathPictures, BothWaysToFindALightAgree) {
  for (const float roughness : {0.2f, 0.5f, 1.0f})
    for (const int kind : {0, 1, 2}) {
      Scene scene = under_square();
      scene.add_material({.color = Rgb(0.8f), .kd = 1, .ior = 1.5f});
      scene.set_standard_surface({.metallic = kind == 1 ? 1.0f : 0.0f, .roughness = roughness});
      if (kind == 2) {
        StandardSurface& coated = scene.standard_surfaces[2];
        coated.coat = 1, coated.coat_roughness = roughness;
        coated.sheen_color = Rgb(0.5f), coated.sheen_roughness = roughness;
        scene.standard_surfaces[1].coat = 1;
      }
      scene.plane_materials = {2};
      Scene other = scene;
      add_square_mesh(scene, 3);
      other.positions = {{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}};
      other.polygons = {{0, 4}}, other.polygon_materials = {1};
      const double two = mean_of(picture_of(scene, by_paths(if_sanitized(256, 1024), 2)));
      const double one = mean_of(picture_of(other, by_paths(if_sanitized(1024, 16384), 2)));
      EXPECT_GT(two, 0.05);
      EXPECT_NEAR(two / one, 1, if_sanitized(3e-2, 5e-3)) << roughness << ' ' << kind;
    }
}

// Each group is the picture without the others' light.
TEST(PathPictures, LightGroupsAddUp) {
  const auto scene_with = [](bool lamp, bool emission, bool world) {
    Scene scene = under_square();
    scene.background = Rgb(world ? 0.5f : 0);
    if (emission) add_square_mesh(scene, 1);
    if (lamp) scene.physical_lights = {{.color = Rgb(2), .position = {1.5f, 0, 0.7f}}};
    scene.spheres = {{{0.4f, 0.3f, 0.2f}, 0.2f}}, scene.sphere_materials = {0};
    return scene;
  };
  RenderOptions options = by_paths(if_sanitized(256, 4096), 3);
  const Image lamp = picture_of(scene_with(true, false, false), options);
  const Image square = picture_of(scene_with(false, true, false), options);
  for (const Channel group : kLightGroups) options.channels.add(group);
  const auto film = tests::film_of(scene_with(true, true, true), options);
  const Image whole = film->resolve();
  std::array<double, 3> means{};
  std::vector<double> sum(whole.pixels.size());
  for (size_t g = 0; g < means.size(); ++g) {
    const auto values = std::get<Column<float>>(film->resolve(kLightGroups[g]));
    for (size_t i = 0; i < values.size(); ++i)
      sum[i / 3] += double(values[i]), means[g] += double(values[i]) / double(values.size());
  }
  for (size_t i = 0; i < sum.size(); ++i) {
    const Rgb& pixel = whole.pixels[i];
    EXPECT_NEAR(sum[i], double(pixel.x + pixel.y + pixel.z), 1e-5);
  }
  EXPECT_NEAR(means[0] / mean_of(lamp), 1, if_sanitized(0.1, 0.02));
  EXPECT_NEAR(means[1] / mean_of(square), 1, if_sanitized(0.1, 0.02));
  EXPECT_GT(means[2], 0.01);
  EXPECT_TRUE(same_bytes(whole, picture_of(scene_with(true, true, true), [&] {
                           RenderOptions plain = options;
                           plain.channels = {};
                           return plain;
                         }())));
}

TEST(PathPictures, OtherIntegratorsHaveNoLightGroups) {
  RenderOptions options = by_paths(1, 1);
  options.channels.add(Channel::emission);
  options.integrator = IntegratorKind::classic;
  const Scene scene = grey_floor();
  const auto why = option_conflict(options, &scene);
  ASSERT_TRUE(why);
  EXPECT_NE(why->message.find("emission needs the integrator path"), std::string::npos);
}

// Means of pictures with different seeds are within their confidence interval, five standard
// errors.
TEST(PathPictures, IsUnbiased) {
  for (const uint32_t cells : {1u, 4u}) {
    Scene scene = under_square();
    add_square_mesh(scene, cells);
    RenderOptions options = by_paths(1, 2);
    double sum = 0, squares = 0;
    constexpr int kSeeds = 100;
    for (int seed = 0; seed < kSeeds; ++seed) {
      options.seed = uint32_t(seed);
      const double mean = mean_of(picture_of(scene, options));
      sum += mean, squares += mean * mean;
    }
    const double mean = sum / kSeeds;
    const double error = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
    const double expected = 0.5 * square_irradiance();
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 0.02 * expected);
    EXPECT_NEAR(mean, expected, 5 * error) << cells;
  }
}

// Instances, and the triangles that they stand for.
TEST(PathPictures, InstancesOfLightsEqualTheirTriangles) {
  Scene scene = under_square();
  add_square_mesh(scene, 4);
  Object object;
  object.meshes = {scene.meshes[0]};
  scene.meshes = {};
  scene.prototypes = {object};
  scene.instances = {{0, {0.5f, 0, 0, 0.1f, 0, 0.5f, 0, 0, 0, 0, 0.5f, 0.3f}},
                     {0, {0, 0.4f, 0, -0.6f, -0.4f, 0, 0, 0, 0, 0, 0.4f, 0.5f}}};
  const double placed = mean_of(picture_of(scene, by_paths(2048, 2)));
  ASSERT_EQ(flatten_instances(scene), "");
  const double flat = mean_of(picture_of(scene, by_paths(2048, 2)));
  EXPECT_GT(flat, 0.05);
  EXPECT_NEAR(placed / flat, 1, 3e-3);
}

// Standard surfaces of all kinds, some of which shine.
Scene shining_scene(uint32_t seed) {
  Scene scene = tests::random_scene(60, seed);
  scene.standard_surfaces = {{.metallic = 0.5f, .roughness = 0.3f, .emission = Rgb(2)},
                             {.roughness = 0.4f,
                              .transmission = 0.7f,
                              .is_thin = 1,
                              .coat = 1,
                              .sheen_color = {0.2f, 1, 0.6f},
                              .sheen_roughness = 0.3f},
                             {.roughness = 0.2f,
                              .transmission = 1,
                              .is_thin = 0,
                              .attenuation_color = {0.5f, 1, 0.2f},
                              .attenuation_distance = 1,
                              .coat = 0.5f,
                              .coat_roughness = 0.3f}};
  return scene;
}

// However the samples and the tiles are divided.
TEST(PathPictures, SpansAndShardsAddUp) {
  const Scene scene = shining_scene(3);
  RenderOptions options = by_paths(5, 8);
  options.width = 70, options.height = 40;
  const Image whole = picture_of(scene, options);
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel, settings.one_sided);
  const auto film = make_film(scene, settings);
  WorkControl control;
  for (const RenderTask& task : {RenderTask{.samples = 2, .shard = 1, .shards = 2},
                                 RenderTask{.samples = 5, .first_sample = 3}, RenderTask{}})
    EXPECT_TRUE(render(scene, **accel, settings, **film, control, task).finished);
  EXPECT_TRUE(same_bytes((*film)->resolve(), whole));
}

void expect_no_nan(const Scene& scene, RenderOptions options, const std::string& name) {
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel, settings.one_sided);
  ASSERT_TRUE(accel) << name;
  const auto film = make_film(scene, settings);
  WorkControl control;
  EXPECT_TRUE(render(scene, **accel, settings, **film, control).finished);
  EXPECT_EQ((*film)->faults().nans.count, 0u) << name;
}

TEST(PathPictures, NoSceneGivesNan) {
  RenderOptions options = by_paths(4, 16);
  options.width = 48, options.height = 36;
  for (uint32_t seed = 0; seed < if_sanitized(3u, 20u); ++seed) {
    expect_no_nan(tests::random_scene(60, seed), options, std::to_string(seed));
    expect_no_nan(shining_scene(seed), options, "shining " + std::to_string(seed));
  }
  size_t files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(RAIO_SOURCE_DIR) / "scenes")) {
    if (!entry.is_regular_file()) continue;
    const auto read = read_scene(entry.path());
    ASSERT_TRUE(read) << entry.path();
    expect_no_nan(read->scene, options, entry.path().string());
    ++files;
  }
  EXPECT_GT(files, 10u);
}

}  // namespace
}  // namespace raio::core
