// Normal maps in the integrator `path`, against the normals that they store.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "integrate/normal_map.h"
#include "one_picture.h"
#include "scenes.h"

namespace raio::core {
namespace {

using tests::expect_one_picture;
using tests::picture_of;
using tests::same_bytes;

// The texels of a map and, as glTF 2.0 defines it, the normal that one stores.
uint32_t texel_of(uint32_t red, uint32_t green, uint32_t blue) {
  return red | green << 8 | blue << 16;
}
Vec3d normal_of(uint32_t texel, double scale = 1) {
  const auto part = [&](uint32_t shift) { return double(texel >> shift & 255) / 255 * 2 - 1; };
  return normalize(Vec3d(part(0) * scale, part(8) * scale, part(16)));
}
const uint32_t kRight = texel_of(191, 128, 238);  // by 30 degrees
const uint32_t kUp = texel_of(128, 191, 238);
const uint32_t kFlat = texel_of(128, 128, 255);

// A square of this half side in the plane z = 0; its picture has x to the right, y up.
Mesh map_sheet(float half = 1) {
  Mesh mesh;
  mesh.positions = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.uv = {{0, 0}, {half, 0}, {half, half}, {0, half}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0};
  return mesh;
}

// White and diffuse, seen from above, with the map.
Scene mapped_square(uint32_t texel, const StandardSurface& surface = {.specular = 0}) {
  Scene scene;
  scene.camera.from = {0.4f, 0.3f, 3}, scene.camera.at = {0.1f, 0.2f, 0};
  scene.camera.up = {0.1f, 1, 0.2f}, scene.camera.fov_deg = 0.01f;
  scene.add_material({.color = Rgb(1), .kd = 1});
  scene.set_standard_surface(surface);
  scene.texels = {texel}, scene.textures = {{0, 1, 1}};
  scene.standard_surfaces[0].normal_texture = 0;
  scene.meshes = {map_sheet()};
  return scene;
}

RenderOptions normal_options(int samples, int depth) {
  RenderOptions options;
  options.integrator = IntegratorKind::path;
  options.width = options.height = 8;
  options.samples = samples, options.depth = depth;
  return options;
}

// Of a diffuse surface with this normal, in light from all sides.
void expect_normal(Scene scene, Vec3d normal, const char* what) {
  const Vec3d facing = Vec3d(scene.camera.from - scene.camera.at);
  for (const Vec3d& side : {Vec3d(1, 0, 0), Vec3d(-1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1),
                            Vec3d(0, -1, 0), Vec3d(0, 0, -1)}) {
    const Vec3d to_light = normalize(normalize(facing) + side * 0.75);
    PhysicalLight light;
    light.kind = LightKind::directional, light.color = Rgb(float(std::numbers::pi));
    light.direction = Vec3f(-to_light);
    scene.physical_lights = {light};
    const double expected = std::max(dot(normal, to_light), 0.0);
    EXPECT_NEAR(picture_of(scene, normal_options(1, 2)).at(4, 4).x, expected, 1e-5)
        << what << ", light from " << side.x << ' ' << side.y << ' ' << side.z;
  }
}

TEST(PathNormals, RedPointsRightAndGreenUp) {
  for (const uint32_t texel : {kRight, kUp, texel_of(90, 180, 225)}) {
    EXPECT_GT(dot(normal_of(kRight), Vec3d(1, 0, 0)), 0.49);
    expect_normal(mapped_square(texel), normal_of(texel), "plain");
  }
  Scene scene = mapped_square(kRight);
  scene.standard_surfaces[0].normal_scale = -0.5f;
  expect_normal(scene, normal_of(kRight, -0.5), "scaled");
  scene = mapped_square(kRight);
  for (size_t i = 0; i < 4; ++i) scene.meshes[0].uv[i][0] *= -2;
  Vec3d left = normal_of(kRight);
  left.x = -left.x;
  expect_normal(scene, left, "mirrored picture");
}

// Bumps are dents from behind.
TEST(PathNormals, BacksHaveTheOppositeNormal) {
  Scene scene = mapped_square(texel_of(170, 100, 240));
  scene.camera.from.z = -3;
  expect_normal(scene, -normal_of(texel_of(170, 100, 240)), "back");
}

TEST(PathNormals, InstancesTakeTheirNormalsAlong) {
  const uint32_t texel = texel_of(160, 190, 235);
  const Vec3d n = normal_of(texel);
  struct Copy {
    const char* name;
    Matrix matrix;
    Vec3d normal;
  };
  const Copy copies[] = {{"turned", {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}, {-n.y, n.x, n.z}},
                         {"mirrored", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, {-n.x, n.y, n.z}},
                         {"stretched", {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0.5f, 0}, n},
                         {"diagonal",
                          {0.6f, -0.8f, 0, 0, 0.8f, 0.6f, 0, 0, 0, 0, 2, 0},
                          {0.6 * n.x - 0.8 * n.y, 0.8 * n.x + 0.6 * n.y, n.z}}};
  for (const Copy& copy : copies) {
    Scene scene = mapped_square(texel);
    Object object, outer;
    object.meshes = {scene.meshes[0]};
    scene.meshes = {};
    scene.prototypes = {object};
    scene.instances = {{0, copy.matrix}};
    expect_normal(scene, copy.normal, copy.name);
    outer.prototypes = {object};
    outer.instances = {{0, copy.matrix}};
    scene.prototypes = {outer};
    scene.instances = {{0, {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0}}};
    expect_normal(scene, {-copy.normal.y, copy.normal.x, copy.normal.z}, copy.name);
  }
}

// No texel is exactly flat: 128 is a tilt of a quarter of a degree.
TEST(PathNormals, FlatMapsChangeLittle) {
  Scene scene = mapped_square(kFlat, {.metallic = 0.5f, .roughness = 0.5f});
  PhysicalLight light;
  light.kind = LightKind::directional, light.color = Rgb(2), light.direction = {-0.3f, -0.2f, -1};
  scene.physical_lights = {light};
  scene.background = {0.2f, 0.3f, 0.4f};
  scene.camera.fov_deg = 30;
  const Image mapped = picture_of(scene, normal_options(64, 3));
  scene.standard_surfaces[0].normal_texture = kNoTexture;
  const Image plain = picture_of(scene, normal_options(64, 3));
  for (size_t i = 0; i < plain.pixels.size(); ++i)
    EXPECT_NEAR(mapped.pixels[i].x, plain.pixels[i].x, 0.04f * plain.pixels[i].x) << i;
}

// Without texture coordinates, or where they have no area, there are no directions.
TEST(PathNormals, NeedTextureCoordinates) {
  Scene scene = mapped_square(kRight);
  for (size_t i = 0; i < 4; ++i) scene.meshes[0].uv[i] = {0.5f, float(i)};
  scene.background = Rgb(0.5f);
  Scene other = scene, plain = scene;
  plain.standard_surfaces[0].normal_texture = kNoTexture;
  other.meshes[0].uv = {};
  const Image expected = picture_of(plain, normal_options(4, 3));
  EXPECT_TRUE(same_bytes(picture_of(scene, normal_options(4, 3)), expected));
  EXPECT_TRUE(same_bytes(picture_of(other, normal_options(4, 3)), expected));
}

// A smooth coat reflects by its angle with the surface, not with the map.
TEST(PathNormals, ClearCoatsHaveNoMap) {
  Scene scene = mapped_square(kRight, {.specular = 0, .coat = 1});
  scene.materials[0].color = Rgb(0), scene.background = Rgb(1);
  scene.camera.from = {-3, 0.2f, 0.6f}, scene.camera.at = {0.1f, 0.2f, 0};
  const float mapped = picture_of(scene, normal_options(1024, 2)).at(4, 4).x;
  scene.standard_surfaces[0].normal_texture = kNoTexture;
  const float plain = picture_of(scene, normal_options(1024, 2)).at(4, 4).x;
  EXPECT_GT(plain, 0.2f);
  EXPECT_NEAR(mapped, plain, 0.02f * plain);
}

// Of a map with all kinds of slopes, texels with no direction, and blue below one half.
void roughen(Scene& scene) {
  constexpr uint32_t kSide = 16;
  scene.texels = {};
  std::mt19937 rng(1);
  for (uint32_t i = 0; i < kSide * kSide; ++i) {
    const auto bits = uint32_t(rng());
    scene.texels.push_back(texel_of(bits & 255, bits >> 8 & 255, 100 + (bits >> 16) % 156));
  }
  scene.textures = {{0, kSide, kSide}};
}

// A mirror sees its white world, wherever the map turns it: light from below would be black.
TEST(PathNormals, NoBlackPixelsAtGrazingAngles) {
  for (const float roughness : {0.0f, 0.3f}) {
    Scene scene = mapped_square(0, {.metallic = 1, .roughness = roughness});
    roughen(scene);
    scene.meshes = {map_sheet(20)};
    scene.background = Rgb(1);
    scene.camera.from = {-2, 0.1f, 0.18f}, scene.camera.at = {}, scene.camera.up = {0, 0, 1};
    scene.camera.fov_deg = 4;
    RenderOptions options = normal_options(64, 3);
    options.width = options.height = 32;
    for (const Rgb& pixel : picture_of(scene, options).pixels)
      EXPECT_GT(pixel.x, roughness == 0 ? 0.999f : 0.4f);
  }
}

TEST(PathNormals, BentNormalsMirrorToAboveTheSurface) {
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto direction = [&] {
    const float x = unit(rng), y = unit(rng), z = unit(rng);
    return normalize(Vec3f(x, y, z));
  };
  int kept = 0;
  for (int i = 0; i < 10000; ++i) {
    const Vec3f geometric = direction(), normal = direction();
    Vec3f eye = direction();
    if (dot(eye, geometric) < 0) eye = -eye;
    const Vec3f bent = bent_normal(normal, geometric, eye);
    EXPECT_NEAR(length(bent), 1, 1e-6f);
    EXPECT_GT(dot(bent, eye), 0);
    EXPECT_GT(dot(bent * (2 * dot(bent, eye)) - eye, geometric), 0.002f);
    kept += bent == normal;
  }
  EXPECT_GT(kept, 1000);
  const Vec3f up = {0, 0, 1}, down = {0, 0, -1};
  EXPECT_EQ(bent_normal(down, up, up), up);
}

// Smooth, instanced and mixed with all other primitives.
TEST(PathNormals, OnePictureForAllThreadsAndInstructionSets) {
  Scene scene = tests::random_scene(40, 3);
  scene.standard_surfaces.assign(3, {.metallic = 0.5f, .roughness = 0.3f, .normal_texture = 0});
  roughen(scene);
  Mesh mesh = map_sheet();
  mesh.normals = {{-0.6f, 0, 0.8f}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}, {0, 0, 1}};
  scene.meshes = {mesh};
  Object object;
  object.meshes = {mesh};
  scene.prototypes = {object};
  scene.instances = {{0, {-0.5f, 0.2f, 0, 0.1f, 0, 0.5f, 0.3f, 0, 0.1f, 0, 0.5f, 0.4f}}};
  RenderOptions options = normal_options(4, 8);
  options.width = 40, options.height = 30, options.soft_shadows = true;
  const Image mapped = expect_one_picture(scene, options);
  for (StandardSurface& s : scene.standard_surfaces) s.normal_texture = kNoTexture;
  EXPECT_FALSE(same_bytes(mapped, picture_of(scene, options)));
}

}  // namespace
}  // namespace raio::core
