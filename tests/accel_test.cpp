// Properties of all structures.
#include "accel/accel.h"

#include "accel/structures.h"
#include "accel_rays.h"
#include "io/nff/nff.h"
#include "render/options.h"
#include "render/render.h"
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
using tests::random_scene;
using tests::ScaleAndShift;

TEST(Accel, RefusesScenesBeyondMemory) {
  Scene scene = random_scene(40, 1);
  scene.polygons.assign(100, {0, 4000000000u});
  scene.polygon_materials.assign(100, 0);
  const auto accel = build_accel(scene, {.kind = AccelKind::bvh});
  ASSERT_FALSE(accel.has_value());
  EXPECT_NE(accel.error().message.find("GB of memory are free"), std::string::npos)
      << accel.error().text();
}

TEST(Accel, EmbreeAgreesWithBruteForce) {
  // Embree's own sphere and triangle tests round differently: rays that graze may differ, a few in
  // 10,000.
  for (const ScaleAndShift& place : {kScalesAndShifts[0], kScalesAndShifts[3]})
    for (const bool one_sided : {false, true})
      for (const bool coherent : {false, true}) {
        const Scene scene = random_scene(600, 7, place.scale, place.shift);
        const auto oracle = build(scene, {.kind = AccelKind::none}, one_sided);
        const auto embree = build(scene, {.kind = AccelKind::embree}, one_sided);
        const RayBatch rays = awkward_rays(scene, if_sanitized(303, 10003), 4);
        const Disagreement d = disagreement(*oracle, *embree, rays, false, coherent);
        EXPECT_LE(d.closest, 10u) << "coherent " << coherent << " one-sided " << one_sided;
        EXPECT_LE(d.occluded, 10u) << "coherent " << coherent << " one-sided " << one_sided;
      }
}

TEST(Accel, EmbreeAgreesOnRaysOfAnyTime) {
  for (const bool one_sided : {false, true}) {
    const Scene scene = tests::moving_scene(one_sided);
    const RayBatch rays = tests::at_any_time(awkward_rays(scene, if_sanitized(1003, 10003), 4));
    const auto oracle = build(scene, {.kind = AccelKind::none}, one_sided);
    const Disagreement d =
        disagreement(*oracle, *build(scene, {.kind = AccelKind::embree}, one_sided), rays, false);
    EXPECT_LE(d.closest, 10u) << "one-sided " << one_sided;
    EXPECT_LE(d.occluded, 10u) << "one-sided " << one_sided;
  }
}

TEST(Accel, AgreeOnTheStandardScenes) {
  const auto paths = tests::shared_scenes();
  if (paths.empty()) GTEST_SKIP() << "the shared scenes are not here";
  for (const auto& path : paths) {
    const auto read = read_nff(path);
    ASSERT_TRUE(read.has_value()) << path;
    constexpr int kRays = if_sanitized(20, 600), kSide = if_sanitized(8, 40);
    const RayBatch rays = awkward_rays(read->scene, kRays, 5);
    const auto oracle = build(read->scene, {.kind = AccelKind::none});
    const Answers expected = answers(*oracle, rays);
    const Disagreement grid =
        disagreement(expected, *build(read->scene, {.kind = AccelKind::grid}), rays, true);
    EXPECT_EQ(grid.closest, 0u) << path;
    EXPECT_EQ(grid.occluded, 0u) << path;
    const auto tree = build(read->scene, {.kind = AccelKind::bvh});
    const Disagreement alone = disagreement(expected, *tree, rays, true);
    EXPECT_EQ(alone.closest, 0u) << path;
    EXPECT_EQ(alone.occluded, 0u) << path;
    const Disagreement packets =
        disagreement(*oracle, *tree, eye_rays(read->scene, kSide), true, true);
    EXPECT_EQ(packets.closest, 0u) << path;
    EXPECT_EQ(packets.occluded, 0u) << path;
    const Disagreement embree =
        disagreement(*oracle, *build(read->scene, {.kind = AccelKind::embree}), rays, false);
    EXPECT_LE(embree.closest, 3u) << path;
    EXPECT_LE(embree.occluded, 3u) << path;
  }
}

