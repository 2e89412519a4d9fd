// Scenes as glTF, as the reader of glTF sees them again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "base/srgb.h"
#include "data_files.h"
#include "io/mesh/write.h"
#include "program.h"
#include "rich_scene.h"

namespace raio {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

json written(const Scene& scene) {
  const auto text = write_gltf(scene, GltfForm::text, "test");
  EXPECT_TRUE(text) << text.error();
  return text ? json::parse(*text) : json();
}

ReadScene again(const Scene& scene, GltfForm form = GltfForm::binary) {
  const auto bytes = write_gltf(scene, form, "test");
  EXPECT_TRUE(bytes) << bytes.error();
  if (!bytes) return {};
  auto got = read(*bytes, form == GltfForm::binary ? "a.glb" : "a.gltf");
  EXPECT_TRUE(got) << got.error().front().text();
  if (!got) return {};
  EXPECT_THAT(validate(got->scene), IsEmpty());
  return *std::move(got);
}

/// A mesh of two triangles with all columns.
Scene mesh_scene() {
  const auto got = read(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
      "property float u\nproperty float v\nproperty uchar red\nproperty uchar green\n"
      "property uchar blue\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 0 0 1 0 0 255 0 0\n1 0 0 0 0 1 1 0 0 255 0\n1 1 0 0 0.6 0.8 1 1 0 0 255\n"
      "0 1 0 0 0 1 0 0.25 10 20 30\n3 0 1 2\n3 0 2 3\n",
      "a.ply");
  EXPECT_TRUE(got) << got.error().front().text();
  return got->scene;
}

TEST(GltfWrite, MeshesKeepTheirColumns) {
  const Scene scene = mesh_scene();
  for (const GltfForm form : {GltfForm::binary, GltfForm::text}) {
    const Scene back = again(scene, form).scene;
    ASSERT_EQ(back.meshes.size(), 1u);
    const Mesh &a = scene.meshes[0], &b = back.meshes[0];
    EXPECT_TRUE(std::ranges::equal(a.triangles, b.triangles));
    EXPECT_TRUE(std::ranges::equal(a.positions, b.positions));
    EXPECT_TRUE(std::ranges::equal(a.uv, b.uv));
    ASSERT_EQ(b.colors.size(), 4u);
    ASSERT_EQ(b.normals.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_LT(length(a.normals[i] - b.normals[i]), 1e-6F);
      EXPECT_LT(max_component(abs(a.colors[i] - b.colors[i])), 1e-6F);
    }
  }
}

TEST(GltfWrite, TheCameraSeesTheSame) {
  Scene scene = mesh_scene();
  Camera& camera = scene.camera;
  camera.from = {1, 2, 3}, camera.at = {1, 1, 0}, camera.up = {0, 1, 0}, camera.fov_deg = 40;
  scene.camera.width = 300, scene.camera.height = 200, scene.camera.hither = 0.25F;
  Camera back = again(scene).scene.camera;
  EXPECT_LT(length(back.from - scene.camera.from), 1e-6F);
  const Vec3f before = normalize(scene.camera.at - scene.camera.from);
  EXPECT_LT(length(normalize(back.at - back.from) - before), 1e-6F);
  EXPECT_NEAR(back.fov_deg, 40, 1e-4);
  EXPECT_FLOAT_EQ(written(scene)["cameras"][0]["perspective"]["znear"], 0.25F);
  EXPECT_FLOAT_EQ(written(scene)["cameras"][0]["perspective"]["aspectRatio"], 1.5F);

  scene.camera.projection = Projection::orthographic;
  back = again(scene).scene.camera;
  ASSERT_TRUE(back.is_parallel());
  const auto height = [](const Camera& c) {
    return length(c.at - c.from) * std::tan(c.fov_deg * 3.14159265F / 360);
  };
  EXPECT_NEAR(height(back), height(scene.camera), 1e-5);
}

TEST(GltfWrite, DataFarAwayKeepsItsPlace) {
  const auto got =
      read("v 500000.25 4000000.5 0\nv 500001.25 4000000.5 0\nv 500000.25 4000001.5 0\nf 1 2 3\n",
           "a.obj");
  ASSERT_TRUE(got);
  const json file = written(got->scene);
  const auto at = file["nodes"][0]["translation"].get<std::vector<double>>();
  const Scene back = again(got->scene).scene;
  ASSERT_EQ(back.meshes.size(), 1u);
  for (size_t i = 0; i < 3; ++i) {
    const Vec3d before = got->scene.origin + Vec3d(got->scene.meshes[0].positions[i]);
    const Vec3d after = back.origin + Vec3d(back.meshes[0].positions[i]);
    EXPECT_LT(length(before - after), 1e-6);
  }
  EXPECT_THAT(at, ElementsAre(got->scene.origin.x, got->scene.origin.y, got->scene.origin.z));
}

// Of metallic-roughness, and in light of linear numbers.
TEST(GltfWrite, MaterialsReflectAsMuch) {
  const auto of = [](Dialect dialect, const Material& material) {
    Scene scene = mesh_scene();
    scene.dialect = dialect, scene.materials[0] = material;
    return written(scene)["materials"][0];
  };
  json m = of(Dialect::data, {.color = {0.5F, 0.25F, 1}, .kd = 1});
  EXPECT_THAT(m["pbrMetallicRoughness"]["baseColorFactor"], ElementsAre(0.5, 0.25, 1, 1));
  EXPECT_EQ(m["pbrMetallicRoughness"]["metallicFactor"], 0);
  EXPECT_EQ(m["pbrMetallicRoughness"]["roughnessFactor"], 1);
  EXPECT_EQ(m["doubleSided"], true);
  EXPECT_FALSE(m.contains("alphaMode"));
  m = of(Dialect::nff, {.color = {1, 1, 1}, .kd = 0, .ks = 1, .shine = 98});
  EXPECT_GT(m["pbrMetallicRoughness"]["metallicFactor"], 0.9);
  // 2 / (98 + 2), twice the root of which is taken.
  EXPECT_NEAR(m["pbrMetallicRoughness"]["roughnessFactor"], std::sqrt(std::sqrt(0.02)), 1e-6);
  m = of(Dialect::nff, {.color = {0, 0, 0}, .kd = 0, .transmission = 0.9F, .ior = 1.5F});
  EXPECT_NEAR(m["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1, 1e-6);
  EXPECT_EQ(m["extensions"]["KHR_materials_ior"]["ior"], 1.5);
}

TEST(GltfWrite, OpacityIsThatOfTheFaces) {
  Scene scene = mesh_scene();
  scene.material_opacity = {0.25F};
  EXPECT_EQ(written(scene)["materials"][0]["alphaMode"], "BLEND");
  const Scene back = again(scene).scene;
  ASSERT_EQ(back.material_opacity.size(), back.materials.size());
  EXPECT_EQ(back.material_opacity[back.meshes[0].materials[0]], 0.25F);
}

// A ball of triangles lies within the sphere and fills nearly all of it.
TEST(GltfWrite, TrianglesStandForRoundShapes) {
  const auto got = read(kWater, "a.xyz", {.style = AtomStyle::ball_and_stick});
  ASSERT_TRUE(got);
  const Scene back = again(got->scene).scene;
  EXPECT_EQ(back.spheres.size(), 0u);
  const Box3f a = bounds(got->scene), b = bounds(back);
  EXPECT_LT(length(a.lo - b.lo), 0.02F * length(a.hi - a.lo));
  EXPECT_LT(length(a.hi - b.hi), 0.02F * length(a.hi - a.lo));
  EXPECT_THAT(not_in_gltf(got->scene), HasSubstr("for which triangles stand"));
  // Two hydrogens share one mesh.
  const json file = written(got->scene);
  size_t spheres = 0;
  for (const json& node : file["nodes"]) spheres += node.contains("scale");
  EXPECT_GT(spheres, file["meshes"].size());
}

TEST(GltfWrite, EveryKindOfShapeComesBack) {
  const Scene scene = tests::rich_scene();
  const Scene back = again(scene).scene;
  const Box3f a = bounds(scene), b = bounds(back);
  EXPECT_LT(length(a.lo - b.lo) + length(a.hi - b.hi), 0.05F * length(a.hi - a.lo));
  EXPECT_EQ(again(scene).scene.meshes.size(), back.meshes.size());
  EXPECT_THAT(not_in_gltf(scene), HasSubstr("plane"));
  const json file = written(scene);
  EXPECT_EQ(file["extensions"]["KHR_lights_punctual"]["lights"].size(), scene.lights.size());
  EXPECT_EQ(file["textures"].size(), scene.textures.size());
}

TEST(GltfWrite, WhatIsNoTriangleIsRefused) {
  Scene scene;
  EXPECT_THAT(write_gltf(scene, GltfForm::binary).error(), HasSubstr("glTF holds triangles"));
}

using GltfCommandLine = CommandLine;

TEST_F(GltfCommandLine, ConvertsWithANotice) {
  put(file("two.xyz"), "2\n\nC 0 0 0\nC 9 0 0\n");
  for (const char* name : {"two.glb", "two.gltf"}) {
    const Outcome done = raio({"convert", "two.xyz", name});
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("the exact form of 2 round shapes, for which triangles stand"));
    EXPECT_EQ(raio({"render", "--quiet", name, "--size", "8x8", "-o", "a.png"}).status, 0);
  }
  expect_refusal({"convert", "two.xyz", "no/two.glb"}, 3, "no/two.glb");
  EXPECT_FALSE(std::filesystem::exists(file("no")));
}

}  // namespace
}  // namespace raio
