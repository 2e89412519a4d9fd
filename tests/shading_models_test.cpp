// The models of light that `shading` and `fresnel` choose, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "one_picture.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::expect_one_picture;
using tests::picture_of;
using tests::random_scene;
using tests::same_bytes;

RenderOptions with_models(ShadingModel shading, Fresnel fresnel) {
  RenderOptions options;
  options.shading = shading, options.fresnel = fresnel;
  return options;
}

// A plane through the origin, seen from `from`.
Scene plane_seen_from(Vec3f from, const Material& material) {
  Scene scene;
  scene.camera.from = from, scene.camera.at = {0, 0, 0}, scene.camera.fov_deg = 1;
  scene.materials = {material};
  scene.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  scene.plane_materials.push_back(0);
  return scene;
}

Rgb pixel(const Scene& scene, RenderOptions options) {
  options.width = options.height = 1;
  return expect_one_picture(scene, options).at(0, 0);
}

TEST(ShadingModels, HighlightsMatchPhongAndBlinn) {
  constexpr float kKd = 0.6f, kKs = 0.3f, kShine = 12;
  const Rgb color(1, 0.5f, 0.25f), background(0.1f, 0.2f, 0.3f), intensity(0.9f, 0.8f, 0.7f);
  const Vec3f from(1, -3, 3), light(0.5f, 2, 2.5f);
  Scene scene = plane_seen_from(from, {color, kKd, kKs, kShine, 0, 1});
  scene.background = background;
  scene.lights = {{.position = light, .color = intensity}};
  const Vec3d n(0, 0, 1), v = normalize(Vec3d(from)), l = normalize(Vec3d(light));
  const Vec3d r = n * (2 * dot(n, l)) - l, h = normalize(l + v);
  for (const auto& [model, cosine] :
       {std::pair(ShadingModel::phong, dot(r, v)), std::pair(ShadingModel::blinn_phong, dot(n, h))})
    for (const bool colored : {true, false}) {
      if (!colored) scene.lights[0].color.reset();  // then it is white, and NFF has ambient light
      const Rgb found = pixel(scene, with_models(model, Fresnel::none));
      const double highlight = kKs * std::pow(cosine, double(kShine));
      for (int c = 0; c < 3; ++c) {
        const double one = colored ? intensity[c] : 1;
        EXPECT_NEAR(found[c], one * (kKd * color[c] * dot(n, l) + highlight) + kKs * background[c],
                    2e-5)
            << int(model) << " " << c;
      }
      scene.lights[0].color = intensity;
    }
}

// Without ambient light in NFF either, Phong's model is NFF's to the last bit.
TEST(ShadingModels, PhongIsNffWithColoredLights) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    Scene scene = random_scene(80, seed);
    for (Light& light : scene.lights) light.color = Rgb(0.5f, 0.6f, 0.7f);
    ASSERT_FALSE(scene.lights.empty());
    RenderOptions options;
    options.width = 60, options.height = 50, options.aa = 2, options.soft_shadows = true;
    const Image nff = picture_of(scene, options);
    options.shading = ShadingModel::phong;
    EXPECT_TRUE(same_bytes(nff, picture_of(scene, options)));
    options.shading = ShadingModel::blinn_phong;
    EXPECT_FALSE(same_bytes(nff, picture_of(scene, options)));
  }
}

// Fresnel's equations, for the angle of incidence and the relative index n1 / n2.
double fresnel(double angle, double eta) {
  const double ci = std::cos(angle), st = eta * std::sin(angle);
  if (st > 1) return 1;
  const double ct = std::sqrt(1 - st * st);
  const double s = (eta * ci - ct) / (eta * ci + ct), p = (eta * ct - ci) / (eta * ct + ci);
  return (s * s + p * p) / 2;
}

double schlick(double angle, double eta) {
  const double least = (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1)), st = eta * std::sin(angle);
  if (st > 1) return 1;
  const double cosine = eta > 1 ? std::sqrt(1 - st * st) : std::cos(angle);
  return least + (1 - least) * std::pow(1 - cosine, 5);
}

TEST(ShadingModels, FresnelDividesTheLight) {
  EXPECT_NEAR(fresnel(0, 1 / 1.5), 0.04, 1e-12);
  EXPECT_NEAR(schlick(0, 1 / 1.5), 0.04, 1e-12);
  constexpr double kDegree = std::numbers::pi / 180;
  // At Brewster's angle, parallel polarised light is not reflected.
  EXPECT_NEAR(fresnel(std::atan(1.5), 1 / 1.5), std::pow((2.25 - 1) / (2.25 + 1), 2) / 2, 1e-12);
  for (const float ior : {1.5f, 1.0f, 2.4f})
    for (const bool inside : {false, true})
      for (const double degrees : {0.0, 10.0, 30.0, 41.0, 42.5, 60.0, 80.0, 89.0}) {
        const double a = degrees * kDegree, eta = inside ? ior : 1 / double(ior);
        const Vec3f from(float(std::sin(a)), 0, float(inside ? -std::cos(a) : std::cos(a)));
        // Ks and T have no part in it.
        Scene scene = plane_seen_from(from, {{0, 0, 0}, 0, 0.7f, 10, 0.2f, ior});
        scene.background = Rgb(1, 0.5f, 2);
        for (const Fresnel model : {Fresnel::exact, Fresnel::schlick}) {
          const double part = model == Fresnel::exact ? fresnel(a, eta) : schlick(a, eta);
          SCOPED_TRACE(testing::Message() << ior << " " << inside << " " << degrees << " degrees");
          RenderOptions options = with_models(ShadingModel::nff, model);
          const Rgb both = pixel(scene, options);
          options.no_refraction = true;
          const Rgb mirrored = pixel(scene, options);
          options.no_refraction = false, options.no_reflection = true;
          const Rgb refracted = pixel(scene, options);
          for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(mirrored[c], part * scene.background[c], 1e-4);
            EXPECT_NEAR(refracted[c], (1 - part) * scene.background[c], 1e-4);
            EXPECT_NEAR(both[c], scene.background[c], 1e-6);
          }
        }
      }
}

