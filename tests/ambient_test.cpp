// The integrator for figures: occlusion against closed forms, and its options.
#include "integrate/ambient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "one_picture.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::expect_one_picture;
using tests::if_sanitized;
using tests::picture_of;
using tests::random_scene;

// A white floor, seen at a point lit only by the sky.
Scene floor_seen_at(Vec3f point) {
  Scene scene;
  scene.dialect = Dialect::data;
  scene.camera.from = point + Vec3f(0.3f, 0.2f, 0.5f), scene.camera.at = point;
  scene.camera.up = {0, 0, 1}, scene.camera.fov_deg = 0.001f;
  scene.materials = {{.color = Rgb(1), .kd = 1}};
  scene.planes = {{{0, 0, 0}, {0, 0, 1}}};
  scene.plane_materials = {0};
  return scene;
}

// The visible fraction of the sky at the point.
double sky_at(const Scene& scene, float distance = 0) {
  RenderOptions options;
  options.width = options.height = 2;
  options.samples = 1024, options.occlusion_rays = 16;
  options.occlusion_distance = distance;
  options.key_light = KeyLight::off;
  options.look = FigureStyle::paper_1;
  const Image image = picture_of(scene, options);
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += double(pixel.x) / 4;
  return sum / double(params_of(FigureStyle::paper_1).sky);
}

TEST(Ambient, AnEmptyFloorSeesAllOfTheSky) {
  EXPECT_NEAR(sky_at(floor_seen_at({0, 0, 0})), 1, 1e-6);
}

// A sphere of radius r at height h above the point hides r^2 / h^2, weighed by the cosine.
TEST(Ambient, ASphereAboveAFloor) {
  for (const auto& [radius, height] : {std::pair(1.0f, 2.0f), {0.5f, 3.0f}, {2.0f, 2.1f}}) {
    Scene scene = floor_seen_at({0, 0, 0});
    scene.camera.from = {3, 2, 0.02f};  // below the sphere
    scene.spheres = {{{0, 0, height}, radius}};
    scene.sphere_materials = {0};
    const double hidden = std::pow(double(radius) / double(height), 2);
    EXPECT_NEAR(sky_at(scene), 1 - hidden, 1e-3) << radius << ' ' << height;
    // If the sphere is half transparent, half of the hidden light comes through.
    scene.sphere_opacity = std::vector<float>{0.5f};
    EXPECT_NEAR(sky_at(scene), 1 - hidden / 2, 1e-3) << radius << ' ' << height;
  }
}

// An infinite wall hides half of a point's sky at any distance, a corner three quarters.
TEST(Ambient, WallsAndCorners) {
  for (const float away : {0.01f, 1.0f, 100.0f}) {
    Scene scene = floor_seen_at({away, away, 0});
    scene.planes.push_back({{0, 0, 0}, {1, 0, 0}}), scene.plane_materials.push_back(0);
    EXPECT_NEAR(sky_at(scene), 0.5, 1e-3) << away;
    // Occluders beyond the distance limit do not count: at a tenth of it the sky is unobstructed.
    EXPECT_NEAR(sky_at(scene, away * 0.1f), 1, 1e-3);
    scene.planes.push_back({{0, 0, 0}, {0, 1, 0}}), scene.plane_materials.push_back(0);
    EXPECT_NEAR(sky_at(scene), 0.25, 1e-3) << away;
  }
}

// A sphere in the corner of three walls, touching all of them, seen from a wall's point below.
TEST(Ambient, ASphereInACorner) {
  Scene scene = floor_seen_at({1, 1, 0});
  scene.camera.from = {4, 4, 0.01f};
  scene.planes.push_back({{0, 0, 0}, {1, 0, 0}}), scene.plane_materials.push_back(0);
  scene.planes.push_back({{0, 0, 0}, {0, 1, 0}}), scene.plane_materials.push_back(0);
  // A sphere of radius 0.5 at distance 2 right above hides r^2 / h^2 = 1/16 of the whole sky; a
  // quarter of that is in front of the free quarter of directions.
  scene.spheres = {{{1, 1, 2}, 0.5f}};
  scene.sphere_materials = {0};
  EXPECT_NEAR(sky_at(scene), 0.25 - 1.0 / 64, 1e-3);
}

