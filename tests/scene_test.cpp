#include "scene/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <set>

#include "io/nff/nff.h"
#include "rich_scene.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

using tests::random_scene;
using tests::rich_scene;

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// One of each kind, all sound.
Scene sample() {
  Scene scene;
  scene.materials.emplace_back();
  scene.lights.push_back({{1, 2, 3}, {}});
  scene.planes.push_back({{0, 0, -100}, {0, 0, 1}});
  scene.plane_materials.push_back(0);
  scene.spheres.push_back({{1, 0, 0}, -2});
  scene.sphere_materials.push_back(0);
  scene.cones.push_back({{0, 0, 0}, 1, {0, 0, 5}, 1});
  scene.cones.push_back({{0, 0, 0}, 1, {0, 0, 5}, 0.5f});
  scene.cone_materials.assign(2, 0);
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {9, 0, 0}, {9, 1, 0}, {0, 1, 0}};
  scene.positions.push_back({50, 50, 50});  // of nothing
  scene.normals = {{0, 0, 1}};
  scene.triangles = {{0, 1, 2}, {2, 1, 0}};
  scene.triangle_normals = {{0, 0, 0}, {kNoNormal, kNoNormal, kNoNormal}};
  scene.triangle_materials.assign(2, 0);
  scene.polygons = {{3, 4}};
  scene.polygon_materials.push_back(0);
  return scene;
}

TEST(Scene, CountsByKind) {
  EXPECT_THAT(count_primitives(sample()), ElementsAre(1, 1, 2, 1, 1, 1, 0, 0));
  EXPECT_EQ(sample().primitive_count(), 7u);
}

TEST(Scene, BoundsCoverFinitePrimitives) {
  const Box3f box = bounds(sample());
  // Of the sphere, the polygon and the cones; their box is rounded outwards.
  EXPECT_NEAR(box.lo.x, -1, 1e-6);
  EXPECT_EQ(box.lo.y, -2);
  EXPECT_EQ(box.lo.z, -2);
  EXPECT_EQ(box.hi.x, 9);
  EXPECT_EQ(box.hi.y, 2);
  EXPECT_NEAR(box.hi.z, 5, 1e-5);
  Scene planes;
  planes.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  EXPECT_TRUE(bounds(planes).empty());
}

TEST(Scene, MemoryIsTheSumOfThePools) {
  Scene scene;
  EXPECT_EQ(memory_bytes(scene), 0u);
  scene.spheres.resize(10);
  scene.sphere_materials.resize(10);
  EXPECT_EQ(memory_bytes(scene), 10 * sizeof(Sphere) + 10 * sizeof(MaterialId));
  scene.positions.resize(3);
  EXPECT_EQ(memory_bytes(scene), 10 * sizeof(Sphere) + 10 * sizeof(MaterialId) + 3 * sizeof(Vec3f));
}

TEST(Scene, MeshesCount) {
  Scene scene;
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {0, 5, 0}, {9, 9, 9}};
  mesh.triangles = {{0, 1, 2}};
  mesh.uv.resize(4);
  scene.meshes.assign(2, mesh);
  EXPECT_EQ(count_primitives(scene)[size_t(ShapeKind::triangle)], 2u);
  EXPECT_EQ(scene.primitive_count(), 2u);
  EXPECT_EQ(bounds(scene).hi, Vec3f(4, 5, 0));
  EXPECT_EQ(memory_bytes(scene),
            2 * (4 * sizeof(Vec3f) + sizeof(TriangleIndices) + 4 * sizeof(Uv)));
}

TEST(Scene, HashesOfOldScenesAreUnchanged) {
  const auto shapes = read_nff(RAIO_SOURCE_DIR "/scenes/shapes.nff");
  ASSERT_TRUE(shapes);
  // As stored by version 0.1.0 in pictures and part files.
  EXPECT_EQ(content_hash(shapes->scene), "7d190ddae635c66dfc3813176e6fac8d");
}

/// The bytes of column number `number`, counted by the visitor.
std::span<char> column_bytes(Scene& scene, size_t number) {
  std::span<char> bytes;
  for_each_column(scene, [&](ColumnName, auto& column) {
    if (number-- == 0)
      bytes = {reinterpret_cast<char*>(column.data()), column.size() * sizeof(column[0])};
  });
  return bytes;
}

TEST(Scene, EveryNumberOfEveryColumnIsHashed) {
  const Scene scene = rich_scene();
  EXPECT_THAT(validate(scene), IsEmpty());
  std::set<std::string> names = {content_hash(scene)};
  size_t columns = 0, numbers = 0;
  for_each_column(scene, [&](ColumnName, auto&) { ++columns; });
  for (size_t c = 0; c < columns; ++c) {
    Scene size_only = scene;
    const size_t bytes = column_bytes(size_only, c).size();
    for (size_t at = 0; at < bytes; at += 4) {
      Scene changed = scene;
      column_bytes(changed, c)[at] ^= 1;
      names.insert(content_hash(changed));
      ++numbers;
    }
  }
  EXPECT_GT(numbers, 500u);
  EXPECT_EQ(names.size(), numbers + 1);
}

TEST(Scene, ColumnsHaveDistinctNames) {
  Scene scene;
  scene.meshes.resize(1);
  std::set<std::string_view> names;
  size_t columns = 0;
  for_each_column(scene, [&](ColumnName column, auto&) {
    names.insert(column.name);
    ++columns;
  });
  EXPECT_EQ(names.size(), columns);
}

TEST(Scene, ObjectsAreFoundByTheirRanges) {
  const Scene s = rich_scene();
  for (size_t i = 0; i < s.spheres.size(); ++i)
    EXPECT_EQ(object_of(s, PoolKind::sphere, i), i >= 1 && i < 4 ? 1u : i == 6 ? 3u : 0u) << i;
  for (size_t i = 0; i < s.polygons.size(); ++i)
    EXPECT_EQ(object_of(s, PoolKind::polygon, i), i + 1 == s.polygons.size() ? 3u : 0u) << i;
  EXPECT_EQ(object_of(s, PoolKind::mesh, 0), 2u);
  EXPECT_EQ(object_of(s, PoolKind::mesh, 1), 0u);
  EXPECT_EQ(object_of(s, PoolKind::plane, 0), 0u);
  EXPECT_EQ(object_of(Scene(), PoolKind::plane, 0), 0u);
}

TEST(Scene, AValidSceneHasNoProblem) { EXPECT_THAT(validate(sample()), IsEmpty()); }

struct Fault {
  void (*make)(Scene&);
  const char* sentence;
};

