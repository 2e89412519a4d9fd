// The uniform grid against every primitive, and its resolution and lists.
#include "accel/grid/grid.h"

#include <hwy/targets.h>

#include "accel_rays.h"
#include "sanitized.h"

namespace raio::core {
namespace {

using tests::Answers;
using tests::answers;
using tests::awkward_rays;
using tests::build;
using tests::Disagreement;
using tests::disagreement;
using tests::eye_rays;
using tests::if_sanitized;
using tests::kScalesAndShifts;
using tests::random_direction;
using tests::random_scene;
using tests::ScaleAndShift;
using tests::shadow_rays;
using tests::two_sided;

TEST(Grid, MatchesBruteForceExactly) {
  for (const ScaleAndShift& place : kScalesAndShifts)
    for (const bool one_sided : {false, true}) {
      const Scene scene = random_scene(600, 7, place.scale, place.shift);
      const auto oracle = build(scene, {.kind = AccelKind::none}, one_sided);
      const RayBatch rays = awkward_rays(scene, if_sanitized(300, 10000), 3);
      const Answers expected = answers(*oracle, rays);
      for (const float factor : {0.5f, 2.0f, 6.0f})
        for (const bool counters : {false, true}) {
          const AccelOptions o = {
              .kind = AccelKind::grid, .grid_factor = factor, .counters = counters};
          const Disagreement d = disagreement(expected, *build(scene, o, one_sided), rays, true);
          EXPECT_EQ(d.closest, 0u) << "scale " << place.scale << " factor " << factor;
          EXPECT_EQ(d.occluded, 0u) << "scale " << place.scale << " factor " << factor;
        }
    }
}

// Beams, and rays that go alone; every instruction set that this machine has.
TEST(Grid, CoherentRaysMatchBruteForceExactly) {
  for (const ScaleAndShift& place : kScalesAndShifts) {
    const Scene scene = two_sided(random_scene(900, 5, place.scale, place.shift));
    const auto oracle = build(scene, {.kind = AccelKind::none});
    RayBatch rays = eye_rays(scene, if_sanitized(16, 32));
    const RayBatch shadow = shadow_rays(*oracle, rays, scene.camera.from);
    const RayBatch awkward = awkward_rays(scene, if_sanitized(200, 500), 6);
    for (const RayBatch* more : {&shadow, &awkward})
      for (size_t i = 0; i < more->size(); ++i) rays.push((*more)[i]);
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      const Answers expected = answers(*oracle, rays, true);
      for (const std::array<int, 3> n :
           {std::array{0, 0, 0}, {1, 1, 1}, {7, 7, 7}, {40, 3, 1}, {2, 30, 90}}) {
        const auto grid = build(scene, {.kind = AccelKind::grid, .grid_resolution = n});
        const Disagreement d = disagreement(expected, *grid, rays, true, true);
        EXPECT_EQ(d.closest, 0u) << hwy::TargetName(target) << ' ' << place.scale << ' ' << n[0];
        EXPECT_EQ(d.occluded, 0u) << hwy::TargetName(target) << ' ' << place.scale << ' ' << n[0];
      }
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

// Two ray groups far apart: rays of all sorts from one to the other, over cells that list nothing.
TEST(Grid, SkippingEmptySpaceLosesNoHit) {
  Scene scene;
  scene.materials = {{}};
  std::mt19937 rng(3);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    const float far = i % 2 ? 100.0f : 0.0f;
    scene.spheres.push_back({{far + unit(rng), far * 0.3f + unit(rng), unit(rng)}, 0.02f});
    scene.sphere_materials.push_back(0);
  }
  const auto oracle = build(scene, {.kind = AccelKind::none});
  RayBatch rays;
  for (int i = 0; i < 4000; ++i) {
    const Vec3f from = scene.spheres[rng() % 200].center;
    const Vec3f offset = 0.02f * random_direction(rng);
    rays.push({from, normalize(scene.spheres[rng() % 200].center + offset - from)});
  }
  for (const std::array<int, 3> n : {std::array{300, 100, 5}, {20, 7, 1}, {3, 200, 9}}) {
    const auto grid = build(scene, {.kind = AccelKind::grid, .grid_resolution = n});
    EXPECT_EQ(disagreement(*oracle, *grid, rays, true).closest, 0u) << n[0];
  }
}

TEST(Grid, EmptyCellsStoreTheDistanceToOthers) {
  const Scene scene = random_scene(60, 4);
  const Geometry g(scene, scene);
  const auto cells = build_grid(g, {.kind = AccelKind::grid, .grid_resolution = {13, 9, 11}});
  ASSERT_TRUE(cells);
  const auto blocks = bake_grid(g, *cells);
  ASSERT_TRUE(blocks);
  const Lattice& l = cells->lattice;
  const auto listed = [&](size_t c) { return cells->begin[c + 1] > cells->begin[c]; };
  int farthest = 0;
  const auto distance = [&](std::array<int, 3> from) {
    int least = kFarthest;
    for (int z = 0; z < l.n[2]; ++z)
      for (int y = 0; y < l.n[1]; ++y)
        for (int x = 0; x < l.n[0]; ++x)
          if (listed(l.index(x, y, z)))
            least = std::min(least, std::max({std::abs(x - from[0]), std::abs(y - from[1]),
                                              std::abs(z - from[2])}));
    return least;
  };
  for (int z = 0; z < l.n[2]; ++z)
    for (int y = 0; y < l.n[1]; ++y)
      for (int x = 0; x < l.n[0]; ++x) {
        const int is = blocks->empty_around[l.index(x, y, z)];
        ASSERT_EQ(is, distance({x, y, z})) << x << ' ' << y << ' ' << z;
        farthest = std::max(farthest, is);
      }
  EXPECT_GT(farthest, 1);
}

TEST(Grid, BlocksHoldTheCellsPrimitivesAndBoxes) {
  const Scene scene = random_scene(900, 6);
  const Geometry g(scene, scene);
  const auto cells = build_grid(g, {.kind = AccelKind::grid, .grid_resolution = {4, 5, 6}});
  ASSERT_TRUE(cells);
  const auto blocks = bake_grid(g, *cells);
  ASSERT_TRUE(blocks);
  for (size_t c = 0; c < cells->lattice.cells(); ++c) {
    std::vector<PrimitiveId> found;
    for (uint32_t i = blocks->begin[c]; i < blocks->begin[c + 1]; ++i) {
      const BlockGroup& group = blocks->groups[i];
      for (size_t k = 0; k < kBlockWidth; ++k) {
        const uint32_t ref = group.block[k];
        if (ref == kNoPrimitive) continue;
        const PrimitiveId* const items = blocks->primitives(ref);
        for (size_t n = 0; n < kBlockWidth && items[n] != kNoPrimitive; ++n)
          found.push_back(items[n]);
        for (int a = 0; a < 3; ++a)
          EXPECT_LE(group.boxes.planes[0][a][k], group.boxes.planes[1][a][k]);
      }
    }
    const std::vector<PrimitiveId> listed(cells->items.begin() + cells->begin[c],
                                          cells->items.begin() + cells->begin[c + 1]);
    EXPECT_EQ(found, listed) << "cell " << c;
  }
  EXPECT_FALSE(bake_grid(g, *cells, {.bytes = 10'000, .within = ""}));
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
  const AccelInfo info = build(scene, {.kind = AccelKind::grid, .grid_factor = 2})->info();
  EXPECT_EQ(info.resolution, (std::array<int, 3>{36, 18, 4}));
  EXPECT_EQ(info.cells, 36u * 18 * 4);
  const AccelInfo forced =
      build(scene, {.kind = AccelKind::grid, .grid_resolution = {5, 6, 7}})->info();
  EXPECT_EQ(forced.resolution, (std::array<int, 3>{5, 6, 7}));
}

TEST(Grid, ListsSurfacesNotVolumes) {
  // One large sphere cut by many cells: those inside it stay empty.
  Scene scene;
  scene.materials = {{}};
  scene.spheres = {{{0, 0, 0}, 1}, {{5, 0, 0}, 1}, {{0, 5, 0}, 1}, {{0, 0, 5}, 1}, {{5, 5, 5}, 1}};
  scene.sphere_materials.assign(5, 0);
  const AccelInfo info =
      build(scene, {.kind = AccelKind::grid, .grid_resolution = {70, 70, 70}})->info();
  ASSERT_EQ(info.oversized, 0u);
  // A sphere of radius 10 cells overlaps about 6 pi r^2 = 1885 of them; its box has 8000, its ball
  // 4189.
  EXPECT_GT(info.references, 5u * 1500);
  EXPECT_LT(info.references, 5u * 2600);
}

TEST(Grid, KeepsOversizedPrimitivesOut) {
  Scene scene = random_scene(400, 3);
  const AccelInfo info = build(scene, {.kind = AccelKind::grid})->info();
  EXPECT_EQ(info.oversized, 3u);  // the plane and the two triangles of the floor
}

TEST(Grid, SurvivesFlatScenesAndManyLargePrimitives) {
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

TEST(Grid, RefusesScenesBeyondMemory) {
  const Scene scene = random_scene(40, 1);
  const auto grid =
      build_accel(scene, {.kind = AccelKind::grid, .grid_resolution = {100000, 100000, 100000}});
  ASSERT_FALSE(grid.has_value());
  EXPECT_NE(grid.error().text().find("100000x100000x100000"), std::string::npos)
      << grid.error().text();
}

}  // namespace
}  // namespace raio::core
