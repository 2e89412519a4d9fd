// Instances: against brute force over all instances, against flattened primitives, and against
// ellipsoids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "accel/primitive_numbers.h"
#include "accel_rays.h"
#include "integrate/film.h"
#include "integrate/surface.h"
#include "one_picture.h"
#include "rich_scene.h"
#include "sanitized.h"
#include "scenes.h"

namespace raio::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::awkward_rays;
using tests::build;
using tests::disagreement;
using tests::expect_one_picture;
using tests::eye_rays;
using tests::if_sanitized;
using tests::picture_of;
using tests::random_direction;
using tests::random_scene;
using tests::two_sided;

// A turn and a shift; with `stretch` above 1 also axes of other lengths, mirrored or sheared.
Matrix random_matrix(std::mt19937& rng, float stretch = 1, bool mirrored = false) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const Frame<float> frame(random_direction(rng));
  const Vec3f axes[3] = {frame.u, frame.v, cross(frame.u, frame.v)};
  const float turn = 3 * unit(rng), size = 0.4f + 0.2f * unit(rng);
  Matrix m;
  for (size_t i = 0; i < 3; ++i) {
    const int a = int(i);
    const Vec3f row(std::cos(turn) * axes[0][a] - std::sin(turn) * axes[1][a],
                    std::sin(turn) * axes[0][a] + std::cos(turn) * axes[1][a], axes[2][a]);
    m[4 * i] = size * row.x * (mirrored ? -1 : 1), m[4 * i + 1] = size * row.y;
    m[4 * i + 2] = size * stretch * (row.z + (stretch - 1) * row.x);
    m[4 * i + 3] = 1.2f * unit(rng);
  }
  return m;
}

Scene object_of(uint32_t seed, int count = 40) {
  Scene object = two_sided(random_scene(count, seed));
  object.planes = {}, object.plane_materials = {};
  object.polygons.pop_back(), object.polygon_materials.pop_back();  // the floor
  return object;
}

// Primitives, instances of two objects and of one that consists of instances.
Scene copied_scene(uint32_t seed, bool evenly = false) {
  std::mt19937 rng(seed);
  Scene scene = object_of(seed, 60);
  scene.prototypes = {object_of(seed + 1), object_of(seed + 2, 12), object_of(seed + 3, 4)};
  Object& nested = scene.prototypes[2];
  nested.prototypes = {object_of(seed + 4, 8)};
  const auto matrix = [&](int i) {
    return random_matrix(rng, evenly ? 1 : 1 + 0.3f * float(i % 3), i % 2 == 1);
  };
  for (int i = 0; i < 3; ++i) nested.instances.push_back({0, matrix(i)});
  for (int i = 0; i < 11; ++i) scene.instances.push_back({uint32_t(i % 3), matrix(i)});
  return scene;
}

// Some of it transparent: parts of the objects and of the scene's own primitives.
Scene transparent_instances(uint32_t seed, bool evenly = false) {
  Scene scene = copied_scene(seed, evenly);
  scene.prototypes[0].sphere_opacity.assign(scene.prototypes[0].spheres.size(), 0.4f);
  scene.prototypes[0].sphere_opacity[1] = 1;
  scene.prototypes[2].prototypes[0].triangle_opacity.assign(2, 0.5f);
  scene.cone_opacity.assign(scene.cones.size(), 0.3f);
  return scene;
}

