// glTF 2.0, as text and binary: the resulting scene, notices, and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/srgb.h"
#include "data_files.h"
#include "io/image/codecs.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

template <class... T>
std::string packed(T... numbers) {
  std::string out;
  (out.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return out;
}

/// A file under construction; tests replace everything except its buffer.
struct Gltf {
  std::string buffer, views, accessors;
  size_t count = 0;
  std::string primitives = R"({"attributes": {"POSITION": 0}})";
  std::string nodes = R"({"mesh": 0})", roots = "0", more;

  /// Appends an accessor with its own bytes; returns its index.
  size_t add(std::string_view bytes, int component, size_t elements, std::string_view type,
             std::string_view rest = "") {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    const std::string comma = count > 0 ? "," : "";
    views += comma + R"({"buffer": 0, "byteOffset": )" + std::to_string(buffer.size()) +
             R"(, "byteLength": )" + std::to_string(bytes.size()) + "}";
    accessors += comma + R"({"bufferView": )" + std::to_string(count) + R"(, "componentType": )" +
                 std::to_string(component) + R"(, "count": )" + std::to_string(elements) +
                 R"(, "type": ")" + std::string(type) + "\"" + std::string(rest) + "}";
    buffer += bytes;
    return count++;
  }
  std::string json(bool uri = true) const {
    return R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": )" +
           std::to_string(buffer.size()) +
           (uri ? R"(, "uri": "data:application/octet-stream;base64,)" + base64(buffer) + "\""
                : "") +
           R"(}], "bufferViews": [)" + views + R"(], "accessors": [)" + accessors +
           R"(], "meshes": [{"primitives": [)" + primitives + R"(]}], "nodes": [)" + nodes +
           R"(], "scenes": [{"nodes": [)" + roots + "]}]" + more + "}";
  }
  std::string binary() const {
    std::string text = json(false), bytes = buffer;
    text.resize((text.size() + 3) / 4 * 4, ' '), bytes.resize((bytes.size() + 3) / 4 * 4);
    return "glTF" + packed(2u, uint32_t(28 + text.size() + bytes.size()), uint32_t(text.size())) +
           "JSON" + text + packed(uint32_t(bytes.size())) + std::string("BIN\0", 4) + bytes;
  }
};

constexpr int kByte = 5120, kU8 = 5121, kU16 = 5123, kU32 = 5125, kFloat = 5126;

/// A square of four vertices.
Gltf square() {
  Gltf file;
  file.add(packed(0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f), kFloat, 4, "VEC3");
  return file;
}

Scene scene_of(const Gltf& file, const ReadOptions& options = {}) {
  const auto read_it = read(file.json(), "a.gltf", options);
  EXPECT_TRUE(read_it) << read_it.error().front().text();
  if (!read_it) return {};
  EXPECT_THAT(validate(read_it->scene), IsEmpty());
  return read_it->scene;
}

std::string warnings_of(const Gltf& file) {
  const auto read_it = read(file.json(), "a.gltf");
  EXPECT_TRUE(read_it) << read_it.error().front().text();
  std::string all;
  for (const Diagnostic& d : read_it->notices) all += d.text() + "\n";
  return all;
}