TEST(Ambient, AllStructuresGiveOnePicture) {
  RenderOptions options;
  options.width = if_sanitized(24, 40), options.height = if_sanitized(18, 30);
  options.samples = 3;
  options.integrator = IntegratorKind::ambient;
  for (const FigureStyle look : {FigureStyle::paper_1, FigureStyle::flat_1, FigureStyle::paper_2,
                                 FigureStyle::dark_2, FigureStyle::matte_2}) {
    options.look = look;
    (void)expect_one_picture(random_scene(200, 4), options);
  }
}

TEST(Ambient, IsTheDefaultForData) {
  Scene scene = floor_seen_at({0, 0, 0});
  const RenderSettings s = resolve_options({}, scene);
  EXPECT_EQ(s.integrator, IntegratorKind::ambient);
  EXPECT_EQ(s.tone, Tone::srgb);
  EXPECT_EQ(s.background, Rgb(1));
  EXPECT_EQ(s.samples, 64);
  EXPECT_EQ(options_of(s, scene).tone, Tone::srgb);  // without the scene
  // Resolving resolved options changes nothing.
  const RenderSettings again = resolve_options(options_of(s, scene), scene);
  EXPECT_EQ(again, s);
  RenderOptions options;
  options.soft_shadows = true;
  ASSERT_TRUE(option_conflict(options, &scene));
  EXPECT_EQ(option_conflict(options, &scene)->subject, "soft-shadows");
  options = {};
  options.depth = 4;
  ASSERT_TRUE(option_conflict(options, &scene));
  EXPECT_EQ(option_conflict(options, &scene)->subject, "depth");
  scene.dialect = Dialect::nff;
  options = {};
  options.look = FigureStyle::dark_1;
  ASSERT_TRUE(option_conflict(options, &scene));
  EXPECT_EQ(option_conflict(options, &scene)->subject, "look");
  options.view = View::normals;
  ASSERT_TRUE(option_conflict(options, &scene));
  EXPECT_EQ(option_conflict(options, &scene)->message,
            "has no effect with `view` normals; leave one of them out");
  options = {};
  options.shadow_catcher = true;
  EXPECT_EQ(option_conflict(options, &scene)->subject, "shadow-catcher");
}

// A sphere of radius 1 two above the floor, which a small one far away stands on.
Scene sphere_above_nothing(Vec3f seen) {
  Scene scene = floor_seen_at(seen);
  scene.planes = {}, scene.plane_materials = {};
  scene.spheres = {{{0, 0, 2}, 1}, {{90, 0, 0.5f}, 0.5f}};
  scene.sphere_materials = {0, 0};
  return scene;
}

RenderOptions on_catcher() {
  RenderOptions options;
  options.width = options.height = 2;
  options.samples = 1024, options.occlusion_rays = 16;
  options.shadow_catcher = true, options.key_light = KeyLight::off;
  return options;
}

// The invisible floor is darker by the part of the sky that the sphere hides.
TEST(ShadowCatcher, IsAsDarkAsAFloor) {
  for (const Rgb& pixel : picture_of(sphere_above_nothing({0, 0, 0}), on_catcher()).pixels)
    EXPECT_NEAR(double(pixel.x), 0.75, 1e-3);
  // Relative to any background.
  RenderOptions options = on_catcher();
  options.background = WrittenColor{.color = Rgb(0.5f, 0.2f, 1)};
  for (const Rgb& pixel : picture_of(sphere_above_nothing({0, 0, 0}), options).pixels) {
    EXPECT_NEAR(double(pixel.x), 0.375, 1e-3);
    EXPECT_NEAR(double(pixel.y), 0.15, 1e-3);
  }
  // Also by the key light, in the sphere's shadow: only the sky remains.
  options = on_catcher();
  options.key_light.reset();
  const Image lit = picture_of(sphere_above_nothing({0, 0, 0}), options);
  EXPECT_LT(lit.pixels[0].x, 0.9f);
}

// Outside shadows the background equals that of a picture without the floor, exactly.
TEST(ShadowCatcher, LeavesTheRestUnchanged) {
  Scene scene = random_scene(40, 3);
  scene.planes = {}, scene.plane_materials = {};
  scene.polygons = {}, scene.polygon_materials = {};
  scene.camera.from = scene.camera.at + (scene.camera.from - scene.camera.at) * 2;
  RenderOptions options;
  options.integrator = IntegratorKind::ambient;
  options.width = 64, options.height = 48, options.samples = 2;
  options.occlusion_distance = 0.5f;
  const Image without = picture_of(scene, options);
  options.shadow_catcher = true;
  const Image with = expect_one_picture(scene, options);
  EXPECT_EQ(with.pixels.front(), without.pixels.front());
  size_t darker = 0, same = 0;
  for (size_t i = 0; i < with.pixels.size(); ++i) {
    EXPECT_LE(with.pixels[i].x, without.pixels[i].x * 1.000001f);
    (with.pixels[i] == without.pixels[i] ? same : darker) += 1;
  }
  EXPECT_GT(darker, 20u);
  EXPECT_GT(same, with.pixels.size() / 4);
}