TEST(Instances, AllStructuresAgree) {
  for (const uint32_t seed : {1u, 2u, 3u, 4u})
    for (const bool clear : {false, true}) {
      const Scene scene = clear ? transparent_instances(seed) : copied_scene(seed);
      ASSERT_THAT(validate(scene), IsEmpty());
      const auto none = build(scene, {.kind = AccelKind::none});
      const RayBatch rays = awkward_rays(scene, if_sanitized(1000, 5000), seed),
                     eyes = eye_rays(scene, if_sanitized(32, 64));
      const auto all = tests::answers(*none, rays), seen = tests::answers(*none, eyes);
      size_t hits = 0, of_copies = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        hits += all.closest[i].found();
        of_copies += all.closest[i].found() && all.closest.instance[i] != 0;
      }
      EXPECT_GT(hits, rays.size() / 10);
      EXPECT_GT(of_copies, rays.size() / 20);
      for (const AccelOptions& options :
           {AccelOptions{.kind = AccelKind::grid}, AccelOptions{.kind = AccelKind::bvh},
            AccelOptions{.kind = AccelKind::grid, .counters = true}}) {
        const auto accel = build(scene, options);
        const auto d = disagreement(all, *accel, rays, true);
        EXPECT_EQ(d.closest + d.occluded, 0u) << seed << ' ' << accel_name(options.kind);
        const auto e = disagreement(seen, *accel, eyes, true, true);
        EXPECT_EQ(e.closest + e.occluded, 0u) << seed << ' ' << accel_name(options.kind);
        EXPECT_EQ(accel->info().instances, 11u);
        EXPECT_GT(accel->info().bytes, build(scene, {.kind = AccelKind::none})->info().bytes);
      }
    }
}

TEST(Instances, TransparentHitsComeInOrder) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = transparent_instances(seed);
    const auto none = build(scene, {.kind = AccelKind::none});
    const auto tree = build(scene, {.kind = AccelKind::bvh});
    const RayBatch rays = awkward_rays(scene, 2000, seed);
    HitBatch after, first, second;
    after.reset(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) after.set(i, {.t = 0, .primitive = 0});
    TraceContext context;
    std::vector<uint32_t> sums(rays.size());
    size_t layers = 0, found = 1;
    for (; found > 0 && layers < 100; ++layers) {
      none->next_transparent(rays, after, first, context);
      tree->next_transparent(rays, after, second, context);
      found = 0;
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(first[i].primitive, second[i].primitive) << layers << ' ' << i;
        ASSERT_EQ(first[i].instance, second[i].instance) << layers << ' ' << i;
        if (!first[i].found()) {
          after.set(i, {.t = std::numeric_limits<float>::infinity(), .primitive = 0});
          continue;
        }
        ASSERT_EQ(first.t[i], second.t[i]);
        ASSERT_TRUE(comes_before(after[i], first[i]));
        sums[i] = std::min(
            sums[i] + none->geometry().object_at(first.instance[i]).depth_of(first.primitive[i]),
            kMaxOpticalDepth);
        after.set(i, first[i]);
        ++found;
      }
    }
    EXPECT_GT(layers, 2u);
    DepthBatch a, b;
    a.reset(rays.size()), b.reset(rays.size());
    none->transparent_depths(rays, a, context);
    tree->transparent_depths(rays, b, context);
    for (size_t i = 0; i < rays.size(); ++i) {
      EXPECT_EQ(a.sum[i], b.sum[i]);
      EXPECT_EQ(a.sum[i], sums[i]);
    }
  }
}

// Positions that differ in the object may coincide outside of it.
TEST(Instances, CoincidentTransparentFacesAreAllHit) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<float> unit(-1, 1);
  Scene object, scene;
  object.materials = scene.materials = {Material()};
  for (int i = 0; i < 40; ++i) {
    const auto first = uint32_t(object.positions.size());
    for (int k = 0; k < 3; ++k) object.positions.push_back({unit(rng), unit(rng), unit(rng)});
    for (const TriangleIndices& t : {TriangleIndices{0, 1, 2}, {1, 0, 2}, {2, 0, 1}, {2, 1, 0}})
      object.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  object.triangle_materials.assign(object.triangles.size(), 0);
  object.triangle_opacity.assign(object.triangles.size(), 0.01f);
  scene.prototypes = {object};
  for (int i = 0; i < 12; ++i)
    scene.instances.push_back({0, random_matrix(rng, 1 + 0.2f * float(i % 3))});
  const auto tree = build(scene, {.kind = AccelKind::bvh});
  const RayBatch rays = awkward_rays(scene, 4000, 7);
  HitBatch after, next;
  after.reset(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) after.set(i, {.t = 0, .primitive = 0});
  TraceContext context;
  std::vector<uint32_t> sums(rays.size());
  DepthBatch depths;
  depths.reset(rays.size());
  for (size_t found = 1, layers = 0; found > 0 && layers < 3000; ++layers) {
    tree->next_transparent(rays, after, next, context);
    found = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      if (!next[i].found()) {
        after.set(i, {.t = std::numeric_limits<float>::infinity(), .primitive = 0});
        continue;
      }
      sums[i] = std::min(
          sums[i] + tree->geometry().object_at(next.instance[i]).depth_of(next.primitive[i]),
          kMaxOpticalDepth);
      after.set(i, next[i]);
      ++found;
    }
  }
  tree->transparent_depths(rays, depths, context);
  for (size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(sums[i], depths.sum[i]) << i;
}

