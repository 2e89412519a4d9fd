// The integrator for light over many bounces, against closed forms.
#include "integrate/path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "one_picture.h"
#include "render/warnings.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::expect_one_picture;
using tests::if_sanitized;
using tests::picture_of;

// A floor of the material, seen from above at an angle, in a white world.
Scene floor_of(const Material& material, const StandardSurface& surface) {
  Scene scene;
  scene.background = Rgb(1);
  scene.camera.from = {0, -2, 1}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 0, 1};
  scene.camera.fov_deg = 30;
  scene.add_material(material);
  scene.set_standard_surface(surface);
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {0};
  return scene;
}

RenderOptions paths(int samples, int depth) {
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 8;
  options.samples = samples, options.depth = depth;
  return options;
}

double mean(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels)
    sum += (double(pixel.x) + double(pixel.y) + double(pixel.z)) / 3;
  return sum / double(image.pixels.size());
}

// What reflects or transmits everything is not visible in a white world.
TEST(Path, WhiteSurfacesKeepAllEnergy) {
  struct Kind {
    const char* name;
    StandardSurface surface;
  };
  const auto with = [](auto&& change) {
    StandardSurface surface;
    change(surface);
    return surface;
  };
  const Kind kinds[] = {
      {"metal", with([](auto& s) { s.metallic = 1; })},
      {"dielectric", with([](auto& s) { s.metallic = 0; })},
      {"half metal", with([](auto& s) { s.metallic = 0.5f; })},
      {"sheet of glass", with([](auto& s) { s.transmission = 1; })},
      {"glass", with([](auto& s) { s.transmission = 1, s.is_thin = 0; })},
      {"half glass", with([](auto& s) { s.transmission = 0.5f, s.is_thin = 0; })},
      {"coated metal", with([](auto& s) { s.metallic = 1, s.coat = 1; })},
      {"coated dielectric", with([](auto& s) { s.coat = 0.5f, s.coat_roughness = 0.5f; })},
      {"coated glass", with([](auto& s) { s.transmission = 1, s.is_thin = 0, s.coat = 1; })},
      {"sheen", with([](auto& s) { s.sheen_color = Rgb(1), s.sheen_roughness = 0.5f; })},
      {"coated sheen",
       with([](auto& s) { s.sheen_color = Rgb(1), s.sheen_roughness = 0.3f, s.coat = 1; })},
  };
  const int step = if_sanitized(5, 2);
  for (const Kind& kind : kinds)
    for (int tenths = 0; tenths <= 10; tenths += step) {
      StandardSurface surface = kind.surface;
      surface.roughness = float(tenths) / 10;
      const Scene scene = floor_of({.color = Rgb(1), .kd = 1, .ior = 1.5f}, surface);
      EXPECT_NEAR(mean(picture_of(scene, paths(if_sanitized(256, 4096), 3))), 1,
                  if_sanitized(5e-3, 1e-3))
          << kind.name << ", roughness " << surface.roughness;
    }
}

// Light that refracts into a ball leaves it.
TEST(Path, ABallOfGlassIsNotVisibleInAWhiteWorld) {
  for (const float coat : {0.0f, 1.0f}) {
    Scene scene = floor_of({.color = Rgb(1), .kd = 1, .ior = 1.5f},
                           {.roughness = 0, .transmission = 1, .is_thin = 0, .coat = coat});
    scene.planes = {}, scene.plane_materials = {};
    scene.spheres = {{{0, 0, 0}, 0.5f}}, scene.sphere_materials = {0};
    EXPECT_NEAR(mean(picture_of(scene, paths(64, 16))), 1, 1e-3) << coat;
  }
}

// Of a black surface under a smooth coat, only Fresnel's reflection is left, and of what it emits,
// the rest. A perfect mirror below it reflects all the rest.
TEST(Path, ASmoothCoatReflectsByFresnel) {
  const double cosine = 1 / std::sqrt(5.0), behind = std::sqrt(1 - 0.8 / 2.25);
  const double s = (cosine - 1.5 * behind) / (cosine + 1.5 * behind);
  const double p = (1.5 * cosine - behind) / (1.5 * cosine + behind);
  const double reflectance = (s * s + p * p) / 2;
  const auto seen = [&](const StandardSurface& surface, float color) {
    Scene scene = floor_of({.color = Rgb(color), .kd = 1, .ior = 1.5f}, surface);
    scene.camera.fov_deg = 0.001f;
    return mean(picture_of(scene, paths(1024, 2)));
  };
  EXPECT_NEAR(seen({.specular = 0, .coat = 1}, 0), reflectance, 1e-3);
  EXPECT_NEAR(seen({.specular = 0, .coat = 0.5f}, 0), reflectance / 2, 1e-3);
  EXPECT_NEAR(seen({.metallic = 1, .roughness = 0, .coat = 1}, 0.25f),
              reflectance + (1 - reflectance) * (0.25 + 0.75 * std::pow(1 - cosine, 5)), 2e-3);
  EXPECT_NEAR(seen({.specular = 0, .emission = Rgb(4), .coat = 1}, 0),
              reflectance + 4 * (1 - reflectance), 2e-3);
}