TEST(Gltf, TextAndBinaryAreOneScene) {
  Gltf file = square();
  file.add(packed(uint16_t(0), uint16_t(1), uint16_t(3)), kU16, 3, "SCALAR");
  file.primitives = R"({"attributes": {"POSITION": 0}, "indices": 1})";
  const Scene scene = scene_of(file);
  EXPECT_EQ(scene.dialect, Dialect::data);
  ASSERT_EQ(scene.meshes.size(), 1u);
  // Only vertices that are named.
  EXPECT_EQ(scene.meshes[0].positions, Array<Vec3f>({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(scene.materials[0].color, Rgb(1));
  const auto binary = read(file.binary(), "a");  // detected by content
  ASSERT_TRUE(binary) << binary.error().front().text();
  EXPECT_EQ(content_hash(binary->scene), content_hash(scene));
}

TEST(Gltf, IndicesOfAllTypes) {
  std::string hash;
  for (const int type : {kU8, kU16, kU32}) {
    Gltf file = square();
    if (type == kU8) file.add(packed(uint8_t(2), uint8_t(1), uint8_t(3)), type, 3, "SCALAR");
    if (type == kU16) file.add(packed(uint16_t(2), uint16_t(1), uint16_t(3)), type, 3, "SCALAR");
    if (type == kU32) file.add(packed(2u, 1u, 3u), type, 3, "SCALAR");
    file.primitives = R"({"attributes": {"POSITION": 0}, "indices": 1})";
    const Scene scene = scene_of(file);
    EXPECT_EQ(scene.meshes[0].positions[0], Vec3f(0, 1, 0));
    if (hash.empty()) hash = content_hash(scene);
    EXPECT_EQ(content_hash(scene), hash);
  }
}

// The vertices of all triangles.
std::vector<Vec3f> corners(const Scene& scene) {
  std::vector<Vec3f> out;
  for (const TriangleIndices& t : scene.meshes[0].triangles)
    for (const uint32_t corner : t) out.push_back(scene.meshes[0].positions[corner]);
  return out;
}

TEST(Gltf, StripsAndFans) {
  const Vec3f a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(1, 1, 0);
  Gltf file = square();
  file.primitives = R"({"attributes": {"POSITION": 0}, "mode": 5})";
  EXPECT_EQ(corners(scene_of(file)), std::vector({a, b, c, b, d, c}));
  file.primitives = R"({"attributes": {"POSITION": 0}, "mode": 6})";
  EXPECT_EQ(corners(scene_of(file)), std::vector({a, b, c, a, c, d}));
  file.primitives = R"({"attributes": {"POSITION": 0}})";
  EXPECT_EQ(corners(scene_of(file)), std::vector({a, b, c}));  // the fourth is left over
}

TEST(Gltf, DegenerateTrianglesAreReported) {
  Gltf file = square();
  file.primitives = R"({"attributes": {"POSITION": 0}, "indices": 1})";
  file.add(packed(0u, 1u, 1u), kU32, 3, "SCALAR");
  EXPECT_THAT(warnings_of(file), HasSubstr("all triangles have zero area"));
}
TEST(Gltf, PointsAreSpheresAndLinesAreReported) {
  Gltf file = square();
  file.primitives = R"({"attributes": {"POSITION": 0}, "mode": 0},
                       {"attributes": {"POSITION": 0}, "mode": 3})";
  EXPECT_EQ(scene_of(file).spheres.size(), 4u);
  EXPECT_EQ(scene_of(file).spheres[3].center, Vec3f(1, 1, 0));
  EXPECT_THAT(warnings_of(file),
              HasSubstr("left out: primitives of lines (1: /meshes/0/primitives/1)"));
  file.primitives = R"({"attributes": {"POSITION": 0}, "mode": 1})";
  EXPECT_THAT(error(file.json(), "a.gltf"), HasSubstr("primitives are lines"));
}

// By the authors' names, else by JSON pointers; if there are many, the first few.
TEST(Gltf, NoticesCountAndName) {
  Gltf file = square();
  const std::string lens = R"("type": "perspective", "perspective": {"yfov": 1, "znear": 1})";
  file.nodes =
      R"({"mesh": 0}, {"camera": 0}, {"camera": 1, "scale": [0, 1, 1]}, {"camera": 1}, {"camera": 2})";
  file.roots = "2, 0, 1, 3, 4";
  file.more = R"(, "cameras": [{"name": "Front", )" + lens + R"(}, {"name": "T\u000ap", )" + lens +
              "}, {" + lens + R"(}], "animations": [{"name": "Walk"}, {}, {}, {}, {}, {}, {}])";
  EXPECT_EQ(warnings_of(file),
            "a.gltf: left out: animations (7: \"Walk\", /animations/1, /animations/2, "
            "/animations/3, /animations/4, ...)\n"
            "a.gltf: left out: cameras that see nothing (1: \"T\\x0ap\")\n"
            "a.gltf: left out: further cameras (2: \"T\\x0ap\", /cameras/2)\n");
}

TEST(Gltf, QuantizedInterleavedAndNormalizedNumbers) {
  Gltf file;
  const auto vertex = [](int x, int y) {
    return packed(int8_t(x), int8_t(y), int8_t(0), int8_t(0), uint8_t(255), uint8_t(0), uint8_t(51),
                  uint8_t(7));
  };
  file.add(vertex(-128, 127) + vertex(127, 0) + vertex(0, -127), kByte, 3, "VEC3",
           R"(, "normalized": true)");
  file.views.pop_back(), file.views += R"(, "byteStride": 8})";
  file.accessors += R"(, {"bufferView": 0, "byteOffset": 4, "componentType": 5121, "count": 3,
                          "type": "VEC4", "normalized": true})";
  file.primitives = R"({"attributes": {"POSITION": 0, "COLOR_0": 1}})";
  file.more = R"(, "extensionsRequired": ["KHR_mesh_quantization"])";
  const Scene scene = scene_of(file);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions, Array<Vec3f>({{-1, 1, 0}, {1, 0, 0}, {0, -1, 0}}));
  EXPECT_EQ(mesh.colors[0], Rgb(1, 0, 0.2f));
}

TEST(Gltf, SparseAccessors) {
  Gltf file = square();
  file.add(packed(uint8_t(1), uint8_t(3)), kU8, 2, "SCALAR");
  file.add(packed(5.f, 6.f, 7.f, 8.f, 9.f, 10.f), kFloat, 2, "VEC3");
  const std::string sparse =
      R"("count": 2, "indices": {"bufferView": 1, "componentType": 5121}, "values": {"bufferView": 2})";
  file.accessors +=
      R"(, {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {)" +
      sparse + "}}, " + R"({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {)" +
      sparse + "}}";
  file.primitives = R"({"attributes": {"POSITION": 3}, "mode": 5})";
  EXPECT_EQ(scene_of(file).meshes[0].positions,
            Array<Vec3f>({{0, 0, 0}, {5, 6, 7}, {0, 1, 0}, {8, 9, 10}}));
  file.primitives = R"({"attributes": {"POSITION": 4}, "mode": 5})";
  EXPECT_EQ(scene_of(file).meshes[0].positions,
            Array<Vec3f>({{0, 0, 0}, {5, 6, 7}, {0, 0, 0}, {8, 9, 10}}));
}

TEST(Gltf, NodesPlaceMeshes) {
  Gltf file = square();
  // Rotated by 90 degrees around z, scaled by two, then shifted by the parent.
  file.nodes = R"({"children": [1], "translation": [10, 0, 0], "scale": [2, 2, 2]},
                  {"mesh": 0, "rotation": [0, 0, 0.70710678118, 0.70710678118]})";
  const Scene one = scene_of(file);
  EXPECT_NEAR(one.meshes[0].positions[1].y, 2, 1e-6);
  EXPECT_NEAR(one.meshes[0].positions[2].x, 8, 1e-6);
  EXPECT_NEAR(one.meshes[0].positions[0].x, 10, 1e-6);
  file.nodes = R"({"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]})";
  EXPECT_EQ(scene_of(file).meshes[0].positions[0], Vec3f(5, 6, 7));
}