TEST(Instances, APictureIsOne) {
  RenderOptions options;
  options.width = if_sanitized(24, 48), options.height = if_sanitized(18, 36);
  options.aa = 2, options.soft_shadows = true;
  expect_one_picture(transparent_instances(5), options);
  options.look = FigureStyle::paper_1;
  options.outline = 1.0f;
  expect_one_picture(transparent_instances(6), options);
  Scene only = transparent_instances(7);  // without primitives of its own
  Scene scene;
  scene.camera = only.camera, scene.lights = only.lights, scene.materials = only.materials;
  scene.prototypes = only.prototypes, scene.instances = only.instances;
  expect_one_picture(scene, options);
}

// Up to rounding: a grazing ray may miss the other shape.
TEST(Instances, InstancesRenderLikeFlattenedPrimitives) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    const Scene scene = transparent_instances(seed, true);
    Scene flat = scene;
    ASSERT_EQ(flatten_instances(flat), "");
    EXPECT_THAT(validate(flat), IsEmpty());
    EXPECT_TRUE(flat.instances.empty() && flat.prototypes.empty());
    EXPECT_EQ(count_primitives(flat), count_primitives(scene));
    EXPECT_EQ(flat.primitive_count(), scene.primitive_count());
    EXPECT_GT(memory_bytes(flat), memory_bytes(scene));
    const Box3f a = bounds(flat), b = bounds(scene);
    // A part of a rotated box around a cone or an ellipsoid is empty.
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(b.lo[axis], a.lo[axis] + 1e-5f);
      EXPECT_GE(b.hi[axis], a.hi[axis] - 1e-5f);
      EXPECT_LE(b.size()[axis], 1.2f * a.size()[axis]);
    }

    const auto copies = build(scene, {.kind = AccelKind::bvh}),
               primitives = build(flat, {.kind = AccelKind::bvh});
    const RayBatch rays = awkward_rays(flat, 5000, seed);
    const auto x = tests::answers(*copies, rays), y = tests::answers(*primitives, rays);
    size_t other = 0, normals = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      const Hit p = x.closest[i], q = y.closest[i];
      if (p.found() != q.found() || (p.found() && std::abs(p.t - q.t) > 1e-4f * p.t)) {
        ++other;
        continue;
      }
      if (!p.found()) continue;
      const Surface s = surface_at(copies->geometry(), rays[i], p),
                    t = surface_at(primitives->geometry(), rays[i], q);
      EXPECT_EQ(s.material, t.material);
      EXPECT_NEAR(length(s.point - t.point), 0, 2e-4f * (1 + p.t));
      normals += dot(s.normal, t.normal) < 0.999f;
    }
    EXPECT_LE(other, 10u);
    EXPECT_LE(normals, 10u);

    RenderOptions options;
    options.width = 64, options.height = 48;
    options.look = FigureStyle::paper_1;
    const Image from_copies = picture_of(scene, options), from_flat = picture_of(flat, options);
    size_t different = 0;
    for (size_t i = 0; i < from_flat.pixels.size(); ++i)
      different += max_component(abs(from_flat.pixels[i] - from_copies.pixels[i])) > 0.02f;
    EXPECT_LE(different, from_flat.pixels.size() / 50);
  }
}