// Sheen is bright at grazing angles, in its colour.
TEST(Path, SheenHasItsColor) {
  const auto seen = [](float height) {
    Scene scene =
        floor_of({.color = Rgb(0), .kd = 1},
                 {.specular = 0, .sheen_color = {0.25f, 0.5f, 1}, .sheen_roughness = 0.4f});
    scene.camera.from.z = height, scene.camera.fov_deg = 0.001f;
    return picture_of(scene, paths(1024, 2)).pixels[0];
  };
  const Rgb above = seen(20), grazing = seen(0.2f);
  EXPECT_NEAR(grazing.x / grazing.z, 0.25f, 1e-4f);
  EXPECT_NEAR(grazing.y / grazing.z, 0.5f, 1e-4f);
  EXPECT_GT(grazing.z, 0.5f);
  EXPECT_LT(above.z, 0.05f);
}

// The law of Bouguer and Beer along a diameter.
TEST(Path, AMediumAbsorbs) {
  Scene scene =
      floor_of({.color = Rgb(1), .kd = 1, .ior = 1}, {.roughness = 0,
                                                      .transmission = 1,
                                                      .is_thin = 0,
                                                      .attenuation_color = {0.5f, 0.25f, 1},
                                                      .attenuation_distance = 2});
  scene.planes = {}, scene.plane_materials = {};
  scene.spheres = {{{0, 0, 0}, 0.5f}}, scene.sphere_materials = {0};
  scene.camera.fov_deg = 0.001f;
  const Rgb seen = picture_of(scene, paths(4, 3)).pixels[0];
  EXPECT_NEAR(seen.x, std::sqrt(0.5f), 1e-5);
  EXPECT_NEAR(seen.y, 0.5f, 1e-5);
  EXPECT_NEAR(seen.z, 1, 1e-5);
}

// A diffuse floor, seen where the shape above it is, which shines down.
Scene lit_floor() {
  Scene scene = floor_of({.color = Rgb(0.5f), .kd = 1}, {.is_standard = 0});
  scene.background = Rgb(0);
  scene.camera.from = {0.3f, -0.4f, 0.5f}, scene.camera.fov_deg = 0.001f;
  scene.add_material({.color = Rgb(0), .kd = 1});
  scene.set_standard_surface({.emission = Rgb(8), .is_two_sided = 0});
  return scene;
}

