#include "render/warnings.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/nff/nff.h"
#include "render/options.h"
#include "render/render.h"
#include "scenes.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

std::vector<SceneWarning> warnings(const Scene& scene, const RenderOptions& options) {
  const RenderSettings resolved = resolve_options(options, scene);
  const auto accel = build_accel(scene, resolved.accel);
  EXPECT_TRUE(accel);
  return scene_warnings(scene, resolved, accel->get());
}

// A wall across the view at this depth, and nothing else.
Scene wall(float depth) {
  Scene scene;
  scene.camera.fov_deg = 40;
  scene.camera.width = scene.camera.height = 200;
  scene.lights = {{{0, 0, 0}, std::nullopt}};
  scene.materials = {{}};
  scene.planes = {{{0, 0, -depth}, {0, 0, 1}}};
  scene.plane_materials = {0};
  return scene;
}

RenderOptions lens(float aperture, float focus) {
  RenderOptions options;
  options.dof = true;
  options.aperture = aperture, options.focus = focus;
  return options;
}

TEST(SceneWarnings, ReportMissingLights) {
  Scene scene = wall(4);
  EXPECT_TRUE(warnings(scene, {}).empty());
  scene.lights.clear();
  const auto found = warnings(scene, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, SceneWarning::no_light);
  EXPECT_THAT(found[0].sentence, HasSubstr("no light"));
  EXPECT_EQ(scene_warnings(scene, resolve_options({}, scene), nullptr).size(), 1u);
  for (const IntegratorKind other : {IntegratorKind::ambient, IntegratorKind::views}) {
    RenderOptions options;
    options.integrator = other;
    EXPECT_TRUE(warnings(scene, options).empty());
  }
  RenderOptions paths;
  paths.integrator = IntegratorKind::path;
  scene.background = Rgb();
  ASSERT_EQ(warnings(scene, paths).size(), 1u);
  EXPECT_THAT(warnings(scene, paths)[0].sentence, HasSubstr("no light"));
  scene.background = Rgb(0.5f);
  EXPECT_TRUE(warnings(scene, paths).empty());
}

TEST(SceneWarnings, NameParametersThatAreNotShown) {
  Scene scene = tests::random_scene(3, 1);
  scene.standard_surfaces.assign(scene.materials.size(), {.is_standard = 0});
  scene.standard_surfaces[0] = {
      .transmission = 0.5f, .emission = Rgb(1), .coat = 1, .sheen_color = Rgb(0.5f)};
  const auto sentence = [&](IntegratorKind integrator) {
    RenderOptions options;
    options.integrator = integrator;
    for (const SceneWarning& warning : warnings(scene, options))
      if (warning.kind == SceneWarning::unseen) return warning.sentence;
    return std::string();
  };
  EXPECT_EQ(sentence(IntegratorKind::ambient),
            "ambient does not show emission (1 material), transmission (1 material), clearcoat (1 "
            "material), sheen (1 material); path does");
  EXPECT_EQ(sentence(IntegratorKind::path), "");
  EXPECT_EQ(sentence(IntegratorKind::views), "");
  scene.textures = {{0, 1, 1}}, scene.texels = {0xff8080};
  scene.standard_surfaces[0] = {.normal_texture = 0};
  EXPECT_EQ(sentence(IntegratorKind::path), "");
  EXPECT_EQ(sentence(IntegratorKind::ambient),
            "ambient does not show normal maps (1 material); path does");
}

TEST(SceneWarnings, MeasureTheBlurOfALens) {
  const Scene scene = wall(4);
  const auto found = warnings(scene, lens(0.2f, 1));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].kind, SceneWarning::blurred);
  // Through both edges of the lens to the focus and on to the wall: the diameter is 2 R three times
  // as far behind the focus as the lens is in front of it.
  const double height = 2 * 4 * std::tan(20 * std::numbers::pi / 180);
  EXPECT_THAT(found[0].sentence,
              HasSubstr(fmt::format(" {:.0f} pixels", 200 * 2 * 0.2 * 3 / height)));
  EXPECT_NEAR(found[0].focus, 4, 0.1);
  EXPECT_TRUE(scene_warnings(scene, resolve_options(lens(0.2f, 1), scene), nullptr).empty());
}

TEST(SceneWarnings, ProposeARemedy) {
  const Scene scene = wall(4);
  const auto found = warnings(scene, lens(0.2f, 1));
  ASSERT_EQ(found.size(), 1u);
  ASSERT_GT(found[0].aperture, 0);
  EXPECT_LT(found[0].aperture, 0.2f);
  EXPECT_TRUE(warnings(scene, lens(found[0].aperture, 1)).empty());
  EXPECT_TRUE(warnings(scene, lens(0.2f, found[0].focus)).empty());
}

TEST(SceneWarnings, AcceptPicturesWithSharpParts) {
  Scene scene = wall(40);
  scene.spheres = {{{0, 0, -4}, 0.5f}};
  scene.sphere_materials = {0};
  EXPECT_TRUE(warnings(scene, lens(0.2f, 3.6f)).empty());
  EXPECT_EQ(warnings(scene, lens(0.2f, 0.5f)).size(), 1u);
  RenderOptions pinhole;
  pinhole.dof = false;
  EXPECT_TRUE(warnings(scene, pinhole).empty());
  scene.planes.clear(), scene.plane_materials.clear(), scene.spheres[0].center.z = 4;
  EXPECT_TRUE(warnings(scene, lens(0.2f, 0.5f)).empty()) << "nothing is in sight";
}

// The default lens: it blurs the two scenes here with the camera among the objects, or looking at a
// point right in front of it.
TEST(SceneWarnings, JudgeTheScenesOfTheTree) {
  for (const char* name :
       {"gears", "lattice", "mount", "rings", "shapes", "sphereflake", "teapot", "tetra", "tree"}) {
    const auto read = read_nff(fmt::format("{}/scenes/{}.nff", RAIO_SOURCE_DIR, name));
    ASSERT_TRUE(read) << name;
    RenderOptions options;
    options.dof = true;
    const bool among = std::string_view(name) == "lattice" || std::string_view(name) == "rings";
    EXPECT_EQ(warnings(read->scene, options).size(), among ? 1u : 0u) << name;
  }
}

// With and without alpha; with it, colours have no background.
TEST(SceneWarnings, ReportBlankPictures) {
  Scene scene = wall(4);
  const auto blank = [&](const char* background, bool alpha) {
    RenderOptions options;
    for (const OptionSpec& spec : render_option_table())
      if (spec.name == "background") {
        EXPECT_TRUE(set_option(options, spec, background));
      }
    if (alpha) options.channels.add(Channel::alpha);
    const RenderSettings settings = resolve_options(options, scene);
    const auto accel = build_accel(scene, settings.accel);
    auto film = make_film(scene, settings);
    WorkControl control;
    render(scene, **accel, settings, **film, control);
    return blank_warning(**film, settings, **accel);
  };
  for (const bool is_ahead : {true, false}) {
    if (!is_ahead) scene.planes[0].point = {0, 0, 4}, scene.camera.at = {0, 0, -1};
    for (const char* background : {"transparent", "0.2,0.3,0.4"})
      for (const bool alpha : {true, false})
        EXPECT_EQ(blank(background, alpha).has_value(), !is_ahead) << background << alpha;
  }
  scene = wall(4);
  scene.materials.front().color = {};  // black on black
  EXPECT_EQ(blank("transparent", true), std::nullopt);
  EXPECT_THAT(blank("black", false).value_or(""), HasSubstr("background's colour"));
}

}  // namespace
}  // namespace raio::core