// The eight-wide tree against brute force, and its contents.
#include "accel/bvh/bvh.h"

#include <hwy/targets.h>

#include <cstring>
#include <map>

#include "accel_rays.h"
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
using tests::random_direction;
using tests::random_scene;
using tests::ScaleAndShift;
using tests::shadow_rays;
using tests::two_sided;

// Every instruction set of this machine, down to the baseline.
TEST(Bvh, MatchesBruteForceExactly) {
  for (const ScaleAndShift& place : kScalesAndShifts)
    for (const bool one_sided : {false, true}) {
      const Scene scene = random_scene(600, 7, place.scale, place.shift);
      RayBatch rays = awkward_rays(scene, if_sanitized(500, 4000), 3);
      const RayBatch eye = eye_rays(scene, 48);
      for (size_t i = 0; i < eye.size(); ++i) rays.push(eye[i]);
      const Answers expected = answers(*build(scene, {.kind = AccelKind::none}, one_sided), rays);
      for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        const auto tree = build(scene, {.kind = AccelKind::bvh}, one_sided);
        for (const bool coherent : {false, true}) {
          const Disagreement d = disagreement(expected, *tree, rays, true, coherent);
          EXPECT_EQ(d.closest, 0u) << hwy::TargetName(target) << " scale " << place.scale;
          EXPECT_EQ(d.occluded, 0u) << hwy::TargetName(target) << " scale " << place.scale;
        }
      }
      hwy::SetSupportedTargetsForTest(0);
    }
}

