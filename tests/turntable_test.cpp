#include "render/turntable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace raio::core {
namespace {

Camera some_camera() {
  Camera camera;
  camera.from = {3, 1, 4};
  camera.at = {1, -5, 0.5f};
  camera.up = {0.2f, 2, -0.3f};
  camera.fov_deg = 30;
  return camera;
}

TEST(Turntable, StartsWithTheCameraItself) {
  const Camera camera = some_camera();
  for (const int index : {0, 7, -7, 14})
    EXPECT_EQ(turntable_camera(camera, index, 7).from, camera.from) << index;
}

TEST(Turntable, RotatesAboutTheAxisAtTheSameDistance) {
  const Camera camera = some_camera();
  const Vec3d axis = normalize(Vec3d(camera.up));
  const auto arm = [&](const Camera& c) { return Vec3d(c.from) - Vec3d(c.at); };
  const auto level = [&](Vec3d v) { return v - axis * dot(axis, v); };
  constexpr int kCount = 37;
  for (int i = 0; i < kCount; ++i) {
    const Camera turned = turntable_camera(camera, i, kCount);
    EXPECT_EQ(turned.at, camera.at);
    EXPECT_EQ(turned.up, camera.up);
    EXPECT_EQ(turned.fov_deg, camera.fov_deg);
    EXPECT_NEAR(length(arm(turned)), length(arm(camera)), 1e-6);
    EXPECT_NEAR(dot(arm(turned), axis), dot(arm(camera), axis), 1e-6);
    // The angle about the axis, counter-clockwise.
    const Vec3d a = level(arm(camera)), b = level(arm(turned));
    const double angle = 2 * std::numbers::pi * i / kCount;
    EXPECT_NEAR(dot(a, b) / dot(a, a), std::cos(angle), 1e-6) << i;
    EXPECT_NEAR(dot(cross(a, b), axis) / dot(a, a), std::sin(angle), 1e-6) << i;
  }
}

TEST(Turntable, QuarterTurnsAreExact) {
  Camera camera;
  camera.from = {5, 0, 2}, camera.at = {}, camera.up = {0, 0, 3};
  EXPECT_EQ(turntable_camera(camera, 1, 4).from, Vec3f(0, 5, 2));
  EXPECT_EQ(turntable_camera(camera, 2, 4).from, Vec3f(-5, 0, 2));
  EXPECT_EQ(turntable_camera(camera, 9, 12).from, Vec3f(0, -5, 2));
  EXPECT_EQ(turntable_camera(camera, 1, 2).from, Vec3f(-5, 0, 2));
}

TEST(Turntable, NumbersItsPictures) {
  EXPECT_EQ(numbered_path("a/balls.png", 0, 12), "a/balls-0001.png");
  EXPECT_EQ(numbered_path("balls.tar.exr", 11, 12), "balls.tar-0012.exr");
  EXPECT_EQ(numbered_path("/x/balls", 9999, 10000), "/x/balls-10000");
  EXPECT_EQ(numbered_path("balls.png", 0, 10000), "balls-00001.png");
}

}  // namespace
}  // namespace raio::core