TEST(Gltf, AMeshOfSeveralNodesIsStoredOnce) {
  Gltf file = square();
  file.nodes = R"({"mesh": 0}, {"mesh": 0, "translation": [3, 0, 0]},
                  {"mesh": 0, "scale": [-1, 1, 1]}, {"mesh": 0, "scale": [0, 0, 0]})";
  file.roots = "0, 1, 2, 3";
  const Scene copies = scene_of(file, {.instances = true});
  ASSERT_EQ(copies.prototypes.size(), 1u);
  ASSERT_EQ(copies.instances.size(), 3u);
  EXPECT_EQ(copies.instances[1].matrix[3], 3);
  EXPECT_THAT(warnings_of(file), HasSubstr("left out: meshes with a scale of 0 (1: /meshes/0)"));
  const Scene flat = scene_of(file);
  EXPECT_TRUE(flat.instances.empty());
  EXPECT_EQ(flat.primitive_count(), 3u);
  EXPECT_EQ(bounds(flat).lo, bounds(copies).lo);
}

std::string one_pixel_png(Rgb color) {
  Image image(1, 1);
  image.at(0, 0) = color;
  return *encode_png(image, {});
}

Gltf textured() {
  Gltf file = square();
  file.add(packed(0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.25f, 0.5f), kFloat, 4, "VEC2");
  file.primitives =
      R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1, "TEXCOORD_2": 1}, "material": 0, "mode": 5})";
  file.more = R"(, "materials": [{"alphaMode": "BLEND", "pbrMetallicRoughness": {
      "baseColorFactor": [1, 0.5, 0.25, 0.75], "baseColorTexture": {"index": 0}}}],
      "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33648}],
      "images": [{"uri": "data:image/png;base64,)" +
              base64(one_pixel_png(Rgb(1, 0, 0))) + "\"}]";
  return file;
}

void replace(std::string& text, std::string_view from, std::string_view to) {
  ASSERT_NE(text.find(from), std::string::npos) << from;
  text.replace(text.find(from), from.size(), to);
}

TEST(Gltf, MaterialsAndTextures) {
  Gltf file = textured();
  const Scene scene = scene_of(file);
  EXPECT_EQ(scene.materials[0].color, Rgb(1, 0.5f, 0.25f));
  EXPECT_EQ(scene.material_opacity[0], 0.75f);
  ASSERT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(scene.textures[0].wrap_u, TextureWrap::clamp);
  EXPECT_EQ(scene.textures[0].wrap_v, TextureWrap::mirror);
  EXPECT_EQ(scene.texels, Array<uint32_t>({0x0000ff}));
  EXPECT_EQ(scene.meshes[0].uv, Array<Uv>({{0, 1}, {1, 1}, {0, 0}, {0.25f, 0.5f}}));
  EXPECT_EQ(warnings_of(file), "");
  replace(file.more, "BLEND", "OPAQUE");
  EXPECT_TRUE(scene_of(file).material_opacity.empty());
  EXPECT_EQ(warnings_of(file), "");
}

TEST(Gltf, TexturesMayBeMoved) {
  Gltf file = textured();
  replace(file.more, R"("index": 0)", R"("index": 0, "texCoord": 1, "extensions": {
      "KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 1.5707963267948966,
      "scale": [2, 3], "texCoord": 2}})");
  // KHR_texture_transform: shift * rotation * scale, with v downwards.
  const Scene scene = scene_of(file);
  EXPECT_NEAR(scene.meshes[0].uv[1][0], 0.5, 1e-6);
  EXPECT_NEAR(scene.meshes[0].uv[1][1], 1 - (0.25 - 2), 1e-6);
  EXPECT_NEAR(scene.meshes[0].uv[2][0], 0.5 + 3, 1e-6);
}

TEST(Gltf, UnreadablePicturesAreReported) {
  Gltf file = textured();
  replace(file.more, "data:image/png;base64,", "data:image/png;base64,AAAA");
  EXPECT_THAT(warnings_of(file), HasSubstr("(1: /images/0: expected a PNG or JPEG picture)"));
  EXPECT_TRUE(scene_of(file).material_texture.empty());
  file = textured();
  replace(file.more, "data:image", "https://example.org/data:image");
  EXPECT_THAT(warnings_of(file), HasSubstr("is not a local file"));
}

TEST(Gltf, SkinsPoseMeshes) {
  Gltf file = square();
  // The upper vertices follow the second joint, which is 1 higher than its inverse matrix says.
  file.add(packed(uint8_t(0), uint8_t(0), uint8_t(0), uint8_t(0), uint8_t(0), uint8_t(0),
                  uint8_t(0), uint8_t(0), uint8_t(1), uint8_t(0), uint8_t(0), uint8_t(0),
                  uint8_t(1), uint8_t(0), uint8_t(0), uint8_t(0)),
           kU8, 4, "VEC4");
  file.add(packed(1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 2.f, 0.f, 0.f, 0.f),
           kFloat, 4, "VEC4");
  file.add(packed(1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f,
                  1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, -1.f, 0.f, 1.f),
           kFloat, 2, "MAT4");
  file.primitives = R"({"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "mode": 5})";
  // The scale of the mesh's own node does not count.
  file.nodes = R"({"mesh": 0, "skin": 0, "scale": [100, 100, 100]}, {"children": [2]},
                  {"translation": [0, 2, 0]})";
  file.roots = "0, 1";
  file.more = R"(, "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}])";
  const Scene scene = scene_of(file);
  EXPECT_EQ(bounds(scene).lo, Vec3f(0, 0, 0));
  EXPECT_EQ(bounds(scene).hi, Vec3f(1, 2, 0));
  EXPECT_THAT(warnings_of(file), IsEmpty());
  Gltf bare = file;
  replace(bare.primitives, ", \"JOINTS_0\": 1, \"WEIGHTS_0\": 2", "");
  EXPECT_THAT(
      warnings_of(bare),
      HasSubstr(
          "the pose of primitives without JOINTS_0 and WEIGHTS_0 (1: /meshes/0/primitives/0)"));
  replace(file.more, "[1, 2]", "[1, 2, 0]");
  EXPECT_THAT(read(file.json(), "a.gltf").error().front().text(), HasSubstr("/skins/0"));
}

