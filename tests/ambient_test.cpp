// The integrator for figures: occlusion against closed forms, and what its options do.
#include "integrate/ambient.h"

#include <gtest/gtest.h>

#include <cmath>

#include "one_picture.h"
#include "scenes.h"

namespace raio {
namespace {

using testing::expect_one_picture;
using testing::picture_of;
using testing::random_scene;

// A white floor, seen at a point under the sky alone.
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

// The share of the sky that the point sees.
double sky_at(const Scene& scene, float distance = 0) {
  RenderOptions options;
  options.width = options.height = 2;
  options.samples = 1024, options.occlusion_rays = 16;
  options.occlusion_distance = distance;
  options.key_light = false;
  const Image image = picture_of(scene, options);
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += double(pixel.x) / 4;
  return sum / double(numbers_of(Look::paper).sky);
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
    // Half of the light that the sphere hides comes through where it is clear by half.
    scene.sphere_opacity = std::vector<float>{0.5f};
    EXPECT_NEAR(sky_at(scene), 1 - hidden / 2, 1e-3) << radius << ' ' << height;
  }
}

// An endless wall hides half of the sky of a point however far away it is, a corner three quarters.
TEST(Ambient, WallsAndCorners) {
  for (const float away : {0.01f, 1.0f, 100.0f}) {
    Scene scene = floor_seen_at({away, away, 0});
    scene.planes.push_back({{0, 0, 0}, {1, 0, 0}}), scene.plane_materials.push_back(0);
    EXPECT_NEAR(sky_at(scene), 0.5, 1e-3) << away;
    // What is farther away than the limit hides nothing: at a tenth of it all is free.
    EXPECT_NEAR(sky_at(scene, away * 0.1f), 1, 1e-3);
    scene.planes.push_back({{0, 0, 0}, {0, 1, 0}}), scene.plane_materials.push_back(0);
    EXPECT_NEAR(sky_at(scene), 0.25, 1e-3) << away;
  }
}

// A sphere in the corner of three walls that touches all of them, seen from a wall's point below.
TEST(Ambient, ASphereInACorner) {
  Scene scene = floor_seen_at({1, 1, 0});
  scene.camera.from = {4, 4, 0.01f};
  scene.planes.push_back({{0, 0, 0}, {1, 0, 0}}), scene.plane_materials.push_back(0);
  scene.planes.push_back({{0, 0, 0}, {0, 1, 0}}), scene.plane_materials.push_back(0);
  // A sphere right above, of radius 0.5 at 2, hides a quarter of a quarter... of the whole sky
  // r^2 / h^2 = 1/16, of which the part before the free quarter of directions is a quarter.
  scene.spheres = {{{1, 1, 2}, 0.5f}};
  scene.sphere_materials = {0};
  EXPECT_NEAR(sky_at(scene), 0.25 - 1.0 / 64, 1e-3);
}

TEST(Ambient, AllStructuresGiveOnePicture) {
  RenderOptions options;
  options.width = 40, options.height = 30, options.samples = 3;
  options.integrator = IntegratorKind::ambient;
  for (const Look look : {Look::paper, Look::dark, Look::flat, Look::matte}) {
    options.look = look;
    (void)expect_one_picture(random_scene(200, 4), options);
  }
}

TEST(Ambient, IsWhatDataIsRenderedWith) {
  Scene scene = floor_seen_at({0, 0, 0});
  const RenderSettings s = resolve_options({}, scene);
  EXPECT_EQ(s.integrator, IntegratorKind::ambient);
  EXPECT_EQ(s.tone, Tone::srgb);
  EXPECT_EQ(s.background, Rgb(1));
  EXPECT_EQ(s.samples, 64);
  EXPECT_EQ(options_of(s, scene).tone, Tone::srgb);  // without the scene
  // And says so again.
  const RenderSettings again = resolve_options(options_of(s, scene), scene);
  EXPECT_EQ(again, s);
  RenderOptions options;
  options.soft_shadows = true;
  ASSERT_TRUE(option_conflict(options, &scene));
  EXPECT_EQ(option_conflict(options, &scene)->subject, "soft-shadows");
  scene.dialect = Dialect::nff;
  options = {};
  options.look = Look::dark;
  ASSERT_TRUE(option_conflict(options, &scene));
  EXPECT_EQ(option_conflict(options, &scene)->subject, "look");
}

// No sample brings more than the bound.
TEST(Ambient, TheBoundHolds) {
  const Scene scene = random_scene(300, 9);
  RenderOptions options;
  options.integrator = IntegratorKind::ambient;
  options.width = options.height = 24, options.samples = 1;
  for (const Look look : {Look::paper, Look::dark}) {
    options.look = look;
    const double bound = ambient_bound(scene, resolve_options(options, scene));
    for (const Rgb& pixel : picture_of(scene, options).pixels)
      EXPECT_LE(double(max_component(pixel)), bound);
  }
}

}  // namespace
}  // namespace raio
