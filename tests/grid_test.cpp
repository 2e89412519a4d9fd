// The uniform grid against every primitive, and its resolution and lists.
#include "accel_rays.h"

namespace raio {
namespace {

using namespace testing;

TEST(Grid, FindsTheVeryHitsOfBruteForce) {
  for (const Placement& place : kPlacements)
    for (const bool one_sided : {false, true}) {
      const Scene scene = random_scene(600, 7, place.scale, place.shift);
      const auto oracle = build(scene, {.kind = AccelKind::none}, one_sided);
      const RayBatch rays = awkward_rays(scene, 10000, 3);
      for (const float factor : {0.5f, 2.0f, 6.0f}) {
        const auto grid = build(scene, {.kind = AccelKind::grid, .grid_factor = factor}, one_sided);
        const Disagreement d = disagreement(*oracle, *grid, rays, true);
        EXPECT_EQ(d.closest, 0u) << "scale " << place.scale << " factor " << factor;
        EXPECT_EQ(d.occluded, 0u) << "scale " << place.scale << " factor " << factor;
      }
    }
}

TEST(Grid, HasTheResolutionOfTheReport) {
  Scene scene;
  scene.materials = {{}};
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 16; ++x) {
        scene.spheres.push_back({{float(x), float(y), float(z)}, 0.25f});
        scene.sphere_materials.push_back(0);
      }
  // Box 15.5 x 7.5 x 1.5, 256 spheres: s = cbrt(174.4 / 256) = 0.88; 2 * side / s + 1.
  const AccelInfo info = build(scene, {.kind = AccelKind::grid})->info();
  EXPECT_EQ(info.resolution, (std::array<int, 3>{36, 18, 4}));
  EXPECT_EQ(info.cells, 36u * 18 * 4);
  const AccelInfo forced =
      build(scene, {.kind = AccelKind::grid, .grid_resolution = {5, 6, 7}})->info();
  EXPECT_EQ(forced.resolution, (std::array<int, 3>{5, 6, 7}));
}

TEST(Grid, ListsShellsAndNotBalls) {
  // One large sphere cut by many cells: those inside it stay empty.
  Scene scene;
  scene.materials = {{}};
  scene.spheres = {{{0, 0, 0}, 1}, {{5, 0, 0}, 1}, {{0, 5, 0}, 1}, {{0, 0, 5}, 1}, {{5, 5, 5}, 1}};
  scene.sphere_materials.assign(5, 0);
  const AccelInfo info =
      build(scene, {.kind = AccelKind::grid, .grid_resolution = {70, 70, 70}})->info();
  ASSERT_EQ(info.giants, 0u);
  // A sphere of radius 10 cells meets about 6 pi r^2 = 1885 of them; its box has 8000, its ball
  // 4189.
  EXPECT_GT(info.references, 5u * 1500);
  EXPECT_LT(info.references, 5u * 2600);
}

TEST(Grid, KeepsGiantsOut) {
  Scene scene = random_scene(400, 3);
  const AccelInfo info = build(scene, {.kind = AccelKind::grid})->info();
  EXPECT_EQ(info.giants, 3u);  // the plane and the two triangles of the floor
}

TEST(Grid, SurvivesFlatScenesAndHeapsOfLargePrimitives) {
  Scene flat;
  flat.materials = {{}};
  for (int i = 0; i < 3000; ++i) {
    const float x = float(i % 60), y = float(i / 60);
    const uint32_t first = uint32_t(flat.positions.size());
    for (const Vec3f p : {Vec3f(x, y, 0), {x + 1, y, 0}, {x, y + 1, 0}})
      flat.positions.push_back(p);
    flat.triangles.push_back({first, first + 1, first + 2});
    flat.triangle_materials.push_back(0);
  }
  const AccelInfo info = build(flat, {.kind = AccelKind::grid})->info();
  EXPECT_EQ(info.resolution[2], 1);
  EXPECT_LT(info.cells, 20000u);

  Scene heap;  // each spans all the others
  heap.materials = {{}};
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> unit(-1, 1);
  for (int i = 0; i < 20000; ++i) {
    const uint32_t first = uint32_t(heap.positions.size());
    for (int k = 0; k < 3; ++k) heap.positions.push_back({unit(rng), unit(rng), unit(rng)});
    heap.triangles.push_back({first, first + 1, first + 2});
    heap.triangle_materials.push_back(0);
  }
  const auto grid = build(heap, {.kind = AccelKind::grid});
  EXPECT_LT(grid->info().references, 100u * 20000);
  const RayBatch rays = awkward_rays(heap, 200, 9);
  EXPECT_EQ(disagreement(*build(heap, {.kind = AccelKind::none}), *grid, rays, true).closest, 0u);
}

TEST(Grid, RefusesWhatNoMemoryHolds) {
  const Scene scene = random_scene(40, 1);
  const auto grid =
      build_accel(scene, {.kind = AccelKind::grid, .grid_resolution = {100000, 100000, 100000}});
  ASSERT_FALSE(grid.has_value());
  EXPECT_NE(grid.error().find("100000x100000x100000"), std::string::npos) << grid.error();
}

}  // namespace
}  // namespace raio
