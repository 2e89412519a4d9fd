// Meshes as other programs write them, of which some bend the rules.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "data_files.h"
#include "io/mesh/write.h"
#include "render/options.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::HasSubstr;

std::string told(const ReadScene& read) {
  std::string out;
  for (const Diagnostic& notice : read.notices) out += notice.text() + "\n";
  return out;
}
size_t triangles(const ReadScene& read) {
  return read.scene.meshes.empty() ? 0 : read.scene.meshes[0].triangles.size();
}
Material first_material(const ReadScene& read) {
  return read.scene.materials[read.scene.meshes[0].materials[0]];
}

std::expected<ReadScene, Diagnostics> wild(const std::string& name) {
  return read_scene(RAIO_SOURCE_DIR "/../shared/wild/" + name);
}

TEST(WildMeshes, AreReadAsExpected) {
  if (!std::filesystem::exists(RAIO_SOURCE_DIR "/../shared/wild/meshes")) GTEST_SKIP();
  const std::tuple<const char*, size_t, const char*> cases[] = {
      {"obj-tr-one.obj", 1, "Tr is 1"},
      {"obj-kd-zero.obj", 1, "Kd is 0 0 0 (1: m)"},
      {"obj-trailing-slash.obj", 2, "face vertices that end with"},
      {"obj-normals-after.obj", 1, ""},
      {"obj-nan.obj", 1, "vertices without finite coordinates (1)"},
      {"obj-nan-normal.obj", 2, "normals that are not finite (1)"},
      {"obj-degenerate.obj", 2, "all triangles have zero area"},
      {"obj-utm.obj", 12, ""},
      {"obj-backslash.obj", 1, ""},
      {"obj-concave-closed.obj", 5, ""},
      {"obj-continued.obj", 2, ""},
      {"obj-mixed-colours.obj", 2, ""},
      {"obj-negative-interleaved.obj", 2, ""},
      {"obj-spaces.obj", 2, ""},
      {"obj-z-up.obj", 6, "z is up"},
      {"off-one-line.off", 2, ""},
      {"off-quads.off", 2, ""},
      {"off-split-lines.off", 2, ""},
      {"ply-face-colours.ply", 2, ""},
      {"ply-faces-first.ply", 1, ""},
      {"ply-texcoord-face.ply", 1, "textures/t.png"},
      {"ply-tristrips.ply", 3, ""},
      {"ply-ushort-list.ply", 1, ""},
      {"stl-attributes.stl", 2, ""},
      {"stl-count-zero.stl", 2, "its header says 0 triangles, the file has 2"},
      {"stl-leading-space.stl", 1, ""},
      {"stl-one-line.stl", 1, ""},
      {"stl-solid-binary.stl", 2, ""},
      {"stl-upper.stl", 2, ""},
      {"gltf-unlit-required.gltf", 1, ""},
      {"gltf-specgloss-required.gltf", 1, ""},
      {"gltf-sparse-no-view.gltf", 200, ""},
      {"gltf-morph-default.gltf", 1, ""},
      {"../molecules/ply-cr-header.ply", 1, ""},
      {"../molecules/ply-faces-first.ply", 1, ""},
  };
  for (const auto& [name, count, notice] : cases) {
    SCOPED_TRACE(name);
    const auto read = wild(std::string("meshes/") + name);
    ASSERT_TRUE(read);
    EXPECT_EQ(triangles(*read), count);
    if (std::string_view(notice).empty())
      EXPECT_EQ(told(*read), "");
    else
      EXPECT_THAT(told(*read), HasSubstr(notice));
  }
  const auto red = wild("meshes/obj-tr-one.obj");
  EXPECT_EQ(first_material(*red).color, Rgb(1, 0, 0));
  EXPECT_EQ(red->scene.material_opacity.size(), 0u);
  EXPECT_EQ(first_material(*wild("meshes/obj-kd-zero.obj")).color, Rgb(1));
  const auto sense8 = wild("meshes/nff-sense8.nff");
  ASSERT_FALSE(sense8);
  EXPECT_THAT(sense8.error()[0].text(), HasSubstr("Sense8 WorldToolKit"));
  const auto sky = wild("meshes/p3f-missing-sky.p3f");
  ASSERT_TRUE(sky);
  EXPECT_FALSE(option_conflict({}, &sky->scene));
  EXPECT_EQ(wild("meshes/ply-diffuse-names.ply")->scene.spheres.size(), 3u);
}