// A stretched ball is an ellipsoid with known formulas.
TEST(Instances, AStretchedBallIsAnEllipsoid) {
  std::mt19937 rng(3);
  for (int k = 0; k < 10; ++k) {
    const Matrix m = random_matrix(rng, 1.5f, k % 2 == 1);
    const Placement place(m);
    Scene scene = random_scene(4, 1);
    for_each_pool([&](auto pool) { (scene.*pool.shapes) = {}, (scene.*pool.materials) = {}; });
    scene.prototypes = {scene};
    scene.prototypes[0].spheres = {{{0.1f, 0.2f, -0.1f}, 0.5f}};
    scene.prototypes[0].sphere_materials = {0};
    scene.instances = {{0, m}};
    Scene same = scene;
    same.prototypes = {}, same.instances = {};
    // Axes that are at right angles, by turning those of the ball (Jacobi).
    Vec3d axes[3] = {{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}};
    for (Vec3d& axis : axes) axis = place.vector(axis);
    for (int turns = 0; turns < 30; ++turns)
      for (const auto& [i, j] : {std::pair(0, 1), {0, 2}, {1, 2}}) {
        Vec3d &p = axes[i], &q = axes[j];
        const double angle = std::atan2(2 * dot(p, q), dot(p, p) - dot(q, q)) / 2;
        const Vec3d turned = p * std::cos(angle) + q * std::sin(angle);
        q = q * std::cos(angle) - p * std::sin(angle), p = turned;
      }
    same.ellipsoids = {{Vec3f(place.point(Vec3d(0.1, 0.2, -0.1))),
                        {Vec3f(axes[0]), Vec3f(axes[1]), Vec3f(axes[2])}}};
    same.ellipsoid_materials = {0};
    ASSERT_THAT(validate(same), IsEmpty());
    RenderOptions options;
    options.width = options.height = 64;
    options.view = View::normals;
    const Image a = expect_one_picture(scene, options), b = picture_of(same, options);
    size_t different = 0, seen = 0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
      different += max_component(abs(a.pixels[i] - b.pixels[i])) > 0.01f;
      seen += max_component(abs(b.pixels[i] - b.pixels[0])) > 0.01f;
    }
    EXPECT_GT(seen, 10u);
    EXPECT_LE(different, 4u) << k;
    std::string error = flatten_instances(scene);
    EXPECT_THAT(error, HasSubstr("instances of spheres have a non-uniform scale"));
  }
}

// Calls f(object, id, instance) for all primitives of instances, those within instances included.
void for_each_instanced(const Geometry& geometry, auto&& f, InstanceId around = 0) {
  for (uint32_t i = 0; i < geometry.object().instances.size(); ++i) {
    const Geometry& object = geometry.placed(geometry.instance_id(i)).object;
    for_each_kind([&]<PrimitiveKind kind> {
      for (uint32_t k = 0; k < object.count(kind); ++k)
        f(object, object.id_of(kind, k), around + geometry.instance_id(i));
    });
    if (object.has_instances()) for_each_instanced(object, f, around + geometry.instance_id(i));
  }
}