TEST(Gltf, MeshesRestInTheirDefaultWeights) {
  Gltf file = square();
  file.add(packed(0.f, 0.f, 4.f, 0.f, 0.f, 4.f, 0.f, 0.f, 4.f, 0.f, 0.f, 4.f), kFloat, 4, "VEC3");
  file.primitives = R"({"attributes": {"POSITION": 0}, "targets": [{"POSITION": 1}], "mode": 5})";
  EXPECT_EQ(bounds(scene_of(file)).hi, Vec3f(1, 1, 0));
  file.nodes = R"({"mesh": 0, "weights": [0.5]}, {"mesh": 0})";
  file.roots = "0, 1";
  const Scene scene = scene_of(file);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(bounds(scene).lo, Vec3f(0, 0, 0));
  EXPECT_EQ(bounds(scene).hi, Vec3f(1, 1, 2));
}

TEST(Gltf, ExtensionInstancesAreInstances) {
  Gltf file = square();
  file.add(packed(0.f, 0.f, 0.f, 5.f, 0.f, 0.f), kFloat, 2, "VEC3");
  file.add(packed(1.f, 1.f, 1.f, 2.f, 2.f, 2.f), kFloat, 2, "VEC3");
  file.primitives = R"({"attributes": {"POSITION": 0}, "mode": 5})";
  file.nodes = R"({"mesh": 0, "translation": [0, 0, 1], "extensions": {"EXT_mesh_gpu_instancing":
      {"attributes": {"TRANSLATION": 1, "SCALE": 2}}}})";
  file.more = R"(, "extensionsRequired": ["EXT_mesh_gpu_instancing"])";
  const Scene scene = scene_of(file, {.instances = true});
  EXPECT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(bounds(scene).lo, Vec3f(0, 0, 1));
  EXPECT_EQ(bounds(scene).hi, Vec3f(7, 2, 1));
  EXPECT_EQ(warnings_of(file), "");
  replace(file.nodes, "\"mesh\": 0", "\"mesh\": 0, \"skin\": 0");
  file.more += R"(, "skins": [{"joints": [0]}])";
  EXPECT_THAT(warnings_of(file), HasSubstr("left out: instances of skinned meshes (1: /meshes/0)"));
}

TEST(Gltf, OrthographicCamerasSeeTheirHeight) {
  Gltf file = square();
  file.nodes += R"(, {"camera": 0, "translation": [0, 2, 9]})";
  file.roots = "0, 1";
  file.more = R"(, "cameras": [{"type": "orthographic",
      "orthographic": {"xmag": 6, "ymag": 3, "znear": 0.1, "zfar": 100}}])";
  const Camera camera = scene_of(file).camera;
  EXPECT_EQ(camera.projection, Projection::orthographic);
  EXPECT_EQ(camera.from, Vec3f(0, 2, 9));
  EXPECT_EQ(camera.at, Vec3f(0, 2, 0));
  constexpr float kDegrees = 180 / 3.14159265f;
  EXPECT_FLOAT_EQ(camera.fov_deg, 2 * std::atan(3 / 9.f) * kDegrees);
  EXPECT_FLOAT_EQ(camera.horizontal_fov_deg, 2 * std::atan(6 / 9.f) * kDegrees);
  EXPECT_EQ(camera.height, 600);
}

TEST(Gltf, ExtensionsOfMaterialsMayBeRequired) {
  Gltf file = square();
  file.primitives = R"({"attributes": {"POSITION": 0}, "mode": 5, "material": 0})";
  file.more = R"(, "extensionsUsed": ["KHR_materials_unlit"],
      "extensionsRequired": ["KHR_materials_unlit", "KHR_materials_pbrSpecularGlossiness"],
      "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}, "extensions":
      {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 0.5, 0, 1]}}}])";
  const Scene scene = scene_of(file);
  EXPECT_EQ(scene.materials[scene.meshes[0].materials[0]].color, Rgb(1, 0.5, 0));
  EXPECT_EQ(scene.standard_surface_of(0)->is_unlit, 0);  // no material has it
  EXPECT_EQ(warnings_of(file), "");
}

/// A square with this material; its JSON may use texture 0.
Gltf with_material(std::string_view material) {
  Gltf file = textured();
  const size_t from = file.more.find("[{"), to = file.more.find("],\n");
  file.more.replace(from, to - from, "[" + std::string(material));
  return file;
}

StandardSurface surface_of(std::string_view material) {
  const Scene scene = scene_of(with_material(material));
  const StandardSurface* const found = scene.standard_surface_of(scene.meshes[0].materials[0]);
  EXPECT_TRUE(found);
  return found ? *found : StandardSurface{};
}

TEST(Gltf, MaterialsAreMetalsByDefault) {
  const StandardSurface usual{.metallic = 1, .is_two_sided = 0};
  EXPECT_EQ(surface_of("{}"), usual);
  EXPECT_EQ(surface_of(R"({"pbrMetallicRoughness": {}})"), usual);
  const Scene none = scene_of(square());
  EXPECT_EQ(*none.standard_surface_of(none.meshes[0].materials[0]), usual);
  EXPECT_EQ(none.materials[0].ior, 1.5f);
  // For integrators that do not know standard surfaces.
  EXPECT_EQ(none.materials[0].transmission, 0);
  EXPECT_EQ(none.materials[0].ks, 0);
}