TEST(WildMeshes, PointsOfObjAreSpheres) {
  const auto cloud = read("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv nan 0 0\n", "a.obj");
  ASSERT_TRUE(cloud);
  ASSERT_EQ(cloud->scene.spheres.size(), 2u);
  EXPECT_EQ(cloud->scene.sphere_colors[1], Rgb(0, 1, 0));
  EXPECT_THAT(told(*cloud), HasSubstr("without finite coordinates (1)"));
  const auto named = read("v 0 0 0\nv 1 0 0\nv 2 0 0\np 1 -1\n", "a.obj");
  ASSERT_EQ(named->scene.spheres.size(), 2u);
  EXPECT_EQ(named->scene.spheres[1].center, Vec3f(2, 0, 0));
}

TEST(WildMeshes, FacesMayReferToMissingVertices) {
  const auto got = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/7 2/1/7 3/1/7\n", "a.obj");
  ASSERT_TRUE(got);
  EXPECT_EQ(triangles(*got), 1u);
  EXPECT_THAT(told(*got),
              HasSubstr("texture coordinates that faces refer to and the file does not have (3)"));
  EXPECT_THAT(told(*got), HasSubstr("normals that faces refer to"));
}

TEST(WildMeshes, PositionsFarFromZeroKeepTheirDigits) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 10\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n";
  for (int i = 0; i < 10; ++i)
    text += "500000." + std::to_string(i) + " 4649776." + std::to_string(i) + " 120\n";
  const auto got = read(text, "a.ply");
  ASSERT_TRUE(got);
  const Scene& scene = got->scene;
  for (int i = 0; i < 10; ++i) {
    const Vec3d place = scene.origin + Vec3d(scene.spheres[size_t(i)].center);
    EXPECT_NEAR(place.x, 500000 + 0.1 * i, 1e-3);
    EXPECT_NEAR(place.y, 4649776 + 0.1 * i, 1e-3);
  }
  // Data as wide as its distance needs no origin.
  const auto wide = read("v 500000 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", "a.obj");
  EXPECT_EQ(wide->scene.origin, Vec3d());
  // Written and read back, it is where it was.
  const auto again = read(write_ply(scene), "b.ply");
  ASSERT_TRUE(again);
  EXPECT_NEAR((again->scene.origin + Vec3d(again->scene.spheres[9].center)).y, 4649776.9, 1e-3);
}

TEST(WildMeshes, PlyKeepsAFittedCamera) {
  const auto obj = read("v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n", "a.obj");
  const auto ply = read(write_ply(obj->scene), "a.ply");
  ASSERT_TRUE(ply);
  EXPECT_EQ(ply->scene.camera, obj->scene.camera);
}

TEST(WildMeshes, NonFinitePointsAreSkipped) {
  const std::string header =
      "ply\rformat ascii 1.0\relement vertex 3\rproperty float x\r"
      "property float y\rproperty float z\rend_header\r";
  const auto got = read(header + "0 0 0\rnan 0 0\r1 0 0\r", "a.ply");
  ASSERT_TRUE(got);
  EXPECT_EQ(got->scene.spheres.size(), 2u);
  EXPECT_THAT(told(*got), HasSubstr("without finite coordinates (1)"));
}

TEST(WildMeshes, StlMayHaveSpareBytes) {
  std::string stl(80, '\0');
  stl += std::string("\2\0\0\0", 4) + std::string(101, '\0');
  const auto got = read(stl, "a.stl");
  ASSERT_TRUE(got);
  EXPECT_EQ(triangles(*got), 2u);
  EXPECT_THAT(told(*got), HasSubstr("1 bytes after its 2 triangles"));
}

TEST(WildMeshes, AreaLightsOfStudentsAreNamed) {
  EXPECT_THAT(error("b 0 0 0\nla 1 2 3 1 1 1 0 0 1 1 0 0\n", "a.nff"), HasSubstr("an area light"));
  EXPECT_THAT(error("b 0 0 0\nla 1 2 3\n", "a.nff"), HasSubstr("an animated light"));
}

}  // namespace
}  // namespace raio::core
