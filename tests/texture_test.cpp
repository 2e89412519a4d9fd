// Textures: colours at coordinates, on meshes, in pictures and in files.
#include "scene/texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/srgb.h"
#include "io/image/codecs.h"
#include "io/raio/raio.h"
#include "io/scene_file.h"
#include "io/textures.h"
#include "one_picture.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::AllOf;
using testing::HasSubstr;

uint32_t texel(int x, int y) {
  return uint32_t(40 * x + 10) | uint32_t(60 * y + 5) << 8 | 77u << 16;
}

Scene with_texture(int width, int height, TextureWrap u = TextureWrap::repeat,
                   TextureWrap v = TextureWrap::repeat) {
  Scene scene;
  scene.texels = {0xffffff};  // of nothing
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) scene.texels.push_back(texel(x, y));
  scene.textures = {{1, uint32_t(width), uint32_t(height), u, v}};
  return scene;
}

// In double, from the definition: the light of texel centres, between which it changes evenly.
Rgb by_definition(int width, int height, TextureWrap u, TextureWrap v, double x, double y) {
  const auto index = [](long i, long side, TextureWrap wrap) {
    if (wrap == TextureWrap::clamp) return std::clamp(i, 0L, side - 1);
    const long period = wrap == TextureWrap::repeat ? side : 2 * side;
    const long at = ((i % period) + period) % period;
    return at < side ? at : period - 1 - at;
  };
  const double column = x * width - 0.5, row = (1 - y) * height - 0.5;
  const auto c = long(std::floor(column)), r = long(std::floor(row));
  Rgb sum;
  for (const long i : {0L, 1L})
    for (const long j : {0L, 1L}) {
      const double weight = (i ? column - double(c) : 1 - column + double(c)) *
                            (j ? row - double(r) : 1 - row + double(r));
      const uint32_t at = texel(int(index(c + i, width, u)), int(index(r + j, height, v)));
      sum +=
          Rgb(linear_from_srgb(float(at & 255) / 255), linear_from_srgb(float(at >> 8 & 255) / 255),
              linear_from_srgb(float(at >> 16) / 255)) *
          float(weight);
    }
  return sum;
}

TEST(Textures, AreBilinearInLinearLight) {
  using enum TextureWrap;
  for (const TextureWrap u : {repeat, clamp, mirror})
    for (const TextureWrap v : {repeat, clamp, mirror}) {
      const Scene scene = with_texture(5, 3, u, v);
      for (float x = -2.3f; x < 2.5f; x += 0.13f)
        for (float y = -2.1f; y < 2.5f; y += 0.17f) {
          const Rgb is = texture_color(scene, 0, {x, y});
          const Rgb must = by_definition(5, 3, u, v, double(x), double(y));
          for (int k = 0; k < 3; ++k) EXPECT_NEAR(is[k], must[k], 2e-6) << x << " " << y;
        }
    }
}

TEST(Textures, DataAndAlphaAreLinear) {
  Scene scene = with_texture(2, 1, TextureWrap::clamp, TextureWrap::clamp);
  scene.texels = {0, 0x00ff3300, 0xff0033ff};  // alpha 1, then 0
  EXPECT_EQ(texture_value(scene, 0, {0, 0}), Rgb(0, 0.2f, 1));
  EXPECT_EQ(texture_value(scene, 0, {0.5f, 0.5f}), Rgb(0.5f, 0.2f, 0.5f));
  EXPECT_EQ(texture_alpha(scene, 0, {0, 0}), 1);
  EXPECT_EQ(texture_alpha(scene, 0, {0.625f, 0}), 0.25f);
  EXPECT_EQ(texture_alpha(scene, 0, {1, 0}), 0);
  // Colours do not depend on alpha.
  const Rgb before = texture_color(scene, 0, {0.7f, 0});
  for (uint32_t& texel : scene.texels) texel ^= 0xab000000;
  EXPECT_EQ(texture_color(scene, 0, {0.7f, 0}), before);
}

TEST(Textures, KeepTheAlphaOfPictures) {
  Image image(2, 1);
  image.at(0, 0) = image.at(1, 0) = Rgb(1, 0.2f, 0);
  const std::vector<float> alpha = {1, 0};
  PictureView picture(image);
  picture.alpha = alpha, picture.is_straight = true;
  Scene scene;
  TextureReader reader;
  ASSERT_TRUE(reader.add(scene, *encode_png(picture, {})));
  EXPECT_EQ(scene.texels, Array<uint32_t>({0x000033ff, 0xff0033ff}));
}

TEST(Textures, BeginAtTheLowerLeft) {
  const Scene scene = with_texture(5, 3);
  EXPECT_EQ(texture_color(scene, 0, {0.1f, 1 - 0.5f / 3}).x, linear_from_srgb(10.0f / 255));
  EXPECT_NEAR(texture_color(scene, 0, {0.1f, 0.5f / 3}).y, linear_from_srgb(125.0f / 255), 1e-6);
}

TEST(Textures, HaveAColourAtAnyCoordinates) {
  for (const TextureWrap wrap : {TextureWrap::repeat, TextureWrap::clamp, TextureWrap::mirror}) {
    const Scene scene = with_texture(5, 3, wrap, wrap);
    for (const float x : {1e30f, -1e30f, 3e38f, -1e-12f, 16777217.0f, std::nanf(""), INFINITY})
      EXPECT_TRUE(is_finite(texture_color(scene, 0, {x, -x}))) << x;
  }
}

// A square in front of the camera that shows the texture, one pixel per texel.
Scene textured_square() {
  Scene scene = with_texture(6, 6);
  scene.dialect = Dialect::data;
  scene.camera.from = {0, 0, 1000}, scene.camera.at = {0, 0, 0}, scene.camera.up = {0, 1, 0};
  scene.camera.fov_deg = float(2 * std::atan(1e-3) * 180 / 3.14159265358979);
  scene.camera.width = scene.camera.height = 6;
  scene.lights = {{{0, 0, 1e6f}, Rgb(1), {}}};
  scene.add_material({.color = {0.5f, 1, 1}, .kd = 1}, Rgb(1), 0, 1, 0);
  scene.add_material({.color = {0.5f, 1, 1}, .kd = 1});
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.materials = {0};
  scene.meshes = {mesh};
  return scene;
}

TEST(Textures, AreVisibleOnMeshes) {
  const Scene scene = textured_square();
  ASSERT_THAT(validate(scene), testing::IsEmpty());
  RenderOptions options;
  options.integrator = IntegratorKind::classic;
  const Image seen = tests::expect_one_picture(scene, options);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x) {
      const uint32_t at = texel(x, y);
      EXPECT_NEAR(seen.at(x, y).x, linear_from_srgb(float(at & 255) / 255) / 2, 1e-3);
      EXPECT_NEAR(seen.at(x, y).y, linear_from_srgb(float(at >> 8 & 255) / 255), 1e-3);
    }
  options.integrator = IntegratorKind::ambient;
  tests::expect_one_picture(scene, options);
}

/// The other triangles of the scene, and an instance with its own space.
TEST(Textures, AreThoseOfTheMaterial) {
  RenderOptions options;
  options.integrator = IntegratorKind::classic;
  const Image seen = tests::picture_of(textured_square(), options);
  Scene plain = textured_square();
  plain.meshes[0].materials = {1};
  EXPECT_NEAR(tests::picture_of(plain, options).at(2, 2).y, 1, 1e-3);
  Scene copied = textured_square();
  Scene object;
  object.materials = copied.materials, object.material_texture = copied.material_texture;
  object.meshes = copied.meshes;
  for (Vec3f& p : object.meshes[0].positions) p = p * 0.5f + Vec3f(0, 0, 3);
  copied.meshes.clear();
  copied.prototypes = {object};
  copied.instances = {{0, {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, -6}}};
  ASSERT_THAT(validate(copied), testing::IsEmpty());
  const Image copy = tests::expect_one_picture(copied, options);
  for (size_t i = 0; i < seen.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(copy.pixels[i][k], seen.pixels[i][k], 1e-3);
}

TEST(Textures, AreStoredByRaioScenesOnly) {
  const Scene scene = textured_square();
  const auto again = decode_raio_scene(encode_raio_scene(scene), nullptr);
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->textures, scene.textures);
  EXPECT_EQ(again->texels, scene.texels);
  EXPECT_EQ(again->material_texture, scene.material_texture);
  EXPECT_EQ(content_hash(*again), content_hash(scene));
  for (const SceneFormat format : {SceneFormat::nff, SceneFormat::pov, SceneFormat::ply})
    EXPECT_THAT(lost_features(scene, format), HasSubstr("textures of 1 material"));
  EXPECT_EQ(lost_features(scene, SceneFormat::raio), "");
}

TEST(Textures, AffectTheHash) {
  const Scene scene = textured_square();
  const auto changes = [&](auto how) {
    Scene other = scene;
    how(other);
    EXPECT_NE(content_hash(other), content_hash(scene));
  };
  changes([](Scene& s) { s.texels[5] ^= 1; });
  changes([](Scene& s) { s.textures[0].wrap_u = TextureWrap::clamp; });
  changes([](Scene& s) { s.material_texture[1] = 0; });
}

TEST(Textures, InvalidOnesAreRefused) {
  const auto problem = [](auto how) {
    Scene scene = textured_square();
    how(scene);
    const auto problems = validate(scene);
    return problems.empty() ? "" : problems.front();
  };
  EXPECT_EQ(problem([](Scene& s) { s.material_texture[1] = 7; }), "material 1: texture 7 of 1");
  EXPECT_THAT(problem([](Scene& s) { s.material_texture.push_back(0); }), HasSubstr("3 textures"));
  EXPECT_THAT(problem([](Scene& s) { s.textures[0].first = 2; }), HasSubstr("its texels"));
  EXPECT_THAT(problem([](Scene& s) { s.textures[0].width = 0; }), HasSubstr("the sides"));
  EXPECT_THAT(problem([](Scene& s) { s.textures[0].height = 0xffffffff; }), HasSubstr("the sides"));
  EXPECT_THAT(problem([](Scene& s) { s.textures[0].wrap_v = TextureWrap(3); }),
              HasSubstr("the wrap mode"));
}

TEST(Textures, PicturesAreStoredOnce) {
  Image image(2, 1);
  image.at(1, 0) = Rgb(1, 0, 0);
  const std::string png = *encode_png(image, {});
  Scene scene;
  TextureReader reader;
  EXPECT_EQ(reader.add(scene, png), 0u);
  EXPECT_EQ(reader.add(scene, png), 0u);
  EXPECT_EQ(reader.add(scene, png, TextureWrap::clamp), 1u);
  EXPECT_EQ(scene.texels, Array<uint32_t>({0, 255}));
  EXPECT_THAT(reader.add(scene, "GIF8").error(), HasSubstr("expected a PNG or JPEG picture"));
  EXPECT_THAT(reader.add(scene, png.substr(0, 50)).error(), HasSubstr("broken PNG"));
}

using ObjTextures = TemporaryFolder;

constexpr std::string_view kSquare =
    "mtllib maps/a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
    "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1/1 2/2 3/3\n";

TEST_F(ObjTextures, ComeFromMaterialFiles) {
  std::filesystem::create_directories(folder() / "maps");
  Image image(2, 2);
  image.at(0, 0) = Rgb(1, 1, 1);
  put(file("maps/wood 1.png"), *encode_png(image, {}));
  put(file("a.obj"), kSquare);
  put(file("maps/a.mtl"),
      "newmtl a\nmap_Kd wood 1.png\nnewmtl b\nKd 1 0 0\n"
      "map_Kd -clamp on -s 2 3 1 -o 0.5 -mm 0 1 wood 1.png\nmap_d wood 1.png\n");
  const auto read = read_scene(file("a.obj"));
  ASSERT_TRUE(read) << read.error().front().text();
  const Scene& scene = read->scene;
  ASSERT_THAT(validate(scene), testing::IsEmpty());
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.texels.size(), 4u);
  const auto& of = scene.meshes[0].materials;
  EXPECT_EQ(scene.materials[of[0]].color, Rgb(1));
  EXPECT_EQ(scene.materials[of[1]].color, Rgb(1, 0, 0));
  EXPECT_EQ(scene.textures[scene.material_texture[of[0]]].wrap_u, TextureWrap::repeat);
  EXPECT_EQ(scene.textures[scene.material_texture[of[1]]].wrap_u, TextureWrap::clamp);
  const TriangleIndices& plain = scene.meshes[0].triangles[0];
  const TriangleIndices& moved = scene.meshes[0].triangles[1];
  EXPECT_EQ(scene.meshes[0].uv[plain[2]], (Uv{1, 1}));
  EXPECT_EQ(scene.meshes[0].uv[moved[0]], (Uv{0.5f, 0}));
  EXPECT_EQ(scene.meshes[0].uv[moved[2]], (Uv{2.5f, 3}));
  ASSERT_EQ(read->notices.size(), 2u);
  EXPECT_THAT(read->notices[0].text(),
              AllOf(HasSubstr("a.mtl:5:1: warning"), HasSubstr("\"-mm\" of map_Kd")));
  EXPECT_THAT(read->notices[1].text(), HasSubstr("1 textures of opacity"));
}

TEST_F(ObjTextures, UnreadableOnesAreReported) {
  std::filesystem::create_directories(folder() / "maps");
  put(file("a.obj"), kSquare);
  put(file("maps/a.png"), "\x89PNG\r\n\x1a\n nonsense");
  put(file("maps/a.mtl"), "newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n");
  const auto read = read_scene(file("a.obj"));
  ASSERT_TRUE(read) << read.error().front().text();
  EXPECT_TRUE(read->scene.textures.empty());
  ASSERT_EQ(read->notices.size(), 2u);
  EXPECT_THAT(read->notices[0].text(), AllOf(HasSubstr("a.mtl:2:1: warning: the texture \"a.png\""),
                                             HasSubstr("broken PNG")));
  EXPECT_THAT(read->notices[1].text(), HasSubstr("a.mtl:4:1: warning: the texture \"b.png\""));
}

}  // namespace
}  // namespace raio::core