TEST(Gltf, ParametersOfSurfaces) {
  const StandardSurface core = surface_of(R"({"doubleSided": true, "pbrMetallicRoughness":
      {"metallicFactor": 0.25, "roughnessFactor": 0.5, "metallicRoughnessTexture": {"index": 0}},
      "normalTexture": {"index": 0, "scale": -0.5}, "emissiveFactor": [1, 0.5, 0.25],
      "emissiveTexture": {"index": 0},
      "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}}})");
  EXPECT_EQ(core, (StandardSurface{.metallic = 0.25f,
                                   .roughness = 0.5f,
                                   .emission = {8, 4, 2},
                                   .normal_scale = -0.5f,
                                   .metallic_roughness_texture = 0,
                                   .normal_texture = 0,
                                   .emission_texture = 0}));
  const StandardSurface glass = surface_of(R"({"extensions": {
      "KHR_materials_transmission": {"transmissionFactor": 0.75, "transmissionTexture": {"index": 0}},
      "KHR_materials_volume": {"thicknessFactor": 2, "attenuationColor": [0.5, 1, 0.25],
                               "attenuationDistance": 3, "thicknessTexture": {"index": 0}},
      "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [2, 1, 0.5]}}})");
  EXPECT_EQ(glass, (StandardSurface{.metallic = 1,
                                    .specular = 0.5f,
                                    .specular_color = {2, 1, 0.5f},
                                    .transmission = 0.75f,
                                    .is_thin = 0,
                                    .attenuation_color = {0.5f, 1, 0.25f},
                                    .attenuation_distance = 3,
                                    .is_two_sided = 0,
                                    .transmission_texture = 0}));
  const StandardSurface layers = surface_of(R"({"extensions": {
      "KHR_materials_clearcoat": {"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25},
      "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.75},
      "KHR_materials_volume": {}}})");
  EXPECT_EQ(layers, (StandardSurface{.metallic = 1,
                                     .coat = 0.5f,
                                     .coat_roughness = 0.25f,
                                     .sheen_color = {0.5f, 0.25f, 1},
                                     .sheen_roughness = 0.75f,
                                     .is_two_sided = 0}));
}

TEST(Gltf, IndicesOfRefraction) {
  const auto with = [](std::string_view ior) {
    return scene_of(
        with_material(R"({"extensions": {"KHR_materials_ior": {)" + std::string(ior) + "}}}"));
  };
  EXPECT_EQ(with("").materials[0].ior, 1.5f);
  EXPECT_EQ(with("\"ior\": 1.25").materials[0].ior, 1.25f);
  // 0 reflects everything: 0.04 times the specular colour is 1.
  EXPECT_EQ(with("\"ior\": 0").materials[0].ior, 1.5f);
  EXPECT_FLOAT_EQ(with("\"ior\": 0").standard_surface_of(0)->specular_color.x, 25);
}

TEST(Gltf, SpecularGlossinessIsADielectric) {
  const StandardSurface s = surface_of(R"({"extensions": {"KHR_materials_pbrSpecularGlossiness":
      {"specularFactor": [0.04, 0.5, 1], "glossinessFactor": 0.75}}})");
  EXPECT_EQ(s.metallic, 0);
  EXPECT_EQ(s.roughness, 0.25f);
  EXPECT_FLOAT_EQ(s.specular_color.x, 1);
  EXPECT_FLOAT_EQ(s.specular_color.z, 25);
}

TEST(Gltf, AlphaModes) {
  EXPECT_EQ(surface_of(R"({"alphaCutoff": 0.25})").alpha_mode, AlphaMode::opaque);
  EXPECT_EQ(surface_of(R"({"alphaMode": "BLEND"})").alpha_mode, AlphaMode::blend);
  EXPECT_EQ(surface_of(R"({"alphaMode": "MASK"})").alpha_cutoff, 0.5f);
  const std::string_view mask = R"({"alphaMode": "MASK", "alphaCutoff": 0.25,
      "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}})";
  EXPECT_EQ(surface_of(mask).alpha_mode, AlphaMode::mask);
  // The texture's alpha is compared, so the factor's divides the cutoff.
  EXPECT_EQ(surface_of(mask).alpha_cutoff, 0.5f);
  EXPECT_TRUE(scene_of(with_material(mask)).material_opacity.empty());
  EXPECT_GT(surface_of(R"({"alphaMode": "MASK", "pbrMetallicRoughness":
      {"baseColorFactor": [1, 1, 1, 0]}})")
                .alpha_cutoff,
            1);
}

TEST(Gltf, UnlitMaterialsEmitTheirColour) {
  const std::string_view material = R"({"emissiveFactor": [1, 1, 1], "doubleSided": true,
      "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1], "roughnessFactor": 0.25,
      "baseColorTexture": {"index": 0}}, "normalTexture": {"index": 0},
      "extensions": {"KHR_materials_unlit": {}}})";
  EXPECT_EQ(surface_of(material),
            (StandardSurface{.emission = {1, 0.5f, 0.25f}, .is_unlit = 1, .emission_texture = 0}));
  EXPECT_EQ(scene_of(with_material(material)).materials[0].color, Rgb(1, 0.5f, 0.25f));
  EXPECT_TRUE(scene_of(with_material(material)).has_emission());
}

