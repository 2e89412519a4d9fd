// Every structure against every primitive.
#include "accel/accel.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "accel/bvh.h"
#include "accel/structures.h"
#include "io/nff.h"
#include "render/camera.h"
#include "render/options.h"
#include "render/render.h"
#include "scenes.h"

namespace raio {
namespace {

using testing::random_scene;

Vec3f random_direction(std::mt19937& rng) {
  std::normal_distribution<float> normal;
  while (true) {
    const Vec3f d(normal(rng), normal(rng), normal(rng));
    if (dot(d, d) > 1e-6f) return normalize(d);
  }
}

// Rays as pictures have them and as they hurt: through the scene from outside and inside, along the
// axes and in the planes of cells, towards the boxes' corners, and of limited length.
RayBatch awkward_rays(const Scene& scene, int count, uint32_t seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  Box3f box = bounds(scene);
  if (box.empty()) box = {scene.camera.at - Vec3f(1), scene.camera.at + Vec3f(1)};
  const auto inside = [&] { return box.lo + box.size() * Vec3f(unit(rng), unit(rng), unit(rng)); };
  RayBatch rays;
  const EyeRays eye(scene.camera, 64, 64);
  const float extent = max_component(box.size());
  for (int i = 0; i < count; ++i) {
    Ray ray;
    switch (i % 5) {
      case 0:
        ray = eye.pinhole(64 * unit(rng), 64 * unit(rng));
        break;
      case 1:
        ray = {inside(), random_direction(rng)};
        break;
      case 2: {
        const Vec3f origin = inside() + random_direction(rng) * (2 * extent);
        ray = {origin, normalize(inside() - origin)};
        break;
      }
      case 3: {  // along an axis, from a point on a face of the box or of a cell of a grid
        const int axis = int(rng() % 3);
        Vec3f origin = inside(), dir;
        dir[axis] = rng() % 2 ? 1.0f : -1.0f;
        origin[(axis + 1) % 3] =
            box.lo[(axis + 1) % 3] + box.size()[(axis + 1) % 3] * float(rng() % 9) / 8;
        ray = {origin - dir * extent, dir};
        break;
      }
      case 4:
        ray = {inside(), random_direction(rng), extent * 0.2f * unit(rng)};
        break;
    }
    rays.push(ray);
  }
  return rays;
}

// The scene with both sides of everything to be seen, as rays that travel together want it.
Scene two_sided(Scene scene) {
  for (Sphere& s : scene.spheres) s.radius = std::abs(s.radius);
  for (Cone& c : scene.cones)
    c.base_radius = std::abs(c.base_radius), c.apex_radius = std::abs(c.apex_radius);
  return scene;
}

// As renderers have them: towards a light from where eye rays hit, in their order, and with rays
// that need no test among them.
RayBatch shadow_rays(const Accel& accel, const RayBatch& eye, Vec3f light) {
  HitBatch hits;
  TraceContext context;
  accel.closest(eye, hits, context);
  RayBatch rays;
  for (size_t i = 0; i < eye.size(); ++i) {
    const Vec3f point = eye[i].at(hits[i].found() ? 0.999f * hits[i].t : 1.0f);
    const Vec3f to_light = light - point;
    const float distance = length(to_light);
    rays.push({point, to_light / distance, hits[i].found() && i % 5 ? distance : -1.0f});
  }
  return rays;
}

// What travels in packets: blocks of pixels.
RayBatch eye_rays(const Scene& scene, int side) {
  RayBatch rays;
  const EyeRays eye(scene.camera, side, side);
  for (int y = 0; y < side; y += 4)
    for (int x = 0; x < side; x += 4)
      for (int k = 0; k < 16; ++k) rays.push(eye.pinhole(float(x + k % 4), float(y + k / 4)));
  return rays;
}

struct Disagreement {
  size_t closest = 0, occluded = 0, total = 0;
};

// `exact`: the same item at the same distance to the last bit; otherwise the distance to a
// tolerance, which may belong to another of several primitives that touch (and not the rays along
// the axes).
Disagreement disagreement(const Accel& oracle, const Accel& accel, const RayBatch& rays, bool exact,
                          bool coherent = false) {
  TraceContext context;
  context.coherent = coherent;
  HitBatch expected, found;
  std::vector<uint8_t> shadow_expected(padded(rays.size())), shadow_found(padded(rays.size()));
  oracle.closest(rays, expected, context);
  accel.closest(rays, found, context);
  oracle.occluded(rays, shadow_expected.data(), context);
  accel.occluded(rays, shadow_found.data(), context);
  Disagreement out;
  out.total = rays.size();
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit a = expected[i], b = found[i];
    if (!exact && i % 5 == 3) continue;  // along edges of boxes: in or out are both right
    EXPECT_EQ(shadow_expected[i] != 0, a.found()) << "the oracle disagrees with itself, ray " << i;
    const bool same =
        exact ? a.item == b.item && (!a.found() || a.t == b.t)
              : a.found() == b.found() && (!a.found() || std::abs(a.t - b.t) <= 1e-4f * a.t);
    out.closest += !same;
    out.occluded += shadow_expected[i] != shadow_found[i];
  }
  return out;
}

std::unique_ptr<Accel> build(const Scene& scene, AccelOptions options, bool one_sided = false) {
  auto accel = build_accel(scene, options, one_sided);
  EXPECT_TRUE(accel.has_value()) << accel.error();
  return std::move(*accel);
}

struct Placement {
  float scale;
  Vec3f shift;
};
const Placement kPlacements[] = {{1, {}}, {1e-6f, {}}, {1e6f, {}}, {1, {500, -300, 100}}};

TEST(Accel, GridFindsTheVeryHitsOfBruteForce) {
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

// Every instruction set that this machine has, down to none.
TEST(Accel, TheTreeFindsTheVeryHitsOfBruteForce) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (const Placement& place : kPlacements)
      for (const bool one_sided : {false, true})
        for (const bool coherent : {false, true}) {
          const Scene scene = random_scene(600, 7, place.scale, place.shift);
          const auto oracle = build(scene, {.kind = AccelKind::none}, one_sided);
          const auto tree = build(scene, {.kind = AccelKind::bvh}, one_sided);
          RayBatch rays = awkward_rays(scene, 4000, 3);
          const RayBatch eye = eye_rays(scene, 48);
          for (size_t i = 0; i < eye.size(); ++i) rays.push(eye[i]);
          const Disagreement d = disagreement(*oracle, *tree, rays, true, coherent);
          EXPECT_EQ(d.closest, 0u) << hwy::TargetName(target) << " scale " << place.scale;
          EXPECT_EQ(d.occluded, 0u) << hwy::TargetName(target) << " scale " << place.scale;
        }
  }
  hwy::SetSupportedTargetsForTest(0);
}