TEST(Scene, EachFaultIsNamed) {
  const Fault faults[] = {
      {[](Scene& s) { s.origin.x = kInf; }, "the origin must be finite"},
      {[](Scene& s) { s.requests.samples_per_pixel = -1; },
       "the samples per pixel must not be negative"},
      {[](Scene& s) { s.camera.from.x = kNan; }, "camera: from, at and up must be finite"},
      {[](Scene& s) { s.camera.at = s.camera.from; }, "camera: from and at are the same point"},
      {[](Scene& s) { s.camera.up = {}; }, "camera: up is zero"},
      {[](Scene& s) { s.camera.up = {0, 0, 2}; }, "camera: up is parallel to the line of sight"},
      {[](Scene& s) { s.camera.fov_deg = 180; },
       "camera: the angle must lie between 0 and 180 degrees"},
      {[](Scene& s) { s.camera.fov_deg = kNan; },
       "camera: the angle must lie between 0 and 180 degrees"},
      {[](Scene& s) { s.requests.near_clip = kInf; }, "camera: hither must be finite"},
      {[](Scene& s) { s.camera.width = 5; },
       "camera: the resolution must be two positive numbers, or two zeros for none"},
      {[](Scene& s) { s.camera.lens_radius = -1.0f; },
       "camera: the lens radius must not be negative"},
      {[](Scene& s) { s.camera.focus_distance = 0.0f; },
       "camera: the focus distance must be positive"},
      {[](Scene& s) { s.background.y = -1; },
       "background: the colour must be finite and not negative"},
      {[](Scene& s) { s.lights[0].position.z = kInf; }, "light 0: the position must be finite"},
      {[](Scene& s) { s.lights[0].color = Rgb(0, 0, -1); },
       "light 0: the colour must be finite and not negative"},
      {[](Scene& s) { s.materials[0].color.x = kNan; },
       "material 0: the colour must be finite and not negative"},
      {[](Scene& s) { s.materials[0].shine = -1; },
       "material 0: Kd, Ks, Shine, T and ior must be finite and not negative"},
      {[](Scene& s) { s.materials[0].transmission = 0.5f, s.materials[0].ior = 0; },
       "material 0: T is above 0, so ior must be too"},
      {[](Scene& s) { s.plane_materials.clear(); }, "there are 1 planes but 0 materials for them"},
      {[](Scene& s) { s.sphere_materials[0] = 1; }, "sphere 0: material 1 of 1"},
      {[](Scene& s) { s.planes[0].point.x = kInf; }, "plane 0: the point must be finite"},
      {[](Scene& s) { s.planes[0].normal = {0, 0, 2}; }, "plane 0: the normal must have length 1"},
      {[](Scene& s) { s.spheres[0].center.x = kNan; }, "sphere 0: the centre must be finite"},
      {[](Scene& s) { s.spheres[0].radius = 0; },
       "sphere 0: the radius must be finite and not zero"},
      {[](Scene& s) { s.cones[1].apex.x = kNan; }, "cone 1: base and apex must be finite"},
      {[](Scene& s) { s.cones[1].apex = s.cones[1].base; },
       "cone 1: base and apex are the same point"},
      {[](Scene& s) { s.cones[1].base_radius = s.cones[1].apex_radius = 0; },
       "cone 1: the radii must be finite and not both zero"},
      {[](Scene& s) { s.cones[1].apex_radius = -1; },
       "cone 1: one radius is negative and the other is not"},
      {[](Scene& s) { s.positions[7].x = kInf; }, "position 7: must be finite"},
      {[](Scene& s) { s.normals[0] = {}; }, "normal 0: must have length 1"},
      {[](Scene& s) { s.triangles[1][2] = 8; }, "triangle 1: vertex 8 of 8 positions"},
      {[](Scene& s) { s.triangle_normals.pop_back(); },
       "there are 2 triangles but 1 triples of normals"},
      {[](Scene& s) { s.triangle_normals[0][1] = 1; }, "triangle 0: normal 1 of 1"},
      {[](Scene& s) { s.polygons[0].count = 3; }, "polygon 0: 3 vertices, fewer than 4"},
      {[](Scene& s) { s.polygons[0].first = 5; }, "polygon 0: vertices up to 9 of 8 positions"},
      {[](Scene& s) { s.polygons[0].first = 0xffffffffu; },
       "polygon 0: vertices up to 4294967299 of 8 positions"},
  };
  for (const Fault& fault : faults) {
    Scene scene = sample();
    fault.make(scene);
    EXPECT_THAT(validate(scene), ElementsAre(fault.sentence));
  }
}