TEST(Gltf, TexturesThatDoNotFitAreReported) {
  const std::string_view lost = R"({"name": "Paint", "extensions": {
      "KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatTexture": {"index": 0},
                                  "clearcoatNormalTexture": {"index": 0}},
      "KHR_materials_specular": {"specularColorTexture": {"index": 0}},
      "KHR_materials_sheen": {"sheenRoughnessTexture": {"index": 0}}}})";
  EXPECT_EQ(warnings_of(with_material(lost)),
            "a.gltf: left out: textures of specular (1: \"Paint\")\n"
            "a.gltf: left out: textures of clearcoat (2: \"Paint\")\n"
            "a.gltf: left out: textures of sheen (1: \"Paint\")\n");
  EXPECT_EQ(surface_of(lost).coat, 0);  // else it would be everywhere
  EXPECT_EQ(surface_of(R"({"extensions": {"KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1],
      "sheenColorTexture": {"index": 0}}}})")
                .sheen_color,
            Rgb());
  // A mesh has the coordinates of one texture.
  const std::string_view moved = R"({"emissiveFactor": [1, 1, 1], "pbrMetallicRoughness":
      {"metallicRoughnessTexture": {"index": 0, "texCoord": 2}},
      "normalTexture": {"index": 0, "texCoord": 2}, "emissiveTexture": {"index": 0}})";
  EXPECT_EQ(warnings_of(with_material(moved)),
            "a.gltf: left out: emission textures with other coordinates than the material's first "
            "texture (1: /materials/0)\n");
  const StandardSurface s = surface_of(moved);
  EXPECT_EQ(s.normal_texture, 0u);
  EXPECT_EQ(s.emission_texture, kNoTexture);
  EXPECT_EQ(s.emission, Rgb());  // else everything would glow
  // Nothing is read that has no effect.
  EXPECT_EQ(surface_of(R"({"emissiveTexture": {"index": 0}})").emission_texture, kNoTexture);
}

TEST(Gltf, UnsoundMaterialsAreRefused) {
  const auto refusal = [](const std::string& material) {
    return error(with_material(material).json(), "a.gltf");
  };
  EXPECT_THAT(refusal(R"({"pbrMetallicRoughness": {"metallicFactor": 1.5}})"),
              HasSubstr("/materials/0/pbrMetallicRoughness/metallicFactor: expected a number from "
                        "0 to 1, found 1.5"));
  EXPECT_THAT(refusal(R"({"normalTexture": {"index": 1}})"),
              HasSubstr("/materials/0/normalTexture/index: expected a whole number from 0 to 0"));
  EXPECT_THAT(refusal(R"({"emissiveFactor": [0, -1, 0]})"),
              HasSubstr("/materials/0/emissiveFactor/1: expected"));
  EXPECT_THAT(refusal(R"({"emissiveFactor": [0, 1]})"), HasSubstr("expected 3 numbers"));
  EXPECT_THAT(refusal(R"({"alphaMode": "MASK", "alphaCutoff": -1})"), HasSubstr("alphaCutoff"));
  EXPECT_THAT(refusal(R"({"doubleSided": 1})"), HasSubstr("doubleSided: expected true or false"));
  EXPECT_THAT(
      refusal(R"({"extensions": {"KHR_materials_ior": {"ior": 0.5}}})"),
      HasSubstr("/materials/0/extensions/KHR_materials_ior/ior: expected 0, or a number of at "));
  for (const char* wrong : {R"("KHR_materials_transmission": {"transmissionFactor": 2})",
                            R"("KHR_materials_volume": {"thicknessFactor": -1})",
                            R"("KHR_materials_clearcoat": {"clearcoatFactor": "x"})",
                            R"("KHR_materials_sheen": {"sheenColorFactor": 1})",
                            R"("KHR_materials_specular": {"specularFactor": -1})",
                            R"("KHR_materials_emissive_strength": {"emissiveStrength": 1e20})"})
    EXPECT_THAT(refusal(R"({"extensions": {)" + std::string(wrong) + "}}"),
                HasSubstr("/materials/0/extensions/KHR_materials_"))
        << wrong;
}

/// A square under a light, 5 above.
Gltf with_light(std::string_view light) {
  Gltf file = square();
  file.nodes += R"(, {"translation": [0, 5, 0], "rotation": [-0.70710678118, 0, 0, 0.70710678118],
      "scale": [2, 2, 2], "extensions": {"KHR_lights_punctual": {"light": 0}}})";
  file.roots = "0, 1";
  file.more = R"(, "extensionsRequired": ["KHR_lights_punctual"],
      "extensions": {"KHR_lights_punctual": {"lights": [)" +
              std::string(light) + "]}}";
  return file;
}

TEST(Gltf, LightsArePhysical) {
  Gltf file = with_light(R"({"type": "spot", "color": [1, 0.5, 0], "intensity": 40, "range": 9,
      "spot": {"innerConeAngle": 0.5235987755982988, "outerConeAngle": 0.7853981633974483}})");
  Scene scene = scene_of(file);
  ASSERT_EQ(scene.physical_lights.size(), 1u);
  PhysicalLight light = scene.physical_lights[0];
  EXPECT_EQ(light.kind, LightKind::spot);
  EXPECT_EQ(light.color, Rgb(40, 20, 0));
  EXPECT_EQ(light.position, Vec3f(0, 5, 0));
  EXPECT_LT(length(light.direction - Vec3f(0, -1, 0)), 1e-6f);
  EXPECT_FLOAT_EQ(light.opening, 90);
  EXPECT_FLOAT_EQ(light.falloff, 15);
  EXPECT_EQ(warnings_of(file), "");
  // From the axis to 45 degrees.
  light = scene_of(with_light(R"({"type": "spot", "spot": {}})")).physical_lights[0];
  EXPECT_EQ(light.color, Rgb(1));
  EXPECT_FLOAT_EQ(light.opening, 90);
  EXPECT_FLOAT_EQ(light.falloff, 45);
  EXPECT_EQ(scene_of(with_light(R"({"type": "point"})")).physical_lights[0].kind, LightKind::point);
  light = scene_of(with_light(R"({"type": "directional", "intensity": 3})")).physical_lights[0];
  EXPECT_EQ(light.kind, LightKind::directional);
  EXPECT_EQ(light.color, Rgb(3));
}