std::vector<AccelBox> boxes_of(const Accel& accel, int level = kLeafBoxes) {
  std::vector<AccelBox> boxes;
  accel.boxes(level, [&](const AccelBox& b) { boxes.push_back(b); });
  return boxes;
}

size_t primitives_in(const std::vector<AccelBox>& boxes) {
  size_t sum = 0;
  for (const AccelBox& b : boxes) sum += b.primitives;
  return sum;
}

bool contains(const Box3f& outer, const Box3f& inner) {
  Box3f both = outer;
  both.extend(inner);
  return both.lo == outer.lo && both.hi == outer.hi;
}

// Each level of a tree partitions the primitives, and its boxes are inside those of the level
// above.
TEST(Accel, BoxesOfATreeAreNested) {
  const Scene scene = random_scene(3000, 5);
  const auto tree = build(scene, {.kind = AccelKind::bvh});
  const size_t all = tree->info().references;
  const auto leaves = boxes_of(*tree);
  EXPECT_EQ(primitives_in(leaves), all);
  int deepest = 0;
  for (const AccelBox& leaf : leaves) deepest = std::max(deepest, leaf.level);
  ASSERT_GE(deepest, 3);
  EXPECT_EQ(boxes_of(*tree, deepest).size(), leaves.size());
  std::vector<AccelBox> above = boxes_of(*tree, 0);
  ASSERT_EQ(above.size(), 1u);
  for (int level = 1; level <= deepest; ++level) {
    const auto boxes = boxes_of(*tree, level);
    EXPECT_EQ(primitives_in(boxes), all) << level;
    EXPECT_GE(boxes.size(), above.size());
    for (const AccelBox& b : boxes) {
      EXPECT_LE(b.level, level);
      EXPECT_TRUE(std::ranges::any_of(
          above, [&](const AccelBox& outer) { return contains(outer.box, b.box); }));
    }
    above = boxes;
  }
}

// The fast grid shows exactly the cells of the counting one.
TEST(Accel, BoxesOfAGridAreItsCells) {
  const Scene scene = random_scene(3000, 5);
  const auto counting = build(scene, {.kind = AccelKind::grid, .counters = true});
  const auto cells = boxes_of(*counting);
  const auto fast = boxes_of(*build(scene, {.kind = AccelKind::grid}));
  EXPECT_EQ(primitives_in(cells), counting->info().references);
  EXPECT_LE(cells.size(), counting->info().cells);
  ASSERT_EQ(fast.size(), cells.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(fast[i].primitives, cells[i].primitives);
    EXPECT_TRUE(contains(fast[i].box, cells[i].box) && contains(cells[i].box, fast[i].box));
  }
  EXPECT_TRUE(boxes_of(*build(scene, {.kind = AccelKind::none})).empty());
  EXPECT_TRUE(boxes_of(*build(scene, {.kind = AccelKind::embree})).empty());
}

TEST(Accel, EqualDistancesGiveTheLowestPrimitive) {
  Scene scene = random_scene(4, 1);
  for (int copy = 0; copy < 5; ++copy) {
    scene.spheres.push_back({{0, 0, 0}, 0.5f});
    scene.sphere_materials.push_back(0);
  }
  const uint32_t first = uint32_t(scene.spheres.size()) - 5;
  RayBatch rays;
  rays.push({{0, 0, 0.9f}, {0, 0, -1}, 0.41f});
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh}) {
    HitBatch hits;
    TraceContext context;
    const auto accel = build(scene, {.kind = kind});
    accel->closest(rays, hits, context);
    EXPECT_EQ(hits.primitive[0], accel->geometry().id_of(PrimitiveKind::sphere, first))
        << accel_name(kind);
  }
}