TEST(Path, ASquareLightHasItsFormFactor) {
  constexpr float kSide = 1.5f, kHeight = 2;
  Scene scene = lit_floor();
  Mesh mesh;
  const float h = kSide / 2;
  mesh.positions = {{-h, -h, kHeight}, {-h, h, kHeight}, {h, h, kHeight}, {h, -h, kHeight}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {1};
  scene.meshes = {mesh};
  const double a = double(h) / kHeight, b = std::sqrt(1 + a * a);
  const double factor = 4 * (2 * a / b * std::atan(a / b)) / (2 * std::numbers::pi);
  EXPECT_NEAR(mean(picture_of(scene, paths(1024, 2))), 0.5 * 8 * factor, 1e-3 * 4 * factor);
  // It is dark from behind, and only emission is seen at depth 1.
  EXPECT_EQ(mean(picture_of(scene, paths(16, 1))), 0);
  scene.meshes[0].triangles = {{0, 2, 1}, {0, 3, 2}};
  EXPECT_EQ(mean(picture_of(scene, paths(16, 2))), 0);
}

// The same light in an instance, and as many small triangles.
TEST(Path, LightsMayBeInstancesOrMany) {
  Scene scene = lit_floor();
  constexpr int kCells = 20;
  Mesh mesh;
  for (int y = 0; y <= kCells; ++y)
    for (int x = 0; x <= kCells; ++x)
      mesh.positions.push_back({float(x) / kCells - 0.5f, float(y) / kCells - 0.5f, 0});
  for (uint32_t y = 0; y < kCells; ++y)
    for (uint32_t x = 0; x < kCells; ++x) {
      const uint32_t at = y * (kCells + 1) + x, above = at + kCells + 1;
      mesh.triangles.push_back({at, above, above + 1}),
          mesh.triangles.push_back({at, above + 1, at + 1});
    }
  mesh.materials = {1};
  Object object;
  object.meshes = {mesh};
  scene.prototypes = {object};
  scene.instances = {{0, {1.5f, 0, 0, 0, 0, 1.5f, 0, 0, 0, 0, 1, 2}}};
  const double a = 0.375, b = std::sqrt(1 + a * a);
  const double factor = 4 * (2 * a / b * std::atan(a / b)) / (2 * std::numbers::pi);
  EXPECT_NEAR(mean(picture_of(scene, paths(1024, 2))), 4 * factor, 0.01 * factor);
}

// A disc is no triangle, so only reflected rays find it.
TEST(Path, ADiscShinesWithoutBeingSampled) {
  Scene scene = lit_floor();
  scene.discs = {{{0, 0, 2}, {0, 0, -1}, 1, 0}};
  scene.disc_materials = {1};
  EXPECT_NEAR(mean(picture_of(scene, paths(4096, 2))), 0.5 * 8 / 5, 5e-3);
}

// A point light of the intensity I gives the irradiance I cos / d^2.
TEST(Path, APointLightDecreasesWithTheSquareOfTheDistance) {
  Scene scene = lit_floor();
  scene.physical_lights = {{.kind = LightKind::point, .color = Rgb(10), .position = {0, 0, 4}}};
  EXPECT_NEAR(mean(picture_of(scene, paths(4, 2))), 0.5 / std::numbers::pi * 10 / 16, 1e-5);
}

// So close to a point that the film cannot add the light.
TEST(Path, ClampedSamplesAreCounted) {
  Scene scene = lit_floor();
  scene.physical_lights = {{.kind = LightKind::point, .color = Rgb(10), .position = {0, 0, 4}}};
  scene.standard_surfaces[1].emission = Rgb(1);
  scene.materials[0].color = Rgb(1e6f),
  scene.standard_surfaces[0] = {.metallic = 1, .roughness = 1};
  const RenderSettings settings = resolve_options(paths(4, 2), scene);
  const auto accel = build_accel(scene, settings.accel, settings.one_sided);
  const auto film = make_film(scene, settings);
  WorkControl control;
  ASSERT_TRUE(render(scene, **accel, settings, **film, control).finished);
  EXPECT_EQ((*film)->faults().clamped.count, 4u * 8 * 8);
  EXPECT_FLOAT_EQ((*film)->resolve().at(3, 3).x, float((*film)->bound()));
  EXPECT_EQ(fault_warnings(**film, Crop{10, 20, 18, 28}).size(), 1u);
  EXPECT_THAT(fault_warnings(**film, Crop{10, 20, 18, 28})[0],
              testing::StartsWith("256 samples are clamped to "));
}

// Between two parallel planes, the light of all bounces is a geometric series.
TEST(Path, BouncesAddUp) {
  Scene scene = lit_floor();
  scene.materials.resize(1), scene.standard_surfaces.resize(1);
  scene.add_material({.color = Rgb(0.5f), .kd = 1});
  scene.set_standard_surface({.specular = 0, .emission = Rgb(8)});
  scene.planes.push_back({{0, 0, 3}, {0, 0, -1}}), scene.plane_materials.push_back(1);
  EXPECT_NEAR(mean(picture_of(scene, paths(16, 2))), 4, 1e-3);
  EXPECT_NEAR(mean(picture_of(scene, paths(16, 4))), 4 * 1.25, 1e-2);
  EXPECT_NEAR(mean(picture_of(scene, paths(1024, 32))), 4 / 0.75, 2e-2);
}

TEST(Path, OnePictureForAllThreadsAndInstructionSets) {
  Scene scene = tests::random_scene(40, 3);
  scene.set_standard_surface({.metallic = 0.5f,
                              .roughness = 0.3f,
                              .emission = Rgb(2),
                              .coat = 0.75f,
                              .coat_roughness = 0.2f,
                              .sheen_color = {0.5f, 0.75f, 0.25f},
                              .sheen_roughness = 0.4f});
  RenderOptions options = paths(4, 8);
  options.width = 40, options.height = 30, options.soft_shadows = true;
  expect_one_picture(scene, options);
}

}  // namespace
}  // namespace raio::core