// Alpha includes the shadow, so the picture can be laid over any background.
TEST(ShadowCatcher, IsInAlpha) {
  Scene scene = sphere_above_nothing({0, 0, 0});
  scene.camera.fov_deg = 60;
  RenderOptions options = on_catcher();
  options.width = 32, options.height = 24, options.samples = 4;
  const Image whole = picture_of(scene, options);
  options.channels.add(Channel::alpha);
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  WorkControl control;
  const auto film = make_film(scene, settings);
  ASSERT_TRUE(render(scene, **accel, settings, **film, control).finished);
  const Image colors = (*film)->resolve();
  const auto alpha = std::get<Column<float>>((*film)->resolve(Channel::alpha));
  EXPECT_GT(*std::ranges::max_element(alpha), 0.2f);
  for (size_t i = 0; i < whole.pixels.size(); ++i)
    EXPECT_NEAR(colors.pixels[i].x + (1 - alpha[i]), whole.pixels[i].x, 1e-5);
}

// A surface facing the camera, in a style without shadows: as bright as its sky everywhere.
struct FlatFigure {
  Scene scene;
  RenderOptions options;

  FlatFigure() {
    scene.dialect = Dialect::data;
    scene.camera.from = {0, 0, 10}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 1, 0};
    scene.camera.fov_deg = 40;
    scene.materials = {{.color = Rgb(1), .kd = 1}};
    options.look = FigureStyle::flat_1;
    options.width = options.height = 200, options.samples = 16;
    options.occlusion_distance = 1e-3f;
    options.outline = 0;
  }
  static double sky() { return double(params_of(FigureStyle::flat_1).sky); }
};

// A line along the edge of a disc covers a ring within it of the requested width, however far away
// the disc is. For a straight edge the circle of eight probes finds cos(a) of the width, where a is
// the angle between the edge's normal and the next probe, at most 22.5 degrees: 0.974 on average.
// Four rotating probes on a larger circle find as much.
TEST(Outline, HasTheRequestedWidth) {
  const double least = std::cos(std::numbers::pi / 8);
  const double mean = std::sin(std::numbers::pi / 8) / (std::numbers::pi / 8);
  for (const auto& [look, width, away] : {std::tuple(FigureStyle::flat_1, 1.5f, 0.0f),
                                          {FigureStyle::flat_1, 3.0f, -8.0f},
                                          {FigureStyle::flat_1, 6.0f, 0.0f},
                                          {FigureStyle::flat_2, 1.5f, -8.0f},
                                          {FigureStyle::flat_2, 3.0f, 0.0f},
                                          {FigureStyle::flat_2, 6.0f, -8.0f}}) {
    FlatFigure figure;
    figure.options.look = look;
    figure.scene.discs = {{{0, 0, away}, {0, 0, 1}, 2.5f}};
    figure.scene.disc_materials = {0};
    // The disc is as bright as this background, so only the line is darker.
    figure.options.background = WrittenColor{Rgb(params_of(FigureStyle::flat_1).sky)};
    EXPECT_NEAR(double(picture_of(figure.scene, figure.options).at(100, 100).x), figure.sky(),
                1e-6);
    figure.options.outline = width;
    double dark = 0;  // pixels
    for (const Rgb& pixel : picture_of(figure.scene, figure.options).pixels)
      dark += 1 - double(pixel.x) / figure.sky();
    const double radius = 2.5 / (10 - double(away)) / std::tan(20 * std::numbers::pi / 180) * 100;
    const double inner = std::sqrt(radius * radius - dark / std::numbers::pi);
    EXPECT_NEAR((radius - inner) / (mean * double(width)), 1, 0.02) << width << ' ' << away;
    EXPECT_GE(radius - inner, least * double(width) - 0.02);
    EXPECT_LE(radius - inner, double(width) + 0.02);
  }
}