TEST(Instances, HaveDistinctIds) {
  for (const bool nested : {false, true}) {
    const Scene scene = nested ? tests::nested_scene() : copied_scene(1);
    const auto accel = build(scene, {.kind = AccelKind::bvh});
    const Geometry& geometry = accel->geometry();
    const PrimitiveNumbers numbers(geometry);
    std::set<uint64_t> seen;
    std::set<InstanceId> instances;
    for_each_kind([&]<PrimitiveKind kind> {
      for (uint32_t i = 0; i < geometry.count(kind); ++i) {
        const PrimitiveId id = geometry.id_of(kind, i);
        EXPECT_EQ(geometry.kind_of(id), kind);
        EXPECT_EQ(geometry.index_of(id), i);
        seen.insert(numbers.number(id, 0));
      }
    });
    for_each_instanced(geometry, [&](const Geometry& object, PrimitiveId id, InstanceId instance) {
      ASSERT_LE(instance, geometry.count_instances());
      instances.insert(instance);
      EXPECT_EQ(&geometry.object_at(instance), &object);
      EXPECT_EQ(geometry.material_of(id, instance), object.material_of(id));
      const Hit hit{1, id, 0, 0, instance};
      EXPECT_TRUE(geometry.same_object(hit, hit));
      seen.insert(numbers.number(id, instance));
    });
    // Some objects have instances only.
    EXPECT_LE(instances.size(), geometry.count_instances());
    EXPECT_EQ(instances.size() < geometry.count_instances(), nested);
    // 1, 2, ... without a gap.
    EXPECT_EQ(seen.size(), numbers.count());
    EXPECT_EQ(*seen.begin(), 1u);
    EXPECT_EQ(*seen.rbegin(), numbers.count());
    // Polygons count as their triangles.
    EXPECT_GE(numbers.count(), scene.primitive_count());
  }
}

// 60,000 instances of 10,000 triangles: more than fit where an id has a few bits for the kind.
TEST(Instances, MayShowMorePrimitivesThanOneObjectHolds) {
  constexpr uint32_t kSide = 100, kInstances = 60'000, kRow = 300;
  Scene scene;
  scene.materials.emplace_back();
  Scene object;
  object.materials = scene.materials;
  // Triangles side by side in the plane z = 0, each in a cell of size 1 / kSide.
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const float x = float(i % kSide) / kSide, y = float(i / kSide) / kSide, e = 1.0f / kSide;
    const auto first = uint32_t(object.positions.size());
    for (const Vec3f corner : {Vec3f(x, y, 0), Vec3f(x + e, y, 0), Vec3f(x, y + e, 0)})
      object.positions.push_back(corner);
    object.triangles.push_back({first, first + 1, first + 2});
    object.triangle_materials.push_back(0);
  }
  scene.prototypes.push_back(object);
  for (uint32_t i = 0; i < kInstances; ++i)
    scene.instances.push_back(
        {0, {1, 0, 0, float(i % kRow), 0, 1, 0, float(i / kRow), 0, 0, 1, 0}});
  ASSERT_THAT(validate(scene), IsEmpty());
  const auto accel = build(scene, {.kind = AccelKind::bvh});
  const PrimitiveNumbers numbers(accel->geometry());
  EXPECT_EQ(numbers.count(), uint64_t(kInstances) * kSide * kSide);
  RayBatch rays;
  for (const uint32_t i : {0u, 53'687u, 53'688u, kInstances - 1})
    rays.push({{float(i % kRow) + 0.993f, float(i / kRow) + 0.992f, 5}, {0, 0, -1}});
  HitBatch hits;
  hits.reset(rays.size());
  TraceContext context;
  accel->closest(rays, hits, context);
  size_t k = 0;
  for (const uint32_t i : {0u, 53'687u, 53'688u, kInstances - 1}) {
    const Hit hit = hits[k++];
    ASSERT_TRUE(hit.found());
    EXPECT_EQ(hit.t, 5);
    EXPECT_EQ(accel->geometry().placed(hit.instance).index, i);
    EXPECT_EQ(hit.primitive, kSide * kSide - 1);
    EXPECT_EQ(numbers.number(hit.primitive, hit.instance), uint64_t(i + 1) * kSide * kSide);
  }

  // The channel `id` has 32 bits.
  RenderOptions options;
  options.channels.add(Channel::id);
  EXPECT_FALSE(option_conflict(options, &scene));
  scene.instances.resize(430'000);
  const auto why = option_conflict(options, &scene);
  ASSERT_TRUE(why);
  EXPECT_THAT(why->text(), HasSubstr("more primitives than id can number"));
}

