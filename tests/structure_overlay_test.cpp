// The structure's boxes drawn over the picture, and their positions.
#include "view/structure_overlay.h"

#include <gtest/gtest.h>

#include "integrate/camera.h"
#include "render/options.h"
#include "scenes.h"
#include "view/projection.h"

namespace raio::core::view {
namespace {

std::shared_ptr<const BakedScene> bake(int primitives, AccelKind kind) {
  auto baked = std::make_shared<BakedScene>();
  baked->scene = std::make_shared<const Scene>(tests::random_scene(primitives, 3));
  auto accel = build_accel(*baked->scene, {.kind = kind});
  EXPECT_TRUE(accel.has_value());
  baked->accel = std::move(*accel);
  return baked;
}

TEST(StructureOverlay, ShowsTheLargestBoxesOfTheLevel) {
  StructureOverlay overlay;
  overlay.choose({}, bake(500, AccelKind::bvh));
  EXPECT_EQ(overlay.facts().all, 0u);
  const auto few = bake(500, AccelKind::bvh);
  overlay.choose({.shown = true}, few);
  const BoxFacts leaves = overlay.facts();
  EXPECT_EQ(leaves.drawn, leaves.all);
  EXPECT_GE(leaves.levels, 2);
  EXPECT_LE(leaves.most, 8u);
  overlay.choose({.shown = true, .fewest = int(leaves.most)}, few);
  EXPECT_LT(overlay.facts().all, leaves.all);
  overlay.choose({.shown = true, .level = 0}, few);
  EXPECT_EQ(overlay.facts().all, 1u);
  EXPECT_EQ(overlay.facts().levels, leaves.levels);
  overlay.choose({.shown = true}, bake(60000, AccelKind::bvh));
  EXPECT_EQ(overlay.facts().drawn, kMaxBoxes);
  EXPECT_GT(overlay.facts().all, 2 * kMaxBoxes);
  overlay.choose({.shown = true}, bake(500, AccelKind::grid));
  EXPECT_GT(overlay.facts().all, 0u);
  EXPECT_EQ(overlay.facts().levels, 0);
  overlay.choose({.shown = true}, bake(50, AccelKind::none));
  EXPECT_EQ(overlay.facts().all, 0u);
}

TEST(StructureOverlay, LegendsExplainColours) {
  StructureOverlay overlay;
  const auto baked = bake(500, AccelKind::bvh);
  overlay.choose({.shown = true, .by_level = true}, baked);
  EXPECT_EQ(overlay.legend().stops.size(), size_t(overlay.facts().levels) + 1);
  overlay.choose({.shown = true}, baked);
  EXPECT_EQ(overlay.legend().stops.back().label, "1024+");
}

// The hit of the ray through a position of the picture is drawn at that position.
TEST(Projection, ProjectsPointsToTheirRays) {
  Camera camera;
  camera.from = {3, -7, 2}, camera.at = {0.5f, 0, 0.3f}, camera.up = {0.1f, 0, 1};
  camera.fov_deg = 50;
  const Stage stage({0, 0, 400, 300}, 1, 400, 300);
  for (const bool parallel : {true, false}) {
    camera.projection = core::Projection(parallel);
    const EyeRays rays(camera, 400, 300);
    const Projection projection(camera, stage);
    for (const std::array<float, 2> at : {std::array{200.0f, 150.0f}, {20.5f, 11.5f}, {380, 299}}) {
      const Ray ray = rays.pinhole(at[0], at[1]);
      const auto there = projection.point(Vec3d(ray.origin) + Vec3d(ray.dir) * 5.0);
      ASSERT_TRUE(there.has_value());
      EXPECT_NEAR(there->x - stage.lo.x, at[0], 0.01);
      EXPECT_NEAR(there->y - stage.lo.y, at[1], 0.01);
    }
  }
  const Projection projection(camera, stage);
  const Vec3d behind = Vec3d(camera.from) * 2.0 - Vec3d(camera.at);
  EXPECT_FALSE(projection.point(behind).has_value());
  EXPECT_FALSE(projection.segment(behind, behind + Vec3d(0.1, 0, 0)).has_value());
  const auto cut = projection.segment(behind, Vec3d(camera.at) + Vec3d(0.2, 0, 0));
  ASSERT_TRUE(cut.has_value());
}

}  // namespace
}  // namespace raio::core::view