// Long batches of all sorts of rays by every way through the tree: as beams of sixteen, each in the
// stream, against all of a few primitives.
TEST(Accel, RaysThatTravelTogetherFindTheVeryHitsOfBruteForce) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (const Placement& place : kPlacements)
      for (const int count : {3, 12, 1000}) {
        const Scene scene = two_sided(random_scene(count, 11, place.scale, place.shift));
        const auto oracle = build(scene, {.kind = AccelKind::none});
        const auto tree = build(scene, {.kind = AccelKind::bvh});
        RayBatch rays = eye_rays(scene, 40);
        for (const Light& light : scene.lights) {
          const RayBatch shadow = shadow_rays(*oracle, eye_rays(scene, 28), light.position);
          for (size_t i = 0; i < shadow.size(); ++i) rays.push(shadow[i]);
        }
        const RayBatch awkward = awkward_rays(scene, 500, 6);
        for (size_t i = 0; i < awkward.size(); ++i) rays.push(awkward[i]);
        const Disagreement d = disagreement(*oracle, *tree, rays, true, true);
        EXPECT_EQ(d.closest, 0u) << hwy::TargetName(target) << " " << place.scale << " " << count;
        EXPECT_EQ(d.occluded, 0u) << hwy::TargetName(target) << " " << place.scale << " " << count;
      }
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(Accel, BatchesOfAnyLengthAreTracedToTheLast) {
  const Scene scene = two_sided(random_scene(300, 8));
  const auto oracle = build(scene, {.kind = AccelKind::none});
  const auto tree = build(scene, {.kind = AccelKind::bvh});
  const RayBatch eye = eye_rays(scene, 48);
  for (const size_t length : {0, 1, 2, 15, 16, 17, 63, 1023, 1024, 1025, 2049}) {
    RayBatch rays;
    for (size_t i = 0; i < length; ++i) rays.push(eye[i]);
    const Disagreement d = disagreement(*oracle, *tree, rays, true);
    EXPECT_EQ(d.closest, 0u) << length;
    EXPECT_EQ(d.occluded, 0u) << length;
  }
}