// An instance's own object takes precedence over those within; instances and flattened primitives
// agree.
TEST(Instances, InstancesBelongToObjects) {
  Scene scene = tests::nested_scene();
  for (auto* some : {&scene.prototypes[1].instances[1].matrix}) *some = kIdentity;
  const auto accel = build(scene, {.kind = AccelKind::bvh});
  const Geometry& geometry = accel->geometry();
  std::vector<Hit> spheres;
  for_each_instanced(geometry, [&](const Geometry& object, PrimitiveId id, InstanceId instance) {
    if (object.kind_of(id) == PrimitiveKind::sphere) spheres.push_back({1, id, 0, 0, instance});
  });
  const auto sphere = [&](uint32_t i) { return spheres.at(i); };
  // Two of the first instance, four of each of the others.
  const uint32_t objects[] = {2, 0, 1, 1, 1, 1, 1, 1, 1, 1};
  for (uint32_t i = 0; i < std::size(objects); ++i)
    EXPECT_EQ(geometry.object_of(sphere(i).primitive, sphere(i).instance), objects[i]) << i;
  EXPECT_TRUE(geometry.same_object(sphere(2), sphere(9)));  // of a range of instances
  EXPECT_FALSE(geometry.same_object(sphere(0), sphere(1)));
  EXPECT_FALSE(geometry.same_object(sphere(1), sphere(2)));
  Scene flat = scene;
  ASSERT_EQ(flatten_instances(flat), "");
  ASSERT_THAT(validate(flat), IsEmpty());
  for (uint32_t i = 0; i < std::size(objects); ++i)
    EXPECT_EQ(core::object_of(flat, PoolKind::sphere, scene.spheres.size() + i), objects[i]) << i;

  // Otherwise the object is the prototype's, distinct in each instance.
  scene.object_ranges = {};
  const auto others = build(scene, {.kind = AccelKind::bvh});
  const Geometry& there = others->geometry();
  EXPECT_EQ(there.object_of(sphere(2).primitive, sphere(2).instance), 2u);
  EXPECT_EQ(there.object_of(sphere(4).primitive, sphere(4).instance), 2u);
  EXPECT_TRUE(there.same_object(sphere(2), sphere(2)));
  EXPECT_FALSE(there.same_object(sphere(2), sphere(4)));  // nested instances
  EXPECT_FALSE(there.same_object(sphere(2), sphere(6)));
  EXPECT_TRUE(there.same_object(sphere(3), sphere(7)));  // in no object
}

// Two balls that hardly stand out from each other have a line between them if they are two objects.
TEST(Instances, OutlinesSeparateInstances) {
  const auto lines = [](bool objects, bool copies_apart) {
    Scene scene;
    scene.dialect = Dialect::data;
    scene.background = Rgb(1);
    scene.materials.emplace_back();
    scene.camera.from = {0, 0, 9};
    Scene object = scene;
    object.spheres = {{{0, 0, 0}, 1}}, object.sphere_materials = {0};
    if (objects) object.object_ranges = {{PoolKind::sphere, 0, 1, 1}};
    scene.object_names = {"ball", "left", "right"};
    scene.prototypes = {object};
    scene.instances = {{0, kIdentity}, {0, {1, 0, 0, 0.1f, 0, 1, 0, 0, 0, 0, 1, 0}}};
    if (copies_apart)
      scene.object_ranges = {{PoolKind::instance, 0, 1, 2}, {PoolKind::instance, 1, 1, 3}};
    EXPECT_THAT(validate(scene), IsEmpty());
    RenderOptions options;
    options.width = options.height = 120, options.outline = 2;
    const Image picture = picture_of(scene, options);
    size_t dark = 0;
    for (int y = 55; y < 65; ++y)
      for (int x = 50; x < 70; ++x) dark += max_component(picture.at(x, y)) < 0.05f;
    return dark;
  };
  EXPECT_EQ(lines(false, false), 0u);
  EXPECT_GT(lines(true, false), 5u);
  EXPECT_GT(lines(false, true), 5u);
}