TEST(Gltf, BrightLightsAreReported) {
  // 256 pi at a distance of 5 - 0.5 from the middle, up to the small offset along x.
  EXPECT_EQ(warnings_of(with_light(R"({"type": "point", "intensity": 17000})")),
            "a.gltf: warning: its lights are about 2^8 times too bright for a display; exposure -8 "
            "shows what they light\n");
  EXPECT_EQ(warnings_of(with_light(R"({"type": "point", "intensity": 170})")), "");
  EXPECT_THAT(warnings_of(with_light(R"({"type": "directional", "intensity": 100})")),
              HasSubstr("about 2^4 times"));
}

TEST(Gltf, UnsoundLightsAreRefusedOrReported) {
  const auto refusal = [](std::string_view light) {
    return error(with_light(light).json(), "a.gltf");
  };
  constexpr std::string_view kFirst = "/extensions/KHR_lights_punctual/lights/0/";
  EXPECT_THAT(refusal(R"({"type": "sun"})"),
              HasSubstr(std::string(kFirst) + "type: expected directional, point or spot"));
  EXPECT_THAT(refusal(R"({"type": "point", "intensity": -1})"),
              HasSubstr(std::string(kFirst) + "intensity: expected a number from 0"));
  EXPECT_THAT(refusal(R"({"type": "spot", "spot": {"outerConeAngle": 2}})"),
              HasSubstr(std::string(kFirst) + "spot/outerConeAngle"));
  Gltf file = with_light(R"({"type": "point"})");
  replace(file.nodes, "\"light\": 0", "\"light\": 1");
  EXPECT_THAT(error(file.json(), "a.gltf"),
              HasSubstr("/nodes/1/extensions/KHR_lights_punctual/light: expected a whole number"));
  file = with_light(R"({"type": "point", "name": "Lamp"})");
  replace(file.nodes, "[2, 2, 2]", "[2, 2, 0]");
  EXPECT_EQ(warnings_of(file), "a.gltf: left out: lights with a scale of 0 (1: \"Lamp\")\n");
}

TEST(Gltf, TheCameraIsThatOfTheFile) {
  Gltf file = square();
  file.nodes += R"(, {"camera": 0, "translation": [0, 2, 9]})";
  file.roots = "0, 1";
  file.more = R"(, "cameras": [{"type": "perspective",
                                "perspective": {"yfov": 1.5707963267948966, "aspectRatio": 2}}])";
  const Camera camera = scene_of(file).camera;
  EXPECT_EQ(camera.from, Vec3f(0, 2, 9));
  EXPECT_EQ(camera.at, Vec3f(0, 2, 0));
  EXPECT_FLOAT_EQ(camera.fov_deg, 90);
  EXPECT_NEAR(camera.horizontal_fov_deg, 126.8699f, 1e-3f);  // twice as wide as high
  EXPECT_EQ(camera.width, 1200);
  EXPECT_EQ(camera.height, 600);
}

TEST(Gltf, UnknownFeaturesAreRefusedOrReported) {
  Gltf file = square();
  file.more = R"(, "extensionsUsed": ["KHR_materials_iridescence"], "animations": [{}])";
  EXPECT_THAT(warnings_of(file),
              AllOf(HasSubstr("left out: extensions (1: \"KHR_materials_iridescence\")"),
                    HasSubstr("left out: animations (1: /animations/0)")));
  file.more = R"(, "extensionsRequired": ["KHR_texture_transform", "KHR_draco_mesh_compression"])";
  EXPECT_THAT(error(file.json(), "a.gltf"),
              AllOf(HasSubstr("/extensionsRequired/1"), HasSubstr("\"KHR_draco_mesh_compression\""),
                    HasSubstr("without mesh compression")));
  EXPECT_THAT(error(R"({"asset": {"version": "1.0"}, "meshes": {}})", "a.gltf"),
              HasSubstr("a scene in glTF 1; Raio reads glTF 2.0"));
  EXPECT_THAT(error(R"({"asset": {"version": "1.0"}})", "a.gltf"), HasSubstr("in glTF 1.0;"));
  EXPECT_THAT(error(R"({"meshes": {}, "accessors": {}})", "a.gltf"), HasSubstr("in glTF 1;"));
  EXPECT_THAT(error("glTF" + packed(1u, 20u, 0u, 0u), "a.glb"),
              HasSubstr("binary scene in glTF 1"));
}