// A transparent background may become any colour: the style says which is likely.
TEST(Outline, ComesFromTheStyleWithoutABackground) {
  FlatFigure figure;
  figure.scene.discs = {{{0, 0, 0}, {0, 0, 1}, 2.5f}};
  figure.scene.disc_materials = {0};
  figure.options.outline = 3;
  const auto darkest = [&](FigureStyle look) {
    figure.options.look = look;
    figure.options.background = WrittenColor{{}, true, true};
    float least = 1;
    const RenderSettings settings = resolve_options(figure.options, figure.scene);
    const auto accel = build_accel(figure.scene, settings.accel);
    WorkControl control;
    const auto film = make_film(figure.scene, settings);
    (void)render(figure.scene, **accel, settings, **film, control);
    const Image colors = (*film)->resolve();
    const auto alpha = std::get<Column<float>>((*film)->resolve(Channel::alpha));
    for (size_t i = 0; i < colors.pixels.size(); ++i)
      if (alpha[i] == 1) least = std::min(least, colors.pixels[i].x);
    return least;
  };
  EXPECT_EQ(darkest(FigureStyle::flat_1), 0);
  EXPECT_GT(darkest(FigureStyle::dark_1), 0.1f);
}

// The background's fraction grows linearly from the nearest corner of the scene to the farthest.
TEST(DepthCue, GrowsEvenlyWithDepth) {
  FlatFigure figure;
  figure.scene.discs = {{{-2, 0, 0}, {0, 0, 1}, 0.5f},  // 10 from the eye,
                        {{0, 0, 4}, {0, 0, 1}, 0.5f},   // 6
                        {{1, 0, 3}, {0, 0, 1}, 0.3f}};  // and 7
  figure.scene.disc_materials = {0, 0, 0};
  const Rgb background(0.1f, 0.2f, 0.4f);
  figure.options.background = WrittenColor{background};
  for (const float cue : {0.0f, 0.3f, 1.0f}) {
    figure.options.depth_cue = cue;
    const Image picture = picture_of(figure.scene, figure.options);
    for (const auto& [x, depth, part] :
         {std::tuple(-2.0, 10.0, 1.0), {0.0, 6.0, 0.0}, {1.0, 7.0, 0.25}}) {
      const int column = int(100 + 100 * x / depth / std::tan(20 * std::numbers::pi / 180));
      const Rgb seen = picture.at(column, 100);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(
            double(seen[c]),
            figure.sky() * (1 - part * double(cue)) + double(background[c]) * part * double(cue),
            1e-5)
            << cue << ' ' << depth;
    }
  }
}

// Seen from straight above and at an angle: white contrasts with the page, no colour clips, and
// black shows the sky at grazing angles.
TEST(Ambient, TheSecondPaperStyleKeepsForm) {
  const StyleParams look = params_of(FigureStyle::paper_2);
  for (const float color : {1.0f, 0.5f, 0.0f}) {
    Scene scene = floor_seen_at({0, 0, 0});
    scene.materials[0].color = Rgb(color);
    scene.materials[0].kd = 1;
    RenderOptions options;
    options.width = options.height = 1;
    options.samples = 1024, options.occlusion_rays = 4;
    options.key_light = KeyLight::off, options.look = FigureStyle::paper_2;
    const Vec3f view = normalize(scene.camera.at - scene.camera.from);
    const double aside = 1 - std::abs(double(view.z)), black = 1 - double(color);
    const double soft = double(color) * (1 - double(look.soft * color));
    const double expected =
        double(look.sky) * (soft + double(look.rim) * black * black * aside * aside);
    EXPECT_NEAR(double(picture_of(scene, options).pixels[0].x), expected, 1e-3) << color;
  }
  EXPECT_LT((look.sky + look.key) * (1 - look.soft) + look.highlight, 1);
}

// No sample exceeds the bound.
TEST(Ambient, TheBoundHolds) {
  const Scene scene = random_scene(300, 9);
  RenderOptions options;
  options.integrator = IntegratorKind::ambient;
  options.width = options.height = 24, options.samples = 1;
  for (const FigureStyle look :
       {FigureStyle::paper_1, FigureStyle::dark_1, FigureStyle::paper_2, FigureStyle::dark_2}) {
    options.look = look;
    const double bound = ambient_bound(scene, resolve_options(options, scene));
    for (const Rgb& pixel : picture_of(scene, options).pixels)
      EXPECT_LE(double(max_component(pixel)), bound);
  }
}

}  // namespace
}  // namespace raio::core