// With shapes that can be flattened: the front is the image of the front.
TEST(Instances, MirroredFrontsStayFronts) {
  Scene scene = random_scene(4, 1);
  for_each_pool([&](auto pool) { (scene.*pool.shapes) = {}, (scene.*pool.materials) = {}; });
  scene.materials[0].transmission = 0;
  scene.positions = {};
  Scene object = scene;
  object.positions = {{-1, -1, 0}, {0, -1, 0}, {0, 1, 0}, {0, -1, 0},
                      {1, -1, 0},  {1, 1, 0},  {0, 1, 0}};
  object.triangles = {{0, 1, 2}}, object.triangle_materials = {0};
  object.normals = {{0, 0, 1}, {0, 0.6f, 0.8f}};
  object.triangle_normals = {{0, 1, 0}};
  object.polygons = {{3, 4}}, object.polygon_materials = {0};
  Mesh mesh;
  mesh.positions = {{-1, 1, 0}, {-1, -1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}}, mesh.materials = {0};
  mesh.normals = {{0, 0, 1}}, mesh.normal_indices = {{0, 0, 0}};
  object.meshes = {mesh};
  scene.prototypes = {object};
  for (const Matrix& m : {kIdentity, Matrix{-1, 0, 0, 0.1f, 0, 1, 0, 0, 0, 0, 1, 0},
                          Matrix{1, 0.5f, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0.2f}}) {
    scene.instances = {{0, m}};
    Scene flat = scene;
    ASSERT_EQ(flatten_instances(flat), "");
    const auto copies = build(scene, {.kind = AccelKind::bvh}, true);
    const auto primitives = build(flat, {.kind = AccelKind::bvh}, true);
    size_t fronts = 0;
    for (const float z : {-3.0f, 3.0f})
      for (float y = -0.9f; y < 1; y += 0.171f)
        for (float x = -0.9f; x < 1; x += 0.137f) {
          RayBatch rays;
          rays.push({{x, y, z}, {0, 0, z > 0 ? -1.0f : 1.0f}});
          const auto a = tests::answers(*copies, rays), b = tests::answers(*primitives, rays);
          ASSERT_EQ(a.closest[0].found(), b.closest[0].found()) << x << ' ' << y << ' ' << z;
          if (!a.closest[0].found()) continue;
          ++fronts;
          const Surface s = surface_at(copies->geometry(), rays[0], a.closest[0]),
                        t = surface_at(primitives->geometry(), rays[0], b.closest[0]);
          EXPECT_NEAR(length(s.normal - t.normal), 0, 1e-5f);
        }
    EXPECT_GT(fronts, 80u);
  }
}

TEST(Instances, ColoursOfInstancesAreFlattened) {
  Scene scene = random_scene(4, 1);
  for_each_pool([&](auto pool) { (scene.*pool.shapes) = {}, (scene.*pool.materials) = {}; });
  scene.material_opacity = std::vector<float>{0.5f, 1, 1};
  Scene object = scene;
  scene.spheres = {{{0, 0, 0}, 1}}, scene.sphere_materials = {0};
  object.spheres = {{{0, 0, 3}, 1}, {{0, 0, 6}, 1}}, object.sphere_materials = {1, 0};
  object.sphere_colors = {Rgb(0.25f), Rgb(0.75f)};
  object.sphere_opacity = {0.125f, 1};
  scene.prototypes = {object};
  scene.instances = {{0, kIdentity}};
  ASSERT_EQ(flatten_instances(scene), "");
  EXPECT_THAT(std::vector<Rgb>(scene.sphere_colors.begin(), scene.sphere_colors.end()),
              ElementsAre(scene.materials[0].color, Rgb(0.25f), Rgb(0.75f)));
  EXPECT_THAT(std::vector<float>(scene.sphere_opacity.begin(), scene.sphere_opacity.end()),
              ElementsAre(0.5f, 0.125f, 1));
}

