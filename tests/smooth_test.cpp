// Smoothed normals of meshes without any, against closed forms.
#include "io/mesh/smooth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "io/scene_file.h"

namespace raio::core {
namespace {

// Two squares of side 1 that share the edge x = 0; the second is tilted by an angle.
Mesh folded(double degrees, bool shares_vertices) {
  const double angle = degrees * std::numbers::pi / 180;
  const auto c = float(std::cos(angle)), s = float(std::sin(angle));
  Mesh mesh;
  mesh.positions = std::vector<Vec3f>{{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {-1, 1, 0},
                                      {c, 0, s},  {c, 1, s}, {0, 0, 0}, {0, 1, 0}};
  const uint32_t a = shares_vertices ? 1 : 6, b = shares_vertices ? 2 : 7;
  mesh.triangles = std::vector<TriangleIndices>{{0, 1, 2}, {0, 2, 3}, {a, 4, 5}, {a, 5, b}};
  mesh.materials = std::vector<MaterialId>{0};
  return mesh;
}

Scene scene_of(Mesh mesh) {
  Scene scene;
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

Vec3f normal_at(const Mesh& mesh, size_t triangle, size_t corner) {
  const uint32_t index = mesh.normal_indices[triangle][corner];
  return index == kNoNormal ? Vec3f() : mesh.normals[index];
}

// Whether the faces share vertices or only positions. On the edge the normal is tilted by half the
// angle: equal areas count on each side, once both triangles of a square and once one.
TEST(Smooth, EdgesThatBendLittleLookRound) {
  for (const bool shares : {true, false}) {
    Scene scene = scene_of(folded(30, shares));
    EXPECT_EQ(smooth_meshes(scene, 40), 1u);
    const Mesh& mesh = scene.meshes[0];
    const double angle = 30 * std::numbers::pi / 180;
    // At (0, 0, 0): of the first square one triangle, of the second one two.
    const Vec3d sum = Vec3d(0, 0, 1) + Vec3d(-std::sin(angle), 0, std::cos(angle)) * 2;
    const Vec3d expected = normalize(sum);
    const Vec3f found = normal_at(mesh, 0, 1);
    EXPECT_NEAR(double(found.x), expected.x, 1e-6);
    EXPECT_NEAR(double(found.z), expected.z, 1e-6);
    EXPECT_EQ(normal_at(mesh, 2, 0), found) << "one normal for the place";
    EXPECT_EQ(normal_at(mesh, 0, 0), Vec3f(0, 0, 1)) << "away from the edge";
  }
}

TEST(Smooth, EdgesThatBendMoreStaySharp) {
  Scene scene = scene_of(folded(50, true));
  EXPECT_EQ(smooth_meshes(scene, 40), 0u);
  EXPECT_TRUE(scene.meshes[0].normals.empty());
  EXPECT_EQ(smooth_meshes(scene, 0), 0u);
  EXPECT_EQ(smooth_meshes(scene, 60), 1u);
}

TEST(Smooth, TrianglesWithoutAreaStayFlat) {
  Mesh mesh = folded(30, true);
  mesh.triangles.push_back({1, 1, 2});
  mesh.positions.push_back({9, 9, 9});  // of no triangle
  Scene scene = scene_of(std::move(mesh));
  EXPECT_EQ(smooth_meshes(scene, 40), 1u);
  EXPECT_EQ(scene.meshes[0].normal_indices[4][0], kNoNormal);
  for (const Vec3f& normal : scene.meshes[0].normals) EXPECT_FLOAT_EQ(length(normal), 1);
}

// Only meshes of files without normals, and not a file of another kind.
TEST(Smooth, IsAnOptionOfMeshes) {
  const std::string cube_top =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.2\nv 2 0 0.2\nv 2 1 0.2\nf 1 2 3 4\nf 2 5 6 3\n";
  auto read = parse_scene(cube_top, "a.obj");
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->scene.meshes[0].normals.empty());
  read = parse_scene(cube_top, "a.obj", {.smooth = 0.0f});
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->scene.meshes[0].normals.empty());
  const auto atoms = parse_scene("1\n\nC 0 0 0\n", "a.xyz", {.smooth = 10.0f});
  ASSERT_FALSE(atoms);
  EXPECT_THAT(atoms.error()[0].message, testing::HasSubstr("`smooth` has no effect"));
}

}  // namespace
}  // namespace raio::core