// A million rays from inside a closed mesh through the edges that its triangles share: none leaks,
// be it in a beam or on its own.
TEST(Accel, MeshesAreWatertightForRaysThatTravelTogether) {
  for (const int side : {1, 24}) {  // a few triangles, and a tree
    Scene scene;
    scene.materials = {{}};
    for (int face = 0; face < 6; ++face)
      for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x) {
          Vec3f p;
          const float u = 2 * float(x) / float(side) - 1, v = 2 * float(y) / float(side) - 1;
          p[face % 3] = face < 3 ? -1.0f : 1.0f;
          p[(face + 1) % 3] = u, p[(face + 2) % 3] = v;
          scene.positions.push_back(p * (1 + 0.2f * std::sin(7 * p.x) * std::cos(5 * p.y - p.z)));
          if (x == side || y == side) continue;
          const uint32_t i = uint32_t(scene.positions.size()) - 1, up = i + uint32_t(side) + 1;
          scene.triangles.push_back({i, i + 1, up + 1});
          scene.triangles.push_back({i, up + 1, up});
        }
    scene.triangle_materials.assign(scene.triangles.size(), 0);
    const auto tree = build(scene, {.kind = AccelKind::bvh});
    std::mt19937 rng(5);
    std::uniform_real_distribution<float> unit(0, 1);
    size_t leaks = 0, total = 0;
    for (int round = 0; round < 500; ++round) {
      RayBatch rays;
      HitBatch hits;
      TraceContext context;
      while (rays.size() < 1024) {
        const Vec3f from = Vec3f(unit(rng), unit(rng), unit(rng)) * 0.5f - Vec3f(0.25f);
        const TriangleIndices& t = scene.triangles[rng() % scene.triangles.size()];
        const Vec3f a = scene.positions[t[0]], b = scene.positions[t[rng() % 2 + 1]];
        for (int i = 0; i < (round % 2 ? 16 : 1); ++i)  // a beam along the edge, or one alone
          rays.push({from, normalize(a + (b - a) * unit(rng) - from)});
      }
      tree->closest(rays, hits, context);
      for (size_t i = 0; i < rays.size(); ++i) leaks += !hits[i].found();
      std::vector<uint8_t> hidden(padded(rays.size()));
      tree->occluded(rays, hidden.data(), context);
      for (size_t i = 0; i < rays.size(); ++i) leaks += !hidden[i];
      total += 2 * rays.size();
    }
    EXPECT_EQ(leaks, 0u) << "of " << total << ", side " << side;
  }
}