// Long batches of all sorts of rays by every way through the tree: as beams of sixteen, each in the
// stream, against all of a few primitives.
TEST(Bvh, CoherentRaysMatchBruteForceExactly) {
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (const ScaleAndShift& place : kScalesAndShifts)
      for (const int count : {3, 12, 1000}) {
        const Scene scene = two_sided(random_scene(count, 11, place.scale, place.shift));
        const auto oracle = build(scene, {.kind = AccelKind::none});
        const auto tree = build(scene, {.kind = AccelKind::bvh});
        RayBatch rays = eye_rays(scene, if_sanitized(20, 40));
        for (const Light& light : scene.lights) {
          const RayBatch shadow =
              shadow_rays(*oracle, eye_rays(scene, if_sanitized(14, 28)), light.position);
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

// Beams close to vertices and edges of triangles of all shapes, including those that are almost a
// line or a point, in directions with two or three components of the largest magnitude.
TEST(Bvh, BeamsAtTriangleEdgesMatchBruteForceExactly) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto size = [&](float least) { return std::pow(least, unit(rng)); };
  for (const ScaleAndShift& place : kScalesAndShifts) {
    Scene scene;
    scene.materials = {{}};
    for (uint32_t i = 0; i < 100; ++i) {
      const Vec3f middle = random_direction(rng) * unit(rng);
      const Vec3f along = random_direction(rng) * size(1e-4f);
      const Vec3f aside = random_direction(rng) * (length(along) * size(1e-7f));
      for (const Vec3f& corner : {middle - along, middle + along, middle + aside})
        scene.positions.push_back(corner * place.scale + place.shift);
      scene.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
      scene.triangle_materials.push_back(0);
    }
    RayBatch rays;
    for (int beam = 0; beam < 1000; ++beam) {
      const TriangleIndices& t = scene.triangles[rng() % scene.triangles.size()];
      const Vec3f a = scene.positions[t[rng() % 3]], b = scene.positions[t[rng() % 3]];
      const Vec3f at = a + (b - a) * unit(rng);
      Vec3f dir = random_direction(rng);
      if (beam % 2)
        dir[int(rng() % 3)] = std::copysign(max_component(abs(dir)), rng() % 2 ? 1.f : -1.f);
      const Vec3f from = at - dir * (place.scale * 3 * size(1e-3f));
      const float width = size(1e-6f) * length(at - from);
      for (int i = 0; i < 16; ++i) {  // from a point, to a point, side by side
        const Vec3f off = random_direction(rng) * (width * unit(rng));
        const Vec3f origin = beam % 3 ? from + off : from, end = beam % 3 == 1 ? at : at + off;
        const float distance = length(end - origin);
        if (distance > 0)
          rays.push({origin, (end - origin) / distance, beam % 3 == 1 ? distance : 2 * distance});
      }
    }
    const auto oracle = build(scene, {.kind = AccelKind::none});
    const auto tree = build(scene, {.kind = AccelKind::bvh});
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      const Disagreement d = disagreement(*oracle, *tree, rays, true, true);
      EXPECT_EQ(d.closest, 0u) << hwy::TargetName(target) << " scale " << place.scale;
      EXPECT_EQ(d.occluded, 0u) << hwy::TargetName(target) << " scale " << place.scale;
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

TEST(Bvh, BatchesOfAnyLengthAreTracedCompletely) {
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

// A million rays from inside a closed mesh through shared edges of its triangles: none leaks, in a
// beam or singly.
TEST(Bvh, MeshesAreWatertightForCoherentRays) {
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

// Spheres of radii from 1e-4 to 1, in a few dense clusters, one of them a single point, and one
// sphere around all: enough for a plan, and again in the clusters.
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

TEST(Bvh, IsTheSameForAnyNumberOfThreads) {
  for (const Scene& scene : {random_scene(60000, 2), heaps(600000), heaps(1100000)}) {
    const Geometry geometry(scene, scene);
    Bvh one;
    Executor(1).run([&] { one = *build_bvh(geometry); });
    for (const int threads : {2, 7}) {
      Bvh many;
      Executor(threads).run([&] { many = *build_bvh(geometry); });
      EXPECT_EQ(one.reach, many.reach);
      EXPECT_TRUE(same_bytes(one.nodes, many.nodes)) << threads;
      for_each_bounded_kind([&]<PrimitiveKind kind> {
        EXPECT_TRUE(same_bytes(one.of<kind>(), many.of<kind>())) << threads;
      });
    }
  }
}

// Traverses the tree, counts the leaf lanes of each item, and checks that every box contains its
// subtree.
class TreeCheck {
 public:
  TreeCheck(const Geometry& geometry, const Bvh& bvh) : g_(geometry), b_(bvh) {
    if (!b_.nodes.empty()) check(pool_ref(Pool::nodes, 0), Box3f{Vec3f(-kMost), Vec3f(kMost)}, 0);
  }

  std::map<PrimitiveId, int> seen;
  size_t nodes = 0, blocks = 0, outside = 0;
  int levels = 0;

 private:
  static constexpr float kMost = std::numeric_limits<float>::max();

  void check(uint32_t ref, const Box3f& around, int depth) {
    const uint32_t i = ref_index(ref);
    levels = std::max(levels, depth);
    if (ref_pool(ref) != Pool::nodes) {
      ++blocks;
      const PrimitiveId* items = b_.primitives(ref);
      for (int k = 0; k < kBlockWidth; ++k) {
        if (items[k] == kNoPrimitive) continue;
        ++seen[items[k]];
        outside += !holds(around, g_.bounds(items[k]));
        EXPECT_TRUE(k == 0 || items[k - 1] < items[k]);
      }
      return;
    }
    ++nodes;
    const BvhNode& node = b_.nodes[i];
    for (int k = 0; k < kBlockWidth; ++k) {
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

TEST(Bvh, HoldsEveryItemOnceInsideItsBoxes) {
  // Coincident items that no plane can separate: more than a plan needs, and enough for fast mode.
  const auto same = [](size_t count) {
    Scene scene;
    scene.materials = {{}};
    scene.spheres.assign(count, {{0.1f, 0.2f, 0.3f}, 0.25f});
    scene.sphere_materials.assign(count, 0);
    return scene;
  };
  for (const Scene& scene :
       {random_scene(20000, 2), random_scene(20000, 2, 1e-6f), random_scene(5, 1), heaps(300000),
        heaps(1100000), heaps(3), same(300000), same(1100000)}) {
    const Geometry g(scene, scene);
    const Bvh bvh = *build_bvh(g);
    const TreeCheck check(g, bvh);
    EXPECT_EQ(check.outside, 0u);
    EXPECT_EQ(check.nodes, bvh.nodes.size());
    EXPECT_EQ(check.blocks, bvh.count());
    EXPECT_LE(check.levels, kBvhMaxLevels);
    size_t items = 0;
    for_each_bounded_kind([&]<PrimitiveKind kind> { items += g.count(kind); });
    EXPECT_EQ(check.seen.size(), items);
    for (const auto& [item, times] : check.seen) ASSERT_EQ(times, 1) << item;
  }
}

TEST(Bvh, FewOfAKindAreALeafBelowTheRoot) {
  Scene scene = random_scene(4000, 2);
  scene.cones.resize(3);
  scene.cone_materials.resize(3);
  // The first or the last kind.
  scene.ellipsoids = {}, scene.ellipsoid_materials = {}, scene.discs = {},
  scene.disc_materials = {};
  const Geometry g(scene, scene);
  const Bvh bvh = *build_bvh(g);
  EXPECT_EQ(bvh.of<PrimitiveKind::cone>().size(), 1u);
  EXPECT_EQ(std::ranges::count(bvh.nodes[0].child, pool_ref(pool_of(PrimitiveKind::cone), 0)), 1);
  EXPECT_EQ(std::ranges::count(bvh.shared, pool_ref(pool_of(PrimitiveKind::cone), 0)), 1);
}

// The float test before the double one drops no hit: rays near the surface of cylinders and cones,
// thick and thin, short and very long, from near and far, a few roundings inside or outside.
TEST(Bvh, GrazingRaysHitConesLikeBruteForce) {
  Scene scene;
  scene.materials = {{}};
  std::mt19937 rng(11);
  const auto in = [&](float lo, float hi) {
    return std::uniform_real_distribution<float>(lo, hi)(rng);
  };
  const auto point = [&](float size) {
    const float x = in(-size, size), y = in(-size, size), z = in(-size, size);
    return Vec3f(x, y, z);
  };
  RayBatch rays;
  for (int i = 0; i < 500; ++i) {
    const Vec3f base = point(10), along = point(i % 5 ? 3.0f : 3e12f);
    const float radius = std::pow(10.0f, in(-4, 0.5f));
    const float top = i % 2 ? radius : radius * in(0, 1);
    scene.cones.push_back({base, radius, base + along, top});
    scene.cone_materials.push_back(0);
    for (int k = 0; k < 20; ++k) {
      const Vec3f from = base + point(k % 2 ? 30.0f : 3000.0f);
      const float height = in(0, 1);
      const Vec3f on_axis = base + along * height;
      const Vec3f aside = normalize(cross(along, on_axis - from));
      const float reach = (radius + (top - radius) * height) * (1 + in(-4e-7f, 4e-7f));
      const Vec3f dir = normalize(on_axis + aside * reach - from);
      rays.push({from, dir, std::numeric_limits<float>::infinity()});
    }
  }
  const auto oracle = build(scene, {.kind = AccelKind::none});
  const auto bvh = build(scene, {.kind = AccelKind::bvh});
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    const Disagreement d = disagreement(*oracle, *bvh, rays, true, false);
    EXPECT_EQ(d.closest, 0u) << hwy::TargetName(target);
    EXPECT_EQ(d.occluded, 0u) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

TEST(Bvh, RefusesScenesBeyondMemory) {
  const Scene scene = random_scene(4000, 2);
  const Geometry geometry(scene, scene);
  const auto bvh = build_bvh(geometry, {1000, "the limit of a test"});
  ASSERT_FALSE(bvh.has_value());
  EXPECT_NE(bvh.error().find("0.0 GB of memory are free within the limit of a test"),
            std::string::npos)
      << bvh.error();
  EXPECT_EQ(bvh.error().find('\n'), std::string::npos);
}

// Triangles, cones and spheres that no plane can part.
TEST(Bvh, SurvivesCoincidentPrimitives) {
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

}  // namespace
}  // namespace raio::core
