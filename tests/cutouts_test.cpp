// The alpha of textures, in all integrators, against the light that it lets through.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "integrate/explain.h"
#include "one_picture.h"

namespace raio::core {
namespace {

using std::numbers::pi;
using tests::expect_one_picture;
using tests::picture_of;

constexpr uint32_t texel_of_alpha(uint32_t alpha) { return (255 - alpha) << 24 | 0xffffff; }
constexpr double kAlpha = 102 / 255.0;

Mesh square(float half, float height, MaterialId material) {
  Mesh mesh;
  mesh.positions = {
      {-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}};
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {material};
  return mesh;
}

// Black sheets above each other, seen obliquely from above, in front of a grey background. Material
// 0 is theirs, with texture 0.
Scene with_sheets(int sheets, uint32_t texel, StandardSurface surface = {}, float opacity = 1) {
  Scene scene;
  scene.background = Rgb(0.75f);
  scene.camera.from = {0.9f, 0.3f, 5}, scene.camera.at = {0.1f, 0.2f, 0};
  scene.camera.up = {0.1f, 1, 0.2f}, scene.camera.fov_deg = 0.5f;
  scene.texels = {texel}, scene.textures = {{0, 1, 1}};
  scene.add_material({.color = Rgb(0), .kd = 1}, Rgb(1), 0, opacity, 0);
  surface.specular = 0;
  if (surface.alpha_mode == AlphaMode::opaque) surface.alpha_mode = AlphaMode::blend;
  scene.set_standard_surface(surface);
  for (int i = 0; i < sheets; ++i) scene.meshes.push_back(square(4, 0.1f * float(i), 0));
  return scene;
}
StandardSurface masked(float cutoff) {
  return {.alpha_mode = AlphaMode::mask, .alpha_cutoff = cutoff};
}

// The same with a white diffuse floor below, and a light above.
Scene above_floor(Scene scene) {
  scene.camera.from = {0.9f, 0.3f, -0.5f}, scene.camera.at = {0.1f, 0.2f, -1};
  scene.background = Rgb(0);
  scene.add_material({.color = Rgb(1), .kd = 1});
  scene.set_standard_surface({.is_standard = 0});
  scene.planes = {{{0, 0, -1}, {0, 0, 1}}};
  scene.plane_materials = {MaterialId(scene.materials.size() - 1)};
  PhysicalLight sun;
  sun.kind = LightKind::directional, sun.color = Rgb(float(pi)), sun.direction = {-0.1f, 0.2f, -1};
  scene.physical_lights = {sun};
  return scene;
}

RenderOptions options_of(IntegratorKind integrator, int samples) {
  RenderOptions options;
  options.integrator = integrator;
  options.width = options.height = 16;
  options.samples = samples;
  options.shading = ShadingModel::phong;  // without ambient light
  options.depth = 2;
  return options;
}

double red_mean(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += double(pixel.x);
  return sum / double(image.pixels.size());
}

double seen_through(const Scene& scene, IntegratorKind integrator = IntegratorKind::path,
                    float opacity = 1) {
  RenderOptions options = options_of(integrator, 64);
  if (opacity < 1) options.opacity = opacity;
  return red_mean(expect_one_picture(scene, options)) / 0.75;
}

TEST(Cutouts, BlendLetsTheRestThrough) {
  for (const IntegratorKind integrator : {IntegratorKind::path, IntegratorKind::classic})
    for (const int sheets : {1, 3})
      EXPECT_NEAR(seen_through(with_sheets(sheets, texel_of_alpha(102), {}), integrator),
                  std::pow(1 - kAlpha, sheets), 2e-3)
          << kIntegratorNames[size_t(integrator)] << ", " << sheets;
}

TEST(Cutouts, MasksLetAllOrNothingThrough) {
  const uint32_t texel = texel_of_alpha(102);
  EXPECT_EQ(seen_through(with_sheets(3, texel, masked(0.41f))), 1);
  EXPECT_EQ(seen_through(with_sheets(3, texel, masked(0.39f))), 0);
  // A cutoff above all alphas needs no texture.
  Scene none = with_sheets(1, texel, masked(2));
  none.material_texture = {};
  EXPECT_EQ(seen_through(none), 1);
}

TEST(Cutouts, AlphaMultipliesTheOpacity) {
  const Scene scene = with_sheets(2, texel_of_alpha(102), {}, 0.5f);
  EXPECT_NEAR(seen_through(scene), std::pow(1 - kAlpha / 2, 2), 2e-3);
  EXPECT_NEAR(seen_through(with_sheets(2, texel_of_alpha(102)), IntegratorKind::path, 0.25f),
              std::pow(1 - kAlpha / 4, 2), 2e-3);
}

TEST(Cutouts, AlphaMultipliesTheTrianglesOwnOpacity) {
  Scene scene = with_sheets(2, texel_of_alpha(102));
  scene.triangle_opacity = {0.5f, 0.5f, 0.25f, 0.25f};
  EXPECT_NEAR(seen_through(scene), (1 - kAlpha / 2) * (1 - kAlpha / 4), 2e-3);
}

// Beside primitives with an opacity of their own.
TEST(Cutouts, AddToTransparentPrimitives) {
  Scene scene = with_sheets(2, texel_of_alpha(102));
  scene.add_material({.color = Rgb(0), .kd = 1}, Rgb(1), 0, 0.7f);
  scene.set_standard_surface({.specular = 0});
  scene.meshes.push_back(square(4, 0.05f, 1));
  EXPECT_NEAR(seen_through(scene), 0.3 * std::pow(1 - kAlpha, 2), 2e-3);
  const Scene lit = above_floor(scene);
  EXPECT_NEAR(red_mean(picture_of(lit, options_of(IntegratorKind::path, 64))) /
                  red_mean(picture_of(above_floor(with_sheets(0, 0)),
                                      options_of(IntegratorKind::path, 64))),
              0.3 * std::pow(1 - kAlpha, 2), 2e-3);
}

// Light with a direction of its own reaches the floor by shadow rays alone, whose share is exact.
TEST(Cutouts, ShadowsAreAsLightAsTheirTextures) {
  for (const IntegratorKind integrator :
       {IntegratorKind::path, IntegratorKind::ambient, IntegratorKind::classic}) {
    RenderOptions options = options_of(integrator, 1);
    const auto lit = [&](const Scene& scene) {
      Scene lit = above_floor(scene);
      if (integrator == IntegratorKind::classic)
        lit.physical_lights = {}, lit.lights = {{{1, 2, 10}, Rgb(1)}};
      options.sky_light = Rgb(0);
      return red_mean(expect_one_picture(lit, options));
    };
    SCOPED_TRACE(kIntegratorNames[size_t(integrator)]);
    const double all = lit(with_sheets(0, 0));
    EXPECT_GT(all, 0.1);
    EXPECT_NEAR(lit(with_sheets(1, texel_of_alpha(102))) / all, 1 - kAlpha, 1e-6);
    EXPECT_NEAR(lit(with_sheets(3, texel_of_alpha(102))) / all, std::pow(1 - kAlpha, 3), 1e-6);
    EXPECT_EQ(lit(with_sheets(3, texel_of_alpha(102), masked(0.41f))), all);
    EXPECT_EQ(lit(with_sheets(1, texel_of_alpha(255))), 0);
  }
}

// Both ways to find a light count its holes: here it emits as much as a grey one.
TEST(Cutouts, EmissionHasHoles) {
  for (const int samples : {1, 4}) {
    Scene scene = above_floor(with_sheets(1, texel_of_alpha(102), {.emission = Rgb(1)}));
    scene.physical_lights = {};
    RenderOptions options = options_of(IntegratorKind::path, 1024 * samples);
    const double cut = red_mean(picture_of(scene, options));
    scene.standard_surfaces[0].alpha_mode = AlphaMode::opaque;
    EXPECT_NEAR(cut / red_mean(picture_of(scene, options)), kAlpha, 3e-3);
    // As transparent triangles.
    scene.material_texture = {}, scene.material_opacity = {float(kAlpha), 1};
    EXPECT_NEAR(red_mean(picture_of(scene, options)), cut, 3e-3 * cut);
  }
}

TEST(Cutouts, OfInstancesAndGrazingRays) {
  Scene scene = with_sheets(0, texel_of_alpha(102));
  Object sheets;
  for (int i = 0; i < 3; ++i) sheets.meshes.push_back(square(40, 0.1f * float(i), 0));
  scene.prototypes = {sheets};
  scene.instances = {{0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -0.2f}}};
  EXPECT_NEAR(seen_through(scene), std::pow(1 - kAlpha, 3), 2e-3);
  scene.camera.from = {30, 3, 0.9f}, scene.camera.at = {0, 0, -0.1f};
  EXPECT_NEAR(seen_through(scene), std::pow(1 - kAlpha, 3), 2e-3);
  scene.instances.push_back({0, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, -1}});
  EXPECT_NEAR(seen_through(scene), std::pow(1 - kAlpha, 6), 2e-3);
}