TEST(Scene, EachFaultOfOptionalPartsIsNamed) {
  const Fault faults[] = {
      {[](Scene& s) { s.sphere_colors.pop_back(); }, "there are 10 spheres but 9 colours for them"},
      {[](Scene& s) { s.cone_opacity.push_back(1); },
       "there are 10 cones but 11 opacities for them"},
      {[](Scene& s) { s.polygon_colors[2].y = -1; },
       "polygon 2: the colour must be finite and not negative"},
      {[](Scene& s) { s.triangle_opacity[3] = 1.5f; },
       "triangle 3: the opacity must lie between 0 and 1"},
      {[](Scene& s) { s.plane_opacity[0] = kNan; },
       "plane 0: the opacity must lie between 0 and 1"},
      {[](Scene& s) { s.meshes[1].positions[2].x = kInf; }, "mesh 1: position 2: must be finite"},
      {[](Scene& s) { s.meshes[0].triangles[1][2] = 4; },
       "mesh 0: triangle 1: vertex 4 of 4 positions"},
      {[](Scene& s) { s.meshes[0].normal_indices[0][0] = 2; }, "mesh 0: triangle 0: normal 2 of 2"},
      {[](Scene& s) { s.meshes[1].normals.pop_back(); },
       "mesh 1: there are 3 positions but 2 normals"},
      {[](Scene& s) { s.meshes[1].uv.pop_back(); },
       "mesh 1: there are 3 positions but 2 texture coordinates"},
      {[](Scene& s) { s.meshes[1].uv[1][0] = kInf; },
       "mesh 1: texture coordinates 1: must be finite"},
      {[](Scene& s) { s.meshes[1].colors[0].z = kNan; },
       "mesh 1: colour 0: must be finite and not negative"},
      {[](Scene& s) { s.meshes[0].materials.pop_back(); },
       "mesh 0: there are 4 triangles but 3 materials, expected 1 or one per triangle"},
      {[](Scene& s) { s.meshes[1].materials[0] = 3; }, "mesh 1: material 3 of 3"},
      {[](Scene& s) { s.object_ranges[0].object = 0; }, "object range 0: object 0 of 3"},
      {[](Scene& s) { s.object_ranges[3].object = 4; }, "object range 3: object 4 of 3"},
      {[](Scene& s) { s.object_ranges[3].count = 3; }, "object range 3: elements up to 3 of 2"},
      {[](Scene& s) { s.object_ranges[2].count = 0; }, "object range 2: it is empty"},
      {[](Scene& s) { s.object_ranges[1].first = 3; },
       "object range 1: it must follow the range before without overlap"},
      {[](Scene& s) { std::swap(s.object_ranges[2], s.object_ranges[3]); },
       "object range 3: it must follow the range before without overlap"},
      {[](Scene& s) { s.object_ranges[3].pool = PoolKind(11); }, "object range 3: pool 11 of 11"},
  };
  for (const Fault& fault : faults) {
    Scene scene = rich_scene();
    ASSERT_EQ(scene.spheres.size(), 10u);
    fault.make(scene);
    EXPECT_THAT(validate(scene), ElementsAre(fault.sentence));
  }
}

TEST(Scene, FaultsOfManyElementsComeInOrder) {
  Scene scene = sample();
  scene.spheres.assign(300'000, {{0, 0, 0}, 1});
  scene.sphere_materials.assign(300'000, 0);
  for (const size_t i : {5u, 65'536u, 299'999u}) scene.spheres[i].radius = 0;
  EXPECT_THAT(validate(scene),
              ElementsAre("sphere 5: the radius must be finite and not zero",
                          "sphere 65536: the radius must be finite and not zero",
                          "sphere 299999: the radius must be finite and not zero"));
}

TEST(Scene, NoMaterialAtAll) {
  Scene scene;
  EXPECT_THAT(validate(scene), ElementsAre("there is no material"));
}

TEST(Scene, ManyProblemsAreCutShort) {
  Scene scene = sample();
  scene.spheres.assign(100, {});
  scene.sphere_materials.assign(100, 0);
  const std::vector<std::string> problems = validate(scene);
  ASSERT_THAT(problems, SizeIs(21));
  EXPECT_EQ(problems.back(), "80 more problems");
}

}  // namespace
}  // namespace raio::core