template <class T>
bool same_bytes(const Column<T>& a, const Column<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// Spheres of radii from 1e-4 to 1, in a few dense heaps, one of them in a single point, and one
// sphere around all: so many that a plan is made, and again in the heaps.
Scene heaps(int count) {
  std::mt19937 rng(11);
  std::normal_distribution<float> normal;
  Scene scene;
  scene.materials = {{}};
  scene.spheres.push_back({{0, 0, 0}, 500});
  for (int i = 1; i < count; ++i) {
    const int heap = int(rng() % 4);
    const Vec3f around(normal(rng), normal(rng), normal(rng));
    const float size = heap == 0 ? 0 : std::pow(0.01f, float(heap));
    scene.spheres.push_back({Vec3f(float(heap * heap * 50)) + around * size, size / 100 + 1e-4f});
  }
  scene.sphere_materials.assign(scene.spheres.size(), 0);
  return scene;
}

TEST(Accel, TheTreeIsTheSameForAnyNumberOfThreads) {
  for (const Scene& scene : {random_scene(60000, 2), heaps(600000)}) {
    const Geometry geometry(scene);
    Bvh one;
    on_threads(1, [&] { one = *build_bvh(geometry); });
    for (const int threads : {2, 7}) {
      Bvh many;
      on_threads(threads, [&] { many = *build_bvh(geometry); });
      EXPECT_EQ(one.reach, many.reach);
      EXPECT_TRUE(same_bytes(one.nodes, many.nodes)) << threads;
      EXPECT_TRUE(same_bytes(one.spheres, many.spheres)) << threads;
      EXPECT_TRUE(same_bytes(one.triangles, many.triangles)) << threads;
      EXPECT_TRUE(same_bytes(one.cones, many.cones)) << threads;
    }
  }
}

// Walks down the tree, counts the leaf lanes that hold each item, and asks that every box holds
// what is below it.
class TreeCheck {
 public:
  TreeCheck(const Geometry& geometry, const Bvh& bvh) : g_(geometry), b_(bvh) {
    if (!b_.nodes.empty()) check(bvh_ref(BvhChild::node, 0), Box3f{Vec3f(-kMost), Vec3f(kMost)}, 0);
  }

  std::map<ItemId, int> seen;
  size_t nodes = 0, blocks = 0, outside = 0;
  int levels = 0;

 private:
  static constexpr float kMost = std::numeric_limits<float>::max();

  void check(uint32_t ref, const Box3f& around, int depth) {
    const uint32_t i = bvh_index(ref);
    levels = std::max(levels, depth);
    if (bvh_kind(ref) != BvhChild::node) {
      ++blocks;
      const ItemId* items = bvh_kind(ref) == BvhChild::spheres     ? b_.spheres[i].item
                            : bvh_kind(ref) == BvhChild::triangles ? b_.triangles[i].item
                                                                   : b_.cones[i].item;
      for (int k = 0; k < kBvhWidth; ++k) {
        if (items[k] == kNoItem) continue;
        ++seen[items[k]];
        outside += !holds(around, g_.bounds(items[k]));
        EXPECT_TRUE(k == 0 || items[k - 1] < items[k]);
      }
      return;
    }
    ++nodes;
    const BvhNode& node = b_.nodes[i];
    for (int k = 0; k < kBvhWidth; ++k) {
      if (node.child[k] == kNoChild) continue;
      Box3f box;
      for (int a = 0; a < 3; ++a)
        box.lo[a] = node.boxes.planes[0][a][k], box.hi[a] = node.boxes.planes[1][a][k];
      outside += !holds(around, box);
      check(node.child[k], box, depth + 1);
    }
  }
  static bool holds(const Box3f& a, const Box3f& b) {
    return min(a.lo, b.lo) == a.lo && max(a.hi, b.hi) == a.hi;
  }

  const Geometry& g_;
  const Bvh& b_;
};

TEST(Accel, TheTreeHoldsEveryItemOnceInsideItsBoxes) {
  Scene same;  // that no plane can part, and more than a plan needs
  same.materials = {{}};
  same.spheres.assign(300000, {{0.1f, 0.2f, 0.3f}, 0.25f});
  same.sphere_materials.assign(same.spheres.size(), 0);
  for (const Scene& scene : {random_scene(20000, 2), random_scene(20000, 2, 1e-6f),
                             random_scene(5, 1), heaps(300000), heaps(3), same}) {
    const Geometry g(scene);
    const Bvh bvh = *build_bvh(g);
    const TreeCheck check(g, bvh);
    EXPECT_EQ(check.outside, 0u);
    EXPECT_EQ(check.nodes, bvh.nodes.size());
    EXPECT_EQ(check.blocks, bvh.spheres.size() + bvh.triangles.size() + bvh.cones.size());
    EXPECT_LE(check.levels, kBvhMaxLevels);
    size_t items = 0;
    for (const ItemKind kind : {ItemKind::sphere, ItemKind::triangle, ItemKind::cone})
      items += g.count(kind);
    EXPECT_EQ(check.seen.size(), items);
    for (const auto& [item, times] : check.seen) ASSERT_EQ(times, 1) << item;
  }
}

TEST(Accel, BakingRefusesWhatNoMemoryHolds) {
  Scene scene = random_scene(40, 1);
  scene.polygons.assign(100, {0, 4000000000u});
  scene.polygon_materials.assign(100, 0);
  const auto accel = build_accel(scene, {.kind = AccelKind::bvh});
  ASSERT_FALSE(accel.has_value());
  EXPECT_NE(accel.error().find("GB are free"), std::string::npos) << accel.error();
}

TEST(Accel, FewOfAKindAreALeafBelowTheRoot) {
  Scene scene = random_scene(4000, 2);
  scene.cones.resize(3);
  scene.cone_materials.resize(3);
  const Geometry g(scene);
  const Bvh bvh = *build_bvh(g);
  EXPECT_EQ(bvh.cones.size(), 1u);
  EXPECT_EQ(std::ranges::count(bvh.nodes[0].child, bvh_ref(BvhChild::cones, 0)), 1);
}

TEST(Accel, TheTreeRefusesWhatNoMemoryHolds) {
  const Scene scene = random_scene(4000, 2);
  const Geometry geometry(scene);
  const auto bvh = build_bvh(geometry, 1000);
  ASSERT_FALSE(bvh.has_value());
  EXPECT_NE(bvh.error().find("0.0 GB are free"), std::string::npos) << bvh.error();
  EXPECT_EQ(bvh.error().find('\n'), std::string::npos);
}

// Triangles, cones and spheres that no plane can part.
TEST(Accel, TheTreeSurvivesHeapsOfTheSame) {
  Scene scene = random_scene(40, 3);
  for (int copy = 0; copy < 5000; ++copy) {
    scene.spheres.push_back({{0.1f, 0.2f, 0.3f}, 0.25f});
    scene.sphere_materials.push_back(0);
    scene.cones.push_back({{0, 0, 0}, 0.1f, {0, 0, 1}, 0.1f});
    scene.cone_materials.push_back(1);
  }
  const RayBatch rays = awkward_rays(scene, 300, 9);
  for (const bool coherent : {false, true})
    EXPECT_EQ(disagreement(*build(scene, {.kind = AccelKind::none}),
                           *build(scene, {.kind = AccelKind::bvh}), rays, true, coherent)
                  .closest,
              0u);
}

TEST(Accel, EmbreeAgreesWithBruteForce) {
  // Embree's own sphere and triangle tests round differently: rays that graze may differ, a few in
  // 10,000.
  for (const Placement& place : {kPlacements[0], kPlacements[3]})
    for (const bool one_sided : {false, true})
      for (const bool coherent : {false, true}) {
        const Scene scene = random_scene(600, 7, place.scale, place.shift);
        const auto oracle = build(scene, {.kind = AccelKind::none}, one_sided);
        const auto embree = build(scene, {.kind = AccelKind::embree}, one_sided);
        const Disagreement d =
            disagreement(*oracle, *embree, awkward_rays(scene, 10003, 4), false, coherent);
        EXPECT_LE(d.closest, 10u) << "coherent " << coherent << " one-sided " << one_sided;
        EXPECT_LE(d.occluded, 10u) << "coherent " << coherent << " one-sided " << one_sided;
      }
}

TEST(Accel, AgreeOnTheStandardScenes) {
  const auto paths = testing::shared_scenes();
  if (paths.empty()) GTEST_SKIP() << "the shared scenes are not here";
  for (const auto& path : paths) {
    const auto read = read_nff(path);
    ASSERT_TRUE(read.has_value()) << path;
    // The thread sanitizer makes brute force, which has no threads, a hundred times as slow.
#ifdef __SANITIZE_THREAD__
    constexpr int kRays = 50, kSide = 8;
#else
    constexpr int kRays = 1500, kSide = 40;
#endif
    const RayBatch rays = awkward_rays(read->scene, kRays, 5);
    const auto oracle = build(read->scene, {.kind = AccelKind::none});
    const Disagreement grid =
        disagreement(*oracle, *build(read->scene, {.kind = AccelKind::grid}), rays, true);
    EXPECT_EQ(grid.closest, 0u) << path;
    EXPECT_EQ(grid.occluded, 0u) << path;
    const auto tree = build(read->scene, {.kind = AccelKind::bvh});
    EXPECT_EQ(disagreement(*oracle, *tree, rays, true).closest, 0u) << path;
    EXPECT_EQ(disagreement(*oracle, *tree, rays, true).occluded, 0u) << path;
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
    build(scene, {.kind = kind})->closest(rays, hits, context);
    EXPECT_EQ(hits.item[0], item_id(ItemKind::sphere, first)) << accel_name(kind);
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
    // Half-open: Embree counts the end itself.
    if (kind != AccelKind::embree) {
      EXPECT_EQ(hidden[1], 0) << accel_name(kind);
    }
  }
}

TEST(Accel, SidesAreSeenAsAsked) {
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

TEST(Accel, CountersCountAndEmbreeSaysThatItDoesNot) {
  const Scene scene = random_scene(400, 3);
  const RayBatch rays = awkward_rays(scene, 100, 2);
  HitBatch hits;
  TraceContext none, grid;
  const auto oracle = build(scene, {.kind = AccelKind::none, .counters = true});
  oracle->closest(rays, hits, none);
  const Geometry& g = oracle->geometry();
  const size_t items = g.count(ItemKind::plane) + g.count(ItemKind::sphere) +
                       g.count(ItemKind::triangle) + g.count(ItemKind::cone);
  EXPECT_EQ(none.tests, items * rays.size());
  build(scene, {.kind = AccelKind::grid, .counters = true})->closest(rays, hits, grid);
  EXPECT_GT(grid.steps, rays.size());
  EXPECT_LT(grid.tests, none.tests / 5);
  EXPECT_GE(grid.tests, 3 * rays.size());  // giants
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
}  // namespace raio