TEST(Instances, EachFaultIsNamed) {
  const struct {
    void (*make)(Scene&);
    const char* sentence;
  } faults[] = {
      {[](Scene& s) { s.instances[1].prototype = 3; }, "instance 1: prototype 3 of 3"},
      {[](Scene& s) { s.instances[1].matrix[3] = NAN; },
       "instance 1: the matrix must be finite and have an inverse"},
      {[](Scene& s) { s.instances[0].matrix = {1, 0, 0, 0, 2, 0, 0, 0, 0, 0, 1, 0}; },
       "instance 0: the matrix must be finite and have an inverse"},
      {[](Scene& s) {
         s.prototypes[1].planes = {{{0, 0, 0}, {0, 0, 1}}}, s.prototypes[1].plane_materials = {0};
       },
       "prototype 1: an infinite plane cannot be instanced"},
      {[](Scene& s) {
         s.prototypes[1].moving_spheres = {{{0, 0, 0}, {1, 0, 0}, 1, 0, 1}};
         s.prototypes[1].moving_sphere_materials = {0};
       },
       "prototype 1: moving primitives cannot be instanced"},
      {[](Scene& s) { s.prototypes[1].object_ranges = {{PoolKind::sphere, 0, 1, 1}}; },
       "prototype 1: object range 0: object 1 of 0"},
      {[](Scene& s) { s.object_names = {"x"}, s.object_ranges = {{PoolKind::instance, 5, 7, 1}}; },
       "object range 0: elements up to 12 of 11"},
      {[](Scene& s) { s.prototypes[2].prototypes[0].spheres[0].radius = 0; },
       "prototype 2: prototype 0: sphere 0: the radius must be finite and not zero"},
  };
  for (const auto& fault : faults) {
    Scene scene = copied_scene(1);
    ASSERT_THAT(validate(scene), IsEmpty());
    fault.make(scene);
    const auto problems = validate(scene);
    ASSERT_FALSE(problems.empty());
    EXPECT_EQ(problems.front(), fault.sentence);
  }
}

TEST(Instances, AreContent) {
  const Scene scene = copied_scene(1);
  Scene other = scene;
  EXPECT_EQ(content_hash(other), content_hash(scene));
  other.instances[4].matrix[3] += 1;
  EXPECT_NE(content_hash(other), content_hash(scene));
  other = scene;
  other.prototypes[2].prototypes[0].spheres[0].radius *= 2;
  EXPECT_NE(content_hash(other), content_hash(scene));
}

TEST(Instances, NonUniformInstancesOfRoundShapesAreNotFlattened) {
  const auto error = [](auto&& add) {
    Scene scene = random_scene(4, 1);
    for_each_pool([&](auto pool) { (scene.*pool.shapes) = {}, (scene.*pool.materials) = {}; });
    Scene object = scene;
    add(object);
    for_each_pool(
        [&](auto pool) { (object.*pool.materials).assign((object.*pool.shapes).size(), 0); });
    scene.prototypes = {object};
    scene.instances = {{0, {1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1, 0}}};
    return flatten_instances(scene);
  };
  EXPECT_THAT(error([](Scene& s) { s.cones = {{{0, 0, 0}, 1, {0, 0, 1}, 1}}; }),
              HasSubstr("cones have a non-uniform scale"));
  EXPECT_THAT(error([](Scene& s) { s.discs = {{{0, 0, 0}, {0, 0, 1}, 1, 0}}; }),
              HasSubstr("discs have a non-uniform scale"));
  EXPECT_THAT(
      error([](Scene& s) { s.ellipsoids = {{{0, 0, 0}, {{2, 0, 0}, {0, 1, 0}, {0, 0, 0.5f}}}}; }),
      HasSubstr("ellipsoids have a non-uniform scale"));
}

}  // namespace
}  // namespace raio::core
