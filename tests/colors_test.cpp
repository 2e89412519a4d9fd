// Colours of primitives, meshes and objects, on their way from the scene to the picture.
#include <gtest/gtest.h>

#include "accel/geometry.h"
#include "integrate/classic.h"
#include "io/plain_scene.h"
#include "one_picture.h"
#include "render/render.h"
#include "rich_scene.h"

namespace raio::core {
namespace {

using tests::random_scene;
using tests::rich_scene;

Image picture(const Scene& scene, AccelKind kind) {
  RenderOptions options;
  options.accel.kind = kind;
  options.width = 96, options.height = 72;
  options.soft_shadows = true;
  return tests::picture_of(scene, options);
}

/// rich_scene() with an unused material bright enough to determine the film's unit; without
/// features that materials and triangles cannot express.
Scene scene_of_one_unit(uint32_t seed) {
  Scene scene = rich_scene(seed);
  for_each_pool([&](auto pool) { (scene.*pool.opacity).clear(); });
  for (Mesh& mesh : scene.meshes) mesh.colors.clear();
  scene.material_texture.clear(), scene.standard_surfaces.clear();
  scene.add_material({Rgb(2), 1, 1, 1, 0, 1});
  return scene;
}

/// With materials instead of colours and triangles instead of meshes; other tests check such
/// pictures against formulas.
TEST(Colors, PicturesMatchThoseOfMaterials) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    const Scene rich = scene_of_one_unit(seed), plain = plain_scene(rich);
    EXPECT_TRUE(plain.meshes.empty() && plain.sphere_colors.empty());
    EXPECT_GT(plain.materials.size(), rich.materials.size() + 20);
    EXPECT_TRUE(validate(plain).empty());
    const Image expected = picture(plain, AccelKind::none);
    for (const AccelKind kind : {AccelKind::none, AccelKind::grid, AccelKind::bvh})
      EXPECT_TRUE(tests::same_bytes(picture(rich, kind), expected)) << seed << " " << int(kind);
  }
}

TEST(Colors, EachKindHasItsOwn) {
  const Scene rich = scene_of_one_unit(1);
  Scene none = rich;
  for (auto* colors : {&none.plane_colors, &none.sphere_colors, &none.cone_colors,
                       &none.triangle_colors, &none.polygon_colors})
    colors->clear();
  const Image without = picture(none, AccelKind::bvh);
  const auto changes = [&](StridedArray<Rgb> Object::* colors) {
    Scene one = none;
    one.*colors = rich.*colors;
    EXPECT_TRUE(validate(one).empty());
    const Image with = picture(one, AccelKind::bvh);
    EXPECT_FALSE(tests::same_bytes(with, without));
    EXPECT_TRUE(tests::same_bytes(with, picture(plain_scene(one), AccelKind::bvh)));
  };
  changes(&Scene::plane_colors), changes(&Scene::sphere_colors), changes(&Scene::cone_colors);
  changes(&Scene::triangle_colors), changes(&Scene::polygon_colors);
}

TEST(Colors, VertexColorsAreInterpolated) {
  Scene scene;
  scene.camera.from = {0, 0, 10}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 1, 0};
  scene.camera.fov_deg = 0.01f;
  scene.lights = {{{0, 0, 1000}, Rgb(1), {}}};
  scene.materials = {{.color = {1, 1, 0.5f}, .kd = 1}};
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};  // weights 1/2, 1/4, 1/4 at the middle
  mesh.colors = {Rgb(1, 0, 0), Rgb(0, 1, 0), Rgb(0, 0, 2)};
  mesh.triangles = {{0, 1, 2}};
  mesh.materials = {0};
  scene.meshes.push_back(mesh);
  ASSERT_TRUE(validate(scene).empty());
  RenderOptions options;
  options.width = options.height = 1;
  const Rgb seen = tests::expect_one_picture(scene, options).pixels[0];
  EXPECT_NEAR(seen.x, 0.5, 1e-4);
  EXPECT_NEAR(seen.y, 0.25, 1e-4);
  EXPECT_NEAR(seen.z, 0.25, 1e-4);
}

TEST(Colors, ColorsOfTheMaterialsChangeNothing) {
  const Scene plain = random_scene(60, 4);
  Scene colored = plain;
  for (const MaterialId id : plain.sphere_materials)
    colored.sphere_colors.push_back(plain.materials[id].color);
  for (const MaterialId id : plain.polygon_materials)
    colored.polygon_colors.push_back(plain.materials[id].color);
  EXPECT_TRUE(tests::same_bytes(picture(plain, AccelKind::bvh), picture(colored, AccelKind::bvh)));
  EXPECT_LT(classic_bound(colored, {}), 1.5 * classic_bound(plain, {}));
}

TEST(Colors, ABrightOneIsWithinTheBoundOfTheFilm) {
  Scene scene = random_scene(60, 4);
  const double before = classic_bound(scene, {});
  scene.cone_colors.assign(scene.cones.size(), Rgb(50));
  EXPECT_GT(classic_bound(scene, {}), 10 * before);
}

/// Meshes' triangles: before the pieces of polygons, after the scene's own triangles.
TEST(Meshes, TrianglesFollowThoseOfTheScene) {
  Scene scene = random_scene(40, 2), own = scene;
  scene.meshes = rich_scene().meshes;
  scene.polygons.clear(), scene.polygon_materials.clear();
  own.polygons.clear(), own.polygon_materials.clear();
  const Geometry with(scene, scene), without(own, own);
  const auto before = uint32_t(without.count(PrimitiveKind::triangle));
  ASSERT_EQ(with.count(PrimitiveKind::triangle), before + 4u);  // one of five has no area
  for (uint32_t i = 0; i < before; ++i)
    EXPECT_EQ(with.facet(i).normal, without.facet(i).normal) << i;
  const Mesh &pyramid = scene.meshes[0], &sheet = scene.meshes[1];
  EXPECT_EQ(with.triangle(before + 1).c, pyramid.positions[3]);
  EXPECT_EQ(with.facet(before + 1).material, 1u);
  EXPECT_EQ(with.triangle(before + 3).b, sheet.positions[1]);
  EXPECT_EQ(with.facet(before + 3).material, 1u);
  ASSERT_TRUE(with.corner_normals(before));
  EXPECT_EQ(with.normals()[(*with.corner_normals(before))[2]], pyramid.normals[1]);
  EXPECT_FALSE(with.corner_normals(before + 2));
  EXPECT_EQ(with.normals()[(*with.corner_normals(before + 3))[1]], Vec3f(0, 0, 1));
  EXPECT_FALSE(with.corner_normals(0));
}

TEST(Meshes, NothingIsCopiedWithoutThem) {
  const Scene scene = random_scene(40, 2);
  const Geometry geometry(scene, scene);
  EXPECT_EQ(geometry.positions().data(), scene.positions.data());
  EXPECT_FALSE(geometry.any_colors());
  EXPECT_EQ(geometry.object_of(geometry.id_of(PrimitiveKind::triangle, 0)), 0u);
}

TEST(Objects, AreKnownForHits) {
  const Scene s = rich_scene();
  const Geometry geometry(s, s);
  EXPECT_EQ(geometry.object_of(geometry.id_of(PrimitiveKind::sphere, 2)), 1u);
  EXPECT_EQ(geometry.object_of(geometry.id_of(PrimitiveKind::sphere, 6)), 3u);
  EXPECT_EQ(geometry.object_of(geometry.id_of(PrimitiveKind::plane, 0)), 0u);
  EXPECT_EQ(geometry.object_of(geometry.id_of(PrimitiveKind::cone, 0)), 0u);
  std::array<size_t, 4> triangles{};
  for (uint32_t i = 0; i < geometry.count(PrimitiveKind::triangle); ++i)
    ++triangles.at(geometry.object_of(geometry.id_of(PrimitiveKind::triangle, i)));
  EXPECT_EQ(triangles[1], 0u);
  EXPECT_EQ(triangles[2], 3u) << "of the pyramid";
  EXPECT_EQ(triangles[3], 2u) << "of the floor, a polygon of four corners";
  EXPECT_GT(triangles[0], 20u);
}

}  // namespace
}  // namespace raio::core