// An opaque mirror uses Ks, whatever `fresnel` says.
TEST(ShadingModels, FresnelLeavesOpaqueMirrors) {
  Scene scene = plane_seen_from({0.3f, 0, 1}, {{1, 1, 1}, 0, 0.7f, 10, 0, 0});
  scene.background = Rgb(1, 0.5f, 2);
  for (const Fresnel model : {Fresnel::exact, Fresnel::schlick})
    EXPECT_EQ(pixel(scene, with_models(ShadingModel::nff, model)), pixel(scene, {}));
}

// Highlight and mirror of the models use the specular colour; refraction does not.
TEST(ShadingModels, SpecularColourTintsHighlightsAndMirrors) {
  constexpr float kKd = 0.6f, kKs = 0.3f, kShine = 12, kT = 0.2f;
  const Rgb color(1, 0.5f, 0.25f), background(0.1f, 0.2f, 0.3f), tint(0.9f, 0.5f, 0);
  const Vec3f from(1, -3, 3), light(0.5f, 2, 2.5f);
  const Vec3d n(0, 0, 1), v = normalize(Vec3d(from)), l = normalize(Vec3d(light));
  const Vec3d r = n * (2 * dot(n, l)) - l, h = normalize(l + v);
  for (const ShadingModel model : {ShadingModel::nff, ShadingModel::blinn_phong})
    for (const float t : {0.0f, kT}) {
      Scene scene = plane_seen_from(from, {color, kKd, kKs, kShine, t, 1});
      scene.material_specular = {tint};
      scene.background = background;
      scene.lights = {{.position = light, .color = Rgb(0.9f)}};
      const double cosine = model == ShadingModel::nff ? dot(r, v) : dot(n, h);
      const Rgb found = pixel(scene, with_models(model, Fresnel::none));
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(
            found[c],
            0.9 * (kKd * color[c] * dot(n, l) + kKs * tint[c] * std::pow(cosine, double(kShine))) +
                (kKs * tint[c] + t) * background[c],
            2e-5);
      // With Fresnel's equations, glass reflects without a colour, since it splits the light.
      if (t == 0) continue;
      scene.lights.clear();
      const Rgb whole = pixel(scene, with_models(ShadingModel::blinn_phong, Fresnel::schlick));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(whole[c], background[c], 1e-6);
    }
}

// Colours multiply from mirror to mirror, and the light stays within the film's bound, even for
// colours far above white.
TEST(ShadingModels, ColoursMultiplyFromMirrorToMirror) {
  for (const float most : {0.75f, 50.0f}) {
    Scene scene;
    scene.camera.from = {0, 0, 1}, scene.camera.at = {0.5f, 0, 0}, scene.camera.fov_deg = 1;
    scene.materials = {{{0, 0, 0}, 0, 0.5f, 1, 0, 0}};
    scene.material_specular = {{most, 0.5f, 0.25f}};
    scene.planes = {{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 2}, {0, 0, -1}}};
    scene.plane_materials = {0, 0};
    scene.background = Rgb(1, 2, 3);
    RenderOptions options;
    options.depth = 4;  // mirrored four times, then the background
    const Rgb found = pixel(scene, options);
    for (int c = 0; c < 3; ++c) {
      const double part = 0.5 * double(scene.material_specular[0][c]);
      const double expected = double(scene.background[c]) * std::pow(part, 4);
      EXPECT_NEAR(found[c], expected, 1e-6 * (1 + expected));
    }
  }
}

// White is no colour: the same bytes as without the column.
TEST(ShadingModels, WhiteSpecularIsTheDefault) {
  Scene scene = random_scene(80, 3);
  RenderOptions options;
  options.width = 60, options.height = 50, options.aa = 2, options.soft_shadows = true;
  const Image without = picture_of(scene, options);
  scene.material_specular.assign(scene.materials.size(), Rgb(1));
  EXPECT_TRUE(same_bytes(without, picture_of(scene, options)));
  scene.material_specular.back() = Rgb(1, 0, 0);
  expect_one_picture(scene, options);
}

TEST(ShadingModels, EveryStructureGivesThePicture) {
  for (const ShadingModel shading : {ShadingModel::phong, ShadingModel::blinn_phong})
    for (const Fresnel fresnel : {Fresnel::none, Fresnel::exact, Fresnel::schlick}) {
      RenderOptions options = with_models(shading, fresnel);
      options.width = 40, options.height = 30, options.aa = 2, options.depth = 4;
      options.soft_shadows = true;
      expect_one_picture(random_scene(120, 5), options);
    }
}

TEST(ShadingModels, OptionsComeBackFromTheSettings) {
  const Scene scene = random_scene(5, 1);
  const RenderOptions given = with_models(ShadingModel::blinn_phong, Fresnel::schlick);
  const RenderOptions again = options_of(resolve_options(given, scene), scene);
  EXPECT_EQ(again.shading, given.shading);
  EXPECT_EQ(again.fresnel, given.fresnel);
  EXPECT_NE(option_arguments(again).find("--shading blinn-phong --fresnel schlick"),
            std::string::npos);
  EXPECT_FALSE(options_of(resolve_options({}, scene), scene).shading);
}

}  // namespace
}  // namespace raio::core