TEST(Accel, RaysEndAtTmax) {
  Scene scene;
  scene.materials = {{}};
  scene.spheres = {{{0, 0, 0}, 1}};
  scene.sphere_materials = {0};
  RayBatch rays;
  for (const float tmax : {1.99f, 2.0f, 2.01f, 0.0f, -1.0f})
    rays.push({{0, 0, 3}, {0, 0, -1}, tmax});
  for (const AccelKind kind :
       {AccelKind::none, AccelKind::grid, AccelKind::bvh, AccelKind::embree}) {
    uint8_t hidden[kBatchPad] = {9, 9, 9};
    TraceContext context;
    build(scene, {.kind = kind})->occluded(rays, hidden, context);
    EXPECT_EQ(hidden[0], 0) << accel_name(kind);
    EXPECT_EQ(hidden[2], 1) << accel_name(kind);
    EXPECT_EQ(hidden[3], 0) << accel_name(kind);
    EXPECT_EQ(hidden[4], 0) << accel_name(kind);
    // Half-open: Embree includes the end.
    if (kind != AccelKind::embree) {
      EXPECT_EQ(hidden[1], 0) << accel_name(kind);
    }
  }
}

TEST(Accel, OneSidedSurfacesAreCulledOnRequest) {
  Scene scene;
  scene.materials = {{}, {{1, 1, 1}, 0.1f, 0, 1, 0.9f, 1.5f}};
  scene.spheres = {{{0, 0, 0}, -1}, {{10, 0, 0}, 1}, {{20, 0, 0}, 1}};
  scene.sphere_materials = {0, 0, 1};
  scene.cones = {{{30, 0, -1}, 1, {30, 0, 1}, 1}, {{40, 0, -1}, -1, {40, 0, 1}, -1}};
  scene.cone_materials = {0, 0};
  RayBatch rays;  // towards each from outside at -y, then from its middle
  for (const float x : {0.0f, 10.0f, 20.0f, 30.0f, 40.0f}) {
    rays.push({{x, -5, 0}, {0, 1, 0}});
    rays.push({{x, 0, 0}, {0, 1, 0}});
  }
  constexpr float kMiss = -1;
  const float both[] = {6, 1, 4, 1, 4, 1, 4, 1, 6, 1};
  const float one[] = {6, 1, 4, kMiss, 4, 1, 4, kMiss, 6, 1};
  for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh, AccelKind::embree})
    for (const bool one_sided : {false, true})
      for (const bool coherent : {false, true}) {
        HitBatch hits;
        TraceContext context;
        context.coherent = coherent;
        build(scene, {.kind = kind}, one_sided)->closest(rays, hits, context);
        for (int i = 0; i < 10; ++i) {
          const float expected = one_sided ? one[i] : both[i];
          EXPECT_EQ(hits[i].found(), expected != kMiss) << accel_name(kind) << " ray " << i;
          if (expected != kMiss) {
            EXPECT_NEAR(hits[i].t, expected, 1e-5f) << accel_name(kind) << i;
          }
        }
      }
}

TEST(Accel, CountersCountExceptWithEmbree) {
  const Scene scene = random_scene(400, 3);
  const RayBatch rays = awkward_rays(scene, 100, 2);
  HitBatch hits;
  TraceContext none, grid;
  const auto oracle = build(scene, {.kind = AccelKind::none, .counters = true});
  oracle->closest(rays, hits, none);
  const Geometry& g = oracle->geometry();
  size_t items = 0;
  for_each_kind([&]<PrimitiveKind kind> { items += g.count(kind); });
  EXPECT_EQ(none.tests, items * rays.size());
  build(scene, {.kind = AccelKind::grid, .grid_factor = 2, .counters = true})
      ->closest(rays, hits, grid);
  EXPECT_GT(grid.steps, rays.size());
  EXPECT_LT(grid.tests, none.tests / 5);
  EXPECT_GE(grid.tests, 3 * rays.size());  // oversized primitives
  EXPECT_FALSE(build_accel(scene, {.kind = AccelKind::embree, .counters = true}).has_value());
}

TEST(Accel, AnEmptySceneIsNeverHit) {
  Scene scene;
  scene.materials = {{}};
  RayBatch rays;
  rays.push({{0, 0, 0}, {0, 0, 1}});
  for (const AccelKind kind :
       {AccelKind::none, AccelKind::grid, AccelKind::bvh, AccelKind::embree}) {
    HitBatch hits;
    TraceContext context;
    build(scene, {.kind = kind})->closest(rays, hits, context);
    EXPECT_FALSE(hits[0].found()) << accel_name(kind);
  }
}

}  // namespace
}  // namespace raio::core