TEST(Cutouts, ChannelsShowWhatIsBehindMasks) {
  const Scene scene = above_floor(with_sheets(1, texel_of_alpha(0)));
  RenderOptions options = options_of(IntegratorKind::path, 4);
  options.channels.add(Channel::depth);
  const auto depth = [&](const Scene& shown) {
    const RenderSettings settings = resolve_options(options, shown);
    const auto accel = build_accel(shown, settings.accel);
    WorkControl control;
    const auto film = make_film(shown, settings);
    EXPECT_TRUE(render(shown, **accel, settings, **film, control).finished);
    return std::get<Column<float>>((*film)->resolve(Channel::depth)).front();
  };
  Scene from_above = scene;
  from_above.camera.from.z = 5;
  EXPECT_NEAR(depth(from_above), 6, 0.1);
  from_above.texels = {texel_of_alpha(255)};
  EXPECT_NEAR(depth(from_above), 5, 0.1);
}

TEST(Cutouts, CannotBeExplained) {
  const Scene scene = with_sheets(1, texel_of_alpha(102));
  const RenderSettings settings = resolve_options(options_of(IntegratorKind::path, 1), scene);
  const auto accel = build_accel(scene, settings.accel);
  const auto explained = explain_sample(scene, **accel, settings, 1, 1, 0);
  ASSERT_FALSE(explained);
  EXPECT_NE(explained.error().text().find("alpha of textures"), std::string::npos);
}

}  // namespace
}  // namespace raio::core
