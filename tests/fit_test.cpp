// Cameras that options fit to a scene: where they look from, and that nothing else of them changes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/warnings.h"
#include "render/options.h"

namespace raio {
namespace {

using testing::HasSubstr;

Scene corners() {
  Scene s;
  s.camera.from = {9, -5, 3}, s.camera.at = {}, s.camera.up = {0.1f, 0.2f, 0.9f};
  s.camera.fov_deg = 30, s.camera.width = 160, s.camera.height = 120;
  s.materials.resize(1);
  for (const Vec3f center : {Vec3f(-4, -3, -2), Vec3f(4, 3, 2), Vec3f(-4, 3, 1)})
    s.spheres.push_back({center, 0.5f});
  s.sphere_materials.assign(s.spheres.size(), 0);
  return s;
}

Camera camera_with(const Scene& scene, std::initializer_list<std::array<const char*, 2>> options) {
  RenderOptions o;
  for (const auto& [name, value] : options)
    for (const OptionSpec& spec : render_option_table())
      if (spec.name == name) {
        const auto set = set_option(o, spec, value);
        EXPECT_TRUE(set) << name;
      }
  EXPECT_EQ(option_conflict(o, &scene), std::nullopt);
  return camera_of(scene, o);
}

void expect_axis(Vec3f got, Vec3f wanted) {
  EXPECT_LT(length(normalize(got) - wanted), 1e-6f) << got.x << " " << got.y << " " << got.z;
}

TEST(Fit, SidesFaceTheirAxes) {
  const Scene scene = corners();
  struct Case {
    const char *side, *up;
    Vec3f view, picture_up;
  };
  for (const auto& [side, up, view, picture_up] :
       {Case{"front", "z", {0, 1, 0}, {0, 0, 1}}, Case{"back", "z", {0, -1, 0}, {0, 0, 1}},
        Case{"left", "z", {1, 0, 0}, {0, 0, 1}}, Case{"right", "z", {-1, 0, 0}, {0, 0, 1}},
        Case{"top", "z", {0, 0, -1}, {0, 1, 0}}, Case{"bottom", "z", {0, 0, 1}, {0, -1, 0}},
        Case{"front", "y", {0, 0, -1}, {0, 1, 0}}, Case{"top", "y", {0, -1, 0}, {0, 0, -1}},
        Case{"right", "+y", {-1, 0, 0}, {0, 1, 0}}, Case{"front", "-z", {0, -1, 0}, {0, 0, -1}},
        Case{"front", "x", {0, 0, 1}, {1, 0, 0}}}) {
    SCOPED_TRACE(std::string(side) + " " + up);
    const Camera camera = camera_with(scene, {{"from", side}, {"up", up}});
    expect_axis(camera.at - camera.from, view);
    expect_axis(camera.up, picture_up);
  }
  expect_axis(camera_with(scene, {{"from", "front"}}).up, {0, 0, 1});  // nearest to its own
}

TEST(Fit, PicturesHoldAllAsLargeAsItFits) {
  const Scene scene = corners();
  for (const char* projection : {"perspective", "orthographic"})
    for (const char* side : {"front", "right", "top", "iso"}) {
      SCOPED_TRACE(std::string(projection) + " " + side);
      const Camera c = camera_with(scene, {{"from", side}, {"projection", projection}});
      const Vec3d view = Vec3d(c.at) - Vec3d(c.from), forward = normalize(view),
                  right = normalize(cross(forward, Vec3d(c.up))), up = cross(right, forward);
      double largest = 0;
      for (const Sphere& sphere : scene.spheres) {
        const Vec3d p = Vec3d(sphere.center) - Vec3d(c.from);
        const double depth = c.is_parallel() ? length(view) : dot(p, forward);
        const auto part = [&](double along, float degrees) {
          const double tangent = std::tan(double(degrees) * std::numbers::pi / 360);
          return (std::abs(along) + double(sphere.radius)) / (depth * tangent);
        };
        largest =
            std::max({largest, part(dot(p, right), c.across_deg), part(dot(p, up), c.fov_deg)});
      }
      EXPECT_LT(largest, 1);
      EXPECT_GT(largest, 0.9);
    }
}

TEST(Fit, UpTurnsFittedCamerasAlone) {
  Scene scene = corners();
  EXPECT_EQ(camera_with(scene, {{"up", "y"}}).from, scene.camera.from);
  fit_camera(scene, FitView::three_quarter);
  const Camera turned = camera_with(scene, {{"up", "y"}});
  EXPECT_NE(turned.from, scene.camera.from);
  EXPECT_GT(turned.up.y, 0.7f);
  EXPECT_EQ(camera_with(scene, {{"up", "y"}, {"at", "0,0,1"}}).from, scene.camera.from);
}

TEST(Fit, CamerasStayWhatTheyAreAsOptions) {
  Scene scene = corners();
  fit_camera(scene, FitView::three_quarter);
  Camera rolled = scene.camera;
  rolled.up = {1, 0, 0};
  for (const Camera& camera :
       {rolled, camera_with(scene, {{"from", "top"}}), camera_with(scene, {{"up", "-x"}})}) {
    RenderOptions o;
    o.side = Side::left;
    set_camera(o, camera, scene);
    const Camera again = camera_of(scene, o);
    EXPECT_EQ(again.from, camera.from);
    EXPECT_EQ(again.at, camera.at);
    EXPECT_EQ(again.up, camera.up);
  }
}

// The longer side across, the third upright; what is flat is seen from there.
TEST(Fit, CellsStandUpright) {
  Scene scene = corners();
  const std::array<Vec3d, 3> sides = {Vec3d(2, 0, 0), Vec3d(0, 9, 0), Vec3d(0, 1, 5)};
  fit_camera_to_cell(scene, sides, false);
  const Vec3d up = normalize(sides[2]), view = Vec3d(scene.camera.at - scene.camera.from);
  EXPECT_NEAR(dot(Vec3d(scene.camera.up), cross(up, view)), 0, 1e-5);
  EXPECT_GT(dot(Vec3d(scene.camera.up), up), 0.9);
  EXPECT_GT(cross(view, Vec3d(scene.camera.up)).y, 0.8 * length(view));
  EXPECT_LT(view.z, 0);  // from above
  fit_camera_to_cell(scene, sides, true);
  EXPECT_NEAR(dot(normalize(Vec3d(scene.camera.at - scene.camera.from)), up), -1, 1e-6);
}

TEST(Fit, TellsWhichUpIsGuessed) {
  Scene scene = corners();
  RenderOptions o;
  EXPECT_EQ(app::up_warning(o, scene), std::nullopt);
  o.side = Side::front;
  EXPECT_THAT(app::up_warning(o, scene).value_or(""), HasSubstr("guessed as z,"));
  o.up = Vec3d(0, 0, 1);
  EXPECT_EQ(app::up_warning(o, scene), std::nullopt);
  o.up.reset();
  fit_camera(scene, FitView::three_quarter, {0, -1, 0});
  EXPECT_EQ(app::up_warning(o, scene), std::nullopt);  // it is upright
}

TEST(Fit, WhatASideCannotBe) {
  Scene scene = corners();
  RenderOptions o;
  o.side = Side::front, o.at = Vec3d(1, 2, 3);
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("cannot be combined with a side"));
  o.at.reset(), o.up = Vec3d();
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("must not be 0"));
  o.up.reset();
  scene.spheres = {}, scene.sphere_materials = {};
  EXPECT_THAT(option_conflict(o, &scene)->message, HasSubstr("infinite planes"));
}

}  // namespace
}  // namespace raio