TEST(Gltf, BrokenFilesAreRefusedWithALocation) {
  const auto with = [](std::string_view from, std::string_view to, Gltf file = square()) {
    std::string text = file.json();
    replace(text, from, to);
    return error(text, "a.gltf");
  };
  EXPECT_THAT(with("\"buffers\"", ",\n x"), HasSubstr("a.gltf:1:"));
  EXPECT_THAT(with("\"buffers\"", "\"a\": 1e999, \"buffers\""),
              HasSubstr("a.gltf: error: broken JSON: a number is too large"));
  EXPECT_THAT(with("\"count\": 4", "\"count\": -4"),
              HasSubstr("/accessors/0/count: expected a whole number"));
  EXPECT_THAT(with("\"count\": 4", "\"count\": 4.5"), HasSubstr("found 4.5"));
  EXPECT_THAT(with("\"count\": 4", "\"count\": 4000000000"),
              HasSubstr("/accessors/0: 4000000000 elements of 12 bytes from byte 0 do not fit"));
  EXPECT_THAT(with("\"bufferView\": 0", "\"bufferView\": 3"),
              HasSubstr("/accessors/0/bufferView: expected a whole number from 0 to 0, found 3"));
  EXPECT_THAT(with("5126", "5127"), HasSubstr("/accessors/0/componentType: expected 5120"));
  EXPECT_THAT(with("VEC3", "VEC2"), HasSubstr("/accessors/0/type: expected VEC3, found VEC2"));
  EXPECT_THAT(with("\"byteOffset\": 0", "\"byteOffset\": 8"),
              HasSubstr("/bufferViews/0: bytes 8 to 56 of buffer 0, which has 48"));
  EXPECT_THAT(with("base64,AAAA", "base64,A*AA"), HasSubstr("/buffers/0/uri: expected a digit"));
  EXPECT_THAT(with("base64,AAAA", "base64,"),
              HasSubstr("/buffers/0: it has 45 bytes, expected 48"));
  EXPECT_THAT(with("\"POSITION\": 0", "\"POSITION\": \"x\""),
              HasSubstr("/meshes/0/primitives/0/attributes/POSITION: expected"));
  EXPECT_THAT(with("{\"mesh\": 0}", "{\"children\": [0]}"), HasSubstr("reached more than once"));
  EXPECT_EQ(with("\"bufferView\": 0, ", ""), "no error");  // an accessor without a buffer is zero
  Gltf zeros = square();
  replace(zeros.accessors, "\"bufferView\": 0, ", "");
  replace(zeros.accessors, "\"count\": 4", "\"count\": 400000000");
  EXPECT_THAT(error(zeros.json(), "a.gltf"), HasSubstr("exceed the size of all buffers"));
  Gltf far = square();
  far.nodes = R"({"mesh": 0, "translation": [1e25, 0, 0], "scale": [1e25, 1, 1]})";
  EXPECT_THAT(error(far.json(), "a.gltf"), HasSubstr("has no primitives"));
  Gltf out = square();
  out.add(packed(uint8_t(0), uint8_t(1), uint8_t(9)), kU8, 3, "SCALAR");
  out.primitives = R"({"attributes": {"POSITION": 0}, "indices": 1})";
  EXPECT_THAT(error(out.json(), "a.gltf"),
              HasSubstr("/accessors/1, element 2 (byte 2): index 9 of 4 vertices"));
  Gltf nan;
  nan.add(packed(0.f, 0.f, std::nanf(""), 1.f, 0.f, 0.f, 0.f, 1.f, 0.f), kFloat, 3, "VEC3");
  EXPECT_THAT(error(nan.json(), "a.gltf"), HasSubstr("/accessors/0, element 0"));
}

TEST(Gltf, CutBinaryFilesAreRefused) {
  const std::string whole = square().binary();
  for (size_t size = 4; size < whole.size(); size += 3)
    EXPECT_THAT(error(std::string_view(whole).substr(0, size), "a.glb"), HasSubstr("broken .glb"));
  std::string other = whole;
  other[16] = 'X';
  EXPECT_THAT(error(other, "a.glb"), HasSubstr("its first chunk, at byte 12, is not JSON"));
}

/// After a change of any byte: an error or a valid scene.
TEST(Gltf, ChangedBytesEndSoundly) {
  const std::string whole = textured().binary();
  for (size_t at = 0; at < whole.size(); ++at)
    for (const char c : {'\0', '9', '"', '\xff'}) {
      std::string changed = whole;
      changed[at] = c;
      const auto scene = read(changed, "a.glb");
      EXPECT_THAT(scene ? validate(scene->scene) : std::vector<std::string>(), IsEmpty()) << at;
    }
}

using GltfFiles = TemporaryFolder;

TEST_F(GltfFiles, BuffersAndPicturesAreExternal) {
  Gltf file = textured();
  put(this->file("my square.bin"), file.buffer);
  put(this->file("red.png"), one_pixel_png(Rgb(1, 0, 0)));
  std::string text = file.json(false);
  replace(text, "\"byteLength\": 80}]", "\"byteLength\": 80, \"uri\": \"my%20square.bin\"}]");
  const size_t from = text.find("data:image"), to = text.find('"', from);
  text.replace(from, to - from, "red.png");
  put(this->file("a.gltf"), text);
  const auto beside = read_scene(this->file("a.gltf"));
  ASSERT_TRUE(beside) << beside.error().front().text();
  EXPECT_EQ(content_hash(beside->scene), content_hash(scene_of(file)));
  std::filesystem::remove(this->file("my square.bin"));
  const auto missing = read_scene(this->file("a.gltf"));
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().front().text(),
              HasSubstr("/buffers/0/uri: \"my square.bin\": the file does not exist"));
}

TEST(Gltf, TheSceneOfTheManualIsRead) {
  const auto crates = read_scene(std::filesystem::path(RAIO_SOURCE_DIR) / "scenes/crates.gltf",
                                 {.instances = true});
  ASSERT_TRUE(crates) << crates.error().front().text();
  EXPECT_THAT(crates->notices, IsEmpty());
  EXPECT_EQ(crates->scene.textures.size(), 2u);
  EXPECT_EQ(crates->scene.instances.size(), 6u);
  EXPECT_EQ(crates->scene.primitive_count(), 74u);
}

}  // namespace
}  // namespace raio::core
