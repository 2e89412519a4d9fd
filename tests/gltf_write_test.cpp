// Scenes written as glTF 2.0: read back by Raio's reader, and the parts of the JSON that it
// ignores.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/srgb.h"
#include "data_files.h"
#include "io/mesh/gltf_parts.h"
#include "io/mesh/write.h"
#include "program.h"
#include "rich_scene.h"

namespace raio::core {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

std::string written(const Scene& scene, GltfForm form = GltfForm::text) {
  EXPECT_THAT(validate(scene), IsEmpty());
  const auto text = write_gltf(scene, form, "a test");
  EXPECT_TRUE(text) << text.error();
  return text.value_or("");
}

json json_of(const Scene& scene) { return json::parse(written(scene)); }

Scene read_again(const Scene& scene) {
  const std::string text = written(scene);
  const auto again = read(text, "a.gltf");
  EXPECT_TRUE(again) << again.error().front().text();
  if (!again) return {};
  EXPECT_THAT(validate(again->scene), IsEmpty());
  return again->scene;
}

void look(Scene& scene, Vec3f from, Vec3f at, float fov_deg) {
  scene.camera.from = from, scene.camera.at = at, scene.camera.fov_deg = fov_deg;
}

Scene data_scene() {
  Scene scene;
  scene.dialect = Dialect::data;
  scene.materials = {{.color = Rgb(0.5f, 0.25f, 1), .kd = 1}};
  look(scene, {1, 2, 9}, {0.5f, 0.25f, 0}, 30);
  return scene;
}

Scene with_triangle(Scene scene = data_scene()) {
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{0, 1, 2}};
  scene.triangle_materials = {0};
  return scene;
}

// Position, normal, colour and texture coordinates at the vertices of each triangle, sorted.
using Face = std::array<std::array<float, 11>, 3>;
std::vector<Face> faces_of(const Scene& scene) {
  std::vector<Face> out;
  for (const Mesh& m : scene.meshes)
    for (size_t i = 0; i < m.triangles.size(); ++i) {
      Face& face = out.emplace_back();
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t v = m.triangles[i][k];
        const uint32_t at = m.normal_indices.empty() ? v : m.normal_indices[i][k];
        const Vec3f p = m.positions[v];
        const Vec3f n = m.normals.empty() || at == kNoNormal ? Vec3f() : m.normals[at];
        const Rgb own = scene.materials[m.materials[m.materials.size() == 1 ? 0 : i]].color;
        const Rgb c = m.colors.empty() ? own : m.colors[v] * own;
        const Uv uv = m.uv.empty() ? Uv{} : m.uv[v];
        face[k] = {p.x, p.y, p.z, n.x, n.y, n.z, c.x, c.y, c.z, uv[0], uv[1]};
      }
    }
  std::ranges::sort(out);
  return out;
}

// A mesh of three faces, one of them flat, and two materials, one with a texture.
Scene mesh_scene() {
  Scene scene = data_scene();
  scene.add_material({.color = Rgb(1, 0.5f, 0.125f), .kd = 1}, Rgb(1), 0, 1, 1);
  scene.texels = {0x0000ff, 0x80ff00, 0x20c0a0, 0xffffff, 0x405060, 0x102030};
  scene.textures = {{0, 2, 3},
                    {.first = 2,
                     .width = 4,
                     .height = 1,
                     .wrap_u = TextureWrap::clamp,
                     .wrap_v = TextureWrap::mirror}};
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0.1f}, {1, 1, 0.3f}, {0, 1, -7}};
  mesh.normals = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
  mesh.uv = {{0, 0}, {1, 0.25f}, {-3, 1.5f}, {0, 1}};
  mesh.colors = {{1, 0, 0}, {0, 0.5f, 0}, {0.1f, 0.2f, 0.3f}, {1, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 2, 3}};
  mesh.normal_indices = {{0, 0, 1}, {kNoNormal, kNoNormal, kNoNormal}, {2, 1, 0}};
  mesh.materials = {1, 0, 1};
  scene.meshes = {mesh};
  return scene;
}

TEST(GltfWrite, MeshesReadBack) {
  const Scene scene = mesh_scene(), again = read_again(scene);
  EXPECT_EQ(faces_of(again), faces_of(scene));
  EXPECT_EQ(not_in_gltf(scene), "");
  // Faces are parted by material, and by whether they are flat.
  EXPECT_EQ(again.meshes.size(), 2u);
  const auto binary = read(written(scene, GltfForm::binary), "a.glb");
  ASSERT_TRUE(binary) << binary.error().front().text();
  EXPECT_EQ(content_hash(binary->scene), content_hash(again));
}

TEST(GltfWrite, TexturesReadBack) {
  const Scene scene = mesh_scene(), again = read_again(scene);
  ASSERT_EQ(again.textures.size(), 1u);  // that of the material which is used
  const Texture &from = scene.textures[1], &to = again.textures[0];
  EXPECT_EQ(to.width, from.width);
  EXPECT_EQ(to.height, from.height);
  EXPECT_EQ(to.wrap_u, from.wrap_u);
  EXPECT_EQ(to.wrap_v, from.wrap_v);
  for (uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(again.texels[to.first + i], scene.texels[from.first + i]) << i;
}

TEST(GltfWrite, AlphaOfTexturesReadsBack) {
  Scene scene = mesh_scene();
  for (uint32_t& texel : scene.texels) texel |= (texel & 255) << 24;  // also wholly transparent
  scene.texels[3] |= 0xff000000;
  const Scene again = read_again(scene);
  for (uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(again.texels[again.textures[0].first + i], scene.texels[2 + i]) << i;
}

// As read from a file, whose surfaces are those of its materials.
void expect_same_surface(Material material, const StandardSurface& surface) {
  Scene scene = mesh_scene();
  scene.materials = {}, scene.material_texture = {};
  material.kd = 1;
  scene.add_material(material, Rgb(1), 0, 1, surface.is_unlit ? 1 : kNoTexture);
  scene.set_standard_surface(surface);
  scene.meshes[0].materials = {0};
  const Scene again = read_again(scene);
  EXPECT_EQ(not_in_gltf(scene), "");
  EXPECT_EQ(again.materials[0], material);
  StandardSurface found = *again.standard_surface_of(0);
  // Textures have other numbers, and all the same picture.
  for (uint32_t StandardSurface::* texture :
       {&StandardSurface::metallic_roughness_texture, &StandardSurface::normal_texture,
        &StandardSurface::emission_texture, &StandardSurface::transmission_texture})
    if (found.*texture != kNoTexture) {
      EXPECT_EQ(again.textures[found.*texture].width, 4u);
      found.*texture = 1;
    }
  EXPECT_EQ(found, surface);
}

TEST(GltfWrite, StandardSurfacesReadBack) {
  expect_same_surface({.ior = 1.5f}, {});
  expect_same_surface({.color = {0.1f, 0.2f, 0.3f}, .ior = 1.5f}, {.metallic = 0.3f,
                                                                   .roughness = 0.7f,
                                                                   .emission = {4, 2, 1},
                                                                   .is_two_sided = 0,
                                                                   .alpha_mode = AlphaMode::mask,
                                                                   .alpha_cutoff = 0.3f,
                                                                   .normal_scale = 0.7f,
                                                                   .metallic_roughness_texture = 1,
                                                                   .normal_texture = 1,
                                                                   .emission_texture = 1});
  expect_same_surface({.ior = 1.33f}, {.specular = 0.3f,
                                       .specular_color = {3, 1, 0.1f},
                                       .transmission = 0.9f,
                                       .is_thin = 0,
                                       .attenuation_color = {0.9f, 0.1f, 0.2f},
                                       .attenuation_distance = 0.1f,
                                       .alpha_mode = AlphaMode::blend,
                                       .transmission_texture = 1});
  expect_same_surface({.ior = 1.5f}, {.emission = {0.1f, 0.2f, 0.3f},
                                      .coat = 0.3f,
                                      .coat_roughness = 0.1f,
                                      .sheen_color = {0.1f, 0.2f, 0.7f},
                                      .sheen_roughness = 0.3f});
  expect_same_surface({.color = {0.1f, 0.2f, 0.3f}, .ior = 1.5f},
                      {.emission = {0.1f, 0.2f, 0.3f}, .is_unlit = 1, .emission_texture = 1});
}

TEST(GltfWrite, FacesOfPoolsReadBack) {
  Scene scene = with_triangle();
  scene.add_material({.color = Rgb(0, 1, 0), .kd = 1}, Rgb(1), 0, 0.25f);
  scene.normals = {{0, 1, 0}, {0, 0, 1}};
  scene.triangles.push_back({2, 1, 0}), scene.triangle_materials.push_back(1);
  scene.triangle_normals = {{0, 1, 1}, {kNoNormal, kNoNormal, kNoNormal}};
  scene.triangle_colors = {Rgb(1, 0, 0), Rgb(0, 0, 1)};
  for (const Vec3f corner : {Vec3f(0, 0, 5), {2, 0, 5}, {0.5f, 0.5f, 5}, {0, 2, 5}})  // concave
    scene.positions.push_back(corner);
  scene.polygons = {{3, 4}};
  scene.polygon_materials = {1};
  const Scene again = read_again(scene);
  const auto faces = faces_of(again);
  ASSERT_EQ(faces.size(), 4u);
  EXPECT_EQ(faces[0], (Face{{{0, 0, 0, 0, 1, 0, 1, 0, 0},
                             {1, 0, 0, 0, 0, 1, 1, 0, 0},
                             {0, 1, 0, 0, 0, 1, 1, 0, 0}}}));
  EXPECT_THAT(faces[2][0], testing::ElementsAreArray({0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0}));
  double area = 0;
  for (const Face& face : {faces[1], faces[3]}) {
    const auto at = [&](size_t k) { return Vec3d(face[k][0], face[k][1], face[k][2]); };
    area += length(cross(at(1) - at(0), at(2) - at(0))) / 2;
    EXPECT_EQ(face[0][7], 1);
  }
  EXPECT_EQ(area, 1);
  EXPECT_TRUE(any_transparent(again));
  EXPECT_EQ(again.material_opacity[again.meshes.back().materials[0]], 0.25f);
}

// --- cameras
void expect_same_view(const Scene& scene) {
  const Camera a = scene.camera, b = read_again(scene).camera;
  EXPECT_EQ(b.from, a.from);
  EXPECT_EQ(b.projection, a.projection);
  const Vec3f forward = normalize(a.at - a.from), right = normalize(cross(forward, a.up));
  EXPECT_LT(length(normalize(b.at - b.from) - forward), 1e-6f);
  EXPECT_LT(length(normalize(cross(b.at - b.from, b.up)) - right), 1e-6f);
  EXPECT_NEAR(double(b.width) / b.height, double(a.width) / a.height, 1e-3);
  const auto half = [](const Camera& c) {
    const double tangent = std::tan(double(c.fov_deg) * kPi / 360);
    return c.is_parallel() ? tangent * double(length(c.at - c.from)) : tangent;
  };
  EXPECT_NEAR(half(b), half(a), 1e-5 * half(a));
}

TEST(GltfWrite, PerspectiveReadsBack) {
  Scene scene = with_triangle();
  look(scene, {4, -3, 2}, {0.25f, 0, 0.5f}, 25);
  scene.camera.up = {0, 0.1f, 1};
  scene.camera.width = 640, scene.camera.height = 400, scene.requests.near_clip = 0.5f;
  expect_same_view(scene);
  EXPECT_EQ(read_again(scene).requests.near_clip, 0.5f);
  const json lens = json_of(scene)["cameras"][0];
  EXPECT_EQ(lens["type"], "perspective");
  EXPECT_NEAR(lens["perspective"]["yfov"].get<double>(), 25 * kPi / 180, 1e-7);
  EXPECT_EQ(lens["perspective"]["aspectRatio"], 1.6);
  EXPECT_EQ(lens["perspective"]["znear"], 0.5);
  EXPECT_FALSE(lens["perspective"].contains("zfar"));
  // Programs of triangles need some near plane.
  scene.requests.near_clip = 0;
  const double near = json_of(scene)["cameras"][0]["perspective"]["znear"];
  EXPECT_GT(near, 0);
  EXPECT_LT(near, 0.01);
}

TEST(GltfWrite, ParallelRaysReadBack) {
  Scene scene = with_triangle();
  look(scene, {0, 0, 40}, {0, 0, 0}, 3);
  scene.camera.projection = Projection::orthographic;
  scene.camera.width = 300, scene.camera.height = 600;
  expect_same_view(scene);
  const json lens = json_of(scene)["cameras"][0];
  EXPECT_EQ(lens["type"], "orthographic");
  const double height = 40 * std::tan(1.5 * kPi / 180);
  EXPECT_NEAR(lens["orthographic"]["ymag"].get<double>(), height, 1e-6);
  EXPECT_NEAR(lens["orthographic"]["xmag"].get<double>(), height / 2, 1e-6);
  EXPECT_GT(lens["orthographic"]["zfar"], 40);  // beyond everything visible
}

// --- light
TEST(GltfWrite, LightsAreEquallyBrightAtTheMiddle) {
  Scene scene = with_triangle();
  scene.lights = {{{3, 0, 0}, Rgb(0.5f, 1, 0.25f)}, {{0, -8, 0}, std::nullopt}};
  const json all = json_of(scene);
  EXPECT_EQ(all["extensionsUsed"], json({"KHR_lights_punctual"}));
  const json lights = all["extensions"]["KHR_lights_punctual"]["lights"];
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0]["type"], "point");
  EXPECT_EQ(lights[0]["color"], json({0.5, 1.0, 0.25}));
  EXPECT_EQ(lights[1]["color"], json({1.0, 1.0, 1.0}));
  // Around (0.5, 0.5, 0). A white surface there reflects its irradiance divided by pi.
  EXPECT_NEAR(lights[0]["intensity"].get<double>() / kPi / (2.5 * 2.5 + 0.25), 1, 1e-6);
  EXPECT_NEAR(lights[1]["intensity"].get<double>() / kPi / (0.25 + 8.5 * 8.5), std::sqrt(0.5),
              1e-6);
  const auto places = [&](int light) -> json {
    for (const json& node : all["nodes"])
      if (node.contains("extensions") &&
          node["extensions"]["KHR_lights_punctual"]["light"] == light)
        return node["translation"];
    return {};
  };
  EXPECT_EQ(places(0), json({3.0, 0.0, 0.0}));
  EXPECT_EQ(places(1), json({0.0, -8.0, 0.0}));
}

TEST(GltfWrite, PhysicalLightsReadBack) {
  Scene scene = with_triangle();
  scene.origin = Vec3d(5'400'000, 0, 0);
  const Vec3f down = normalize(Vec3f(1, -2, 0.5f));
  scene.physical_lights = {
      {.kind = LightKind::point, .color = {3, 6, 1.5f}, .position = {1, 2, 3}},
      {.kind = LightKind::directional, .color = Rgb(0.5f), .position = {}, .direction = down},
      {.kind = LightKind::spot,
       .position = {0, 5, 0},
       .direction = {0, -1, 0},
       .opening = 60,
       .falloff = 10}};
  EXPECT_EQ(not_in_gltf(scene), "");
  const Scene again = read_again(scene);
  ASSERT_EQ(again.physical_lights.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    const PhysicalLight &a = scene.physical_lights[i], &b = again.physical_lights[i];
    EXPECT_EQ(b.kind, a.kind);
    EXPECT_EQ(b.color, a.color);
    EXPECT_EQ(Vec3d(b.position) + again.origin, Vec3d(a.position) + scene.origin);
    EXPECT_LT(length(b.direction - a.direction), 1e-6f);
  }
  EXPECT_FLOAT_EQ(again.physical_lights[2].opening, 60);
  EXPECT_FLOAT_EQ(again.physical_lights[2].falloff, 10);
  scene.physical_lights.push_back({.kind = LightKind::quad, .position = {}});
  EXPECT_EQ(not_in_gltf(scene), "1 physical light");
}

// --- materials
json material(const Material& m, Dialect dialect = Dialect::data, Rgb specular = Rgb(1),
              float opacity = 1) {
  Scene scene = with_triangle();
  scene.dialect = dialect;
  scene.materials = {}, scene.material_opacity = {};
  scene.add_material(m, specular, 0, opacity);
  return json_of(scene)["materials"][0];
}

TEST(GltfWrite, DiffuseMaterials) {
  const json data = material({.color = Rgb(0.5f, 0.25f, 1), .kd = 0.5f});
  EXPECT_EQ(data["pbrMetallicRoughness"]["baseColorFactor"], json({0.25, 0.125, 0.5, 1.0}));
  EXPECT_EQ(data["pbrMetallicRoughness"]["metallicFactor"], 0);
  EXPECT_EQ(data["pbrMetallicRoughness"]["roughnessFactor"], 1);
  EXPECT_EQ(data["doubleSided"], true);
  EXPECT_FALSE(data.contains("alphaMode"));
  EXPECT_FALSE(data.contains("extensions"));
  // The classic shading computes display values.
  const json nff = material({.color = Rgb(1, 0.5f, 0), .kd = 1}, Dialect::nff);
  EXPECT_EQ(nff["pbrMetallicRoughness"]["baseColorFactor"],
            json({1.0, double(linear_from_srgb(0.5f)), 0.0, 1.0}));
}

TEST(GltfWrite, MirrorsAreMetals) {
  const json mirror = material({.color = Rgb(1), .kd = 0, .ks = 1, .shine = 1000}, Dialect::data,
                               Rgb(0.75f, 0.5f, 0.25f))["pbrMetallicRoughness"];
  EXPECT_NEAR(mirror["metallicFactor"].get<double>(), 1, 1e-9);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(mirror["baseColorFactor"][i].get<double>(), 0.75 - 0.25 * double(i), 1e-6);
  EXPECT_LT(mirror["roughnessFactor"], 0.3);
  // Half of each: the reflected light is preserved.
  const json half = material({.color = Rgb(1), .kd = 0.4f, .ks = 0.4f})["pbrMetallicRoughness"];
  const double metallic = half["metallicFactor"], base = half["baseColorFactor"][0];
  EXPECT_NEAR(base * (1 - metallic), 0.4, 0.05);
  EXPECT_NEAR(base * metallic + 0.04 * (1 - metallic), 0.4, 0.05);
  // As much as a dielectric reflects.
  EXPECT_EQ(material({.kd = 1, .ks = 0.03f})["pbrMetallicRoughness"]["metallicFactor"], 0);
}

TEST(GltfWrite, GlassAndOpacity) {
  const json glass = material({.color = Rgb(1), .kd = 0, .transmission = 0.5f, .ior = 1.5f});
  EXPECT_EQ(glass["extensions"]["KHR_materials_transmission"]["transmissionFactor"], 1);
  EXPECT_EQ(glass["extensions"]["KHR_materials_ior"]["ior"], 1.5);
  EXPECT_EQ(glass["pbrMetallicRoughness"]["baseColorFactor"], json({0.5, 0.5, 0.5, 1.0}));
  const json clear = material({.color = Rgb(1), .kd = 1}, Dialect::data, Rgb(1), 0.25f);
  EXPECT_EQ(clear["alphaMode"], "BLEND");
  EXPECT_EQ(clear["pbrMetallicRoughness"]["baseColorFactor"][3], 0.25);
}

// --- shapes that glTF does not have
double area_of(const Mesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d p(mesh.positions[a]);
    area += length(cross(Vec3d(mesh.positions[b]) - p, Vec3d(mesh.positions[c]) - p)) / 2;
  }
  return area;
}

// `error` is a vertex's distance from the shape.
template <class Error>
void expect_shape(const Scene& scene, double area, const Error& error) {
  EXPECT_EQ(not_in_gltf(scene), "the exact form of 1 round shape, replaced by triangles");
  const Scene again = read_again(scene);
  ASSERT_EQ(again.meshes.size(), 1u);
  const Mesh& mesh = again.meshes[0];
  EXPECT_EQ(again.materials[mesh.materials[0]].color, scene.materials[0].color);
  for (const Vec3f& p : mesh.positions) EXPECT_NEAR(error(Vec3d(p)), 0, 1e-5);
  EXPECT_LT(area_of(mesh), area * 1.0001);
  EXPECT_GT(area_of(mesh), area * 0.98);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3f p = mesh.positions[a];
    const Vec3f face = normalize(cross(mesh.positions[b] - p, mesh.positions[c] - p));
    for (const uint32_t corner : {a, b, c}) EXPECT_GT(dot(face, mesh.normals[corner]), 0.95f);
  }
}

TEST(GltfWrite, SpheresAreTriangles) {
  Scene scene = data_scene();
  scene.spheres = {{{1, 2, 3}, -0.5f}};
  scene.sphere_materials = {0};
  expect_shape(scene, kPi, [](Vec3d p) { return length(p - Vec3d(1, 2, 3)) - 0.5; });
}

TEST(GltfWrite, CylindersAndConesAreTriangles) {
  const Vec3d base(1, 0, -1), apex(1, 3, 3);  // 5 apart
  for (const auto& [at_base, at_apex] :
       {std::pair(0.5, 0.5), {1.0, 0.25}, {0.25, 1.0}, {1.0, 0.0}}) {
    Scene scene = data_scene();
    scene.cones = {{Vec3f(base), float(at_base), Vec3f(apex), float(at_apex)}};
    scene.cone_materials = {0};
    const double area = kPi * (at_base + at_apex) * std::hypot(5, at_base - at_apex);
    expect_shape(scene, area, [&](Vec3d p) {
      const Vec3d axis = (apex - base) / 5;
      const double along = dot(p - base, axis);
      return length(p - base - axis * along) - (at_base + (at_apex - at_base) * along / 5);
    });
  }
}

TEST(GltfWrite, EllipsoidsAndDiscsAreTriangles) {
  Scene scene = data_scene();
  scene.ellipsoids = {{{1, 1, 1}, {Vec3f(0, 2, 0), Vec3f(-1, 0, 0), Vec3f(0, 0, 1)}}};
  scene.ellipsoid_materials = {0};
  const double e = std::sqrt(0.75);  // of a prolate one: 2 pi (1 + 2 / e asin(e))
  expect_shape(scene, 2 * kPi * (1 + 2 / e * std::asin(e)), [](Vec3d p) {
    const Vec3d v = p - Vec3d(1, 1, 1);
    return length(Vec3d(v.x, v.y / 2, v.z)) - 1;
  });
  scene = data_scene();
  scene.discs = {{{0, 0, 2}, {0, 0.6f, -0.8f}, 2, 0.5f}};
  scene.disc_materials = {0};
  expect_shape(scene, kPi * (4 - 0.25), [](Vec3d p) {
    const Vec3d v = p - Vec3d(0, 0, 2);
    return std::abs(dot(v, Vec3d(0, 0.6, -0.8))) +
           std::min(std::abs(length(v) - 2), std::abs(length(v) - 0.5));
  });
}

TEST(GltfWrite, EqualShapesShareTriangles) {
  Scene scene = data_scene();
  scene.add_material({.color = Rgb(0, 1, 0), .kd = 1});
  for (int i = 0; i < 40; ++i)
    scene.spheres.push_back({{float(i), 0, 0}, 0.25f}),
        scene.sphere_materials.push_back(MaterialId(i % 2));
  const json all = json_of(scene);
  EXPECT_EQ(all["meshes"].size(), 2u);  // one for each material
  EXPECT_EQ(all["meshes"][0]["primitives"][0]["attributes"],
            all["meshes"][1]["primitives"][0]["attributes"]);
  EXPECT_EQ(all["nodes"].size(), 1u + 40 + 1);  // and the camera
  EXPECT_EQ(read(written(scene), "a.gltf", {.instances = true})->scene.instances.size(), 40u);
}

TEST(GltfWrite, ManyColorsBecomeVertexColors) {
  Scene scene = data_scene();
  for (int i = 0; i < 300; ++i) {
    scene.spheres.push_back({{float(i), 0, 0}, 0.25f}), scene.sphere_materials.push_back(0);
    scene.sphere_colors.push_back(Rgb(float(i) / 512, 0, 1));
  }
  const json all = json_of(scene);
  EXPECT_EQ(all["materials"].size(), 1u);
  const Scene again = read_again(scene);
  ASSERT_EQ(again.meshes.size(), 1u);
  for (size_t i = 0; i < again.meshes[0].positions.size(); ++i) {
    const float sphere = std::round(again.meshes[0].positions[i].x);
    ASSERT_EQ(again.meshes[0].colors[i], Rgb(sphere / 512, 0, 1));
  }
}

TEST(GltfWrite, ManyShapesHaveFewerTriangles) {
  const auto spheres = [](size_t count) {
    Scene scene = data_scene();
    scene.spheres.assign(count, Sphere{{0, 0, 0}, 1});
    scene.sphere_materials.assign(count, 0);
    return scene;
  };
  const auto parts = gltf::surface_parts(spheres(10'001));
  ASSERT_TRUE(parts);
  EXPECT_THAT(parts->objects[0].shapes, IsEmpty());
  ASSERT_EQ(parts->surfaces.size(), 1u);
  EXPECT_EQ(parts->surfaces[0].triangles.size(), 10'001u * 320);
  // Viewers draw the triangles of all instances.
  Scene copied = data_scene();
  copied.prototypes = {spheres(100)};
  copied.instances.assign(10'000, {});
  const auto copies = gltf::surface_parts(copied);
  ASSERT_EQ(copies->objects.size(), 2u);
  EXPECT_EQ(copies->surfaces[0].triangles.size(), 100u * 20);
  EXPECT_THAT(write_gltf(spheres(1'000'001), GltfForm::binary).error(),
              HasSubstr("1000001 of them are too many to convert to triangles"));
}

// --- places
// Instances of instances, mirrored and non-uniformly scaled, which no sphere survives as a sphere.
TEST(GltfWrite, InstancesKeepTheirPositions) {
  Scene scene = tests::nested_scene();
  for (Object& object : scene.prototypes) {
    object.positions = {{0, 0, 0}, {0.3f, 0, 0}, {0, 0.2f, 0.1f}};
    object.triangles = {{0, 1, 2}};
    object.triangle_materials = {2};
  }
  EXPECT_THAT(not_in_gltf(scene), HasSubstr("round shapes"));
  const Box3f box = bounds(scene), again = bounds(read_again(scene));
  EXPECT_LT(length(again.lo - box.lo), 0.01f);
  EXPECT_LT(length(again.hi - box.hi), 0.01f);
}

TEST(GltfWrite, ObjectsAreWrittenOnce) {
  Scene object = with_triangle(), scene = data_scene();
  object.spheres.assign(10, Sphere{{0, 0, 0}, 1});
  object.sphere_materials.assign(10, 0);
  scene.prototypes = {object};
  const auto copied = [&](int count) {
    scene.instances = {};
    for (int i = 0; i < count; ++i)
      scene.instances.push_back({0, {0, -2, 0, float(i), 0, 0, 3, 0, 1, 0, 0, 0}});
    return json_of(scene);
  };
  const json few = copied(3);
  EXPECT_EQ(few["nodes"].size(), 1u + 3 * (1 + 10) + 1);
  EXPECT_EQ(few["meshes"].size(), 2u);
  EXPECT_THAT(not_in_gltf(scene), HasSubstr("30 round shapes"));
  const json many = copied(1001);  // of which each sphere would be a node
  EXPECT_EQ(many["nodes"].size(), 1u + 1001 + 1);
  EXPECT_EQ(many["meshes"].size(), 1u);
  EXPECT_LT(many["buffers"][0]["byteLength"], 10 * (642 * 24 + 1280 * 12) + 200);
  const auto again = read(written(scene), "a.gltf", {.instances = true});
  ASSERT_EQ(again->scene.instances.size(), 1001u);
  for (size_t k = 0; k < 12; ++k)
    EXPECT_NEAR(again->scene.instances[7].matrix[k], scene.instances[7].matrix[k], 1e-6f) << k;
}

TEST(GltfWrite, FarFromZeroKeepsItsDigits) {
  Scene scene = with_triangle();
  scene.origin = Vec3d(5'400'000, -300'000, 12'000);
  scene.positions = {{0.1f, 0, 0}, {1, 0.2f, 0}, {0, 1, 0.3f}};
  scene.spheres = {{{0.5f, 0.25f, 2}, 0.1f}, {{0.6f, 0.25f, 2}, 0.1f}};
  scene.sphere_materials = {0, 0};
  EXPECT_EQ(json_of(scene)["nodes"][0]["translation"], json({5'400'000.0, -300'000.0, 12'000.0}));
  const Scene again = read_again(scene);
  const auto box = [](const Scene& s) {
    const Box3f b = bounds(s);
    return std::array{Vec3d(b.lo) + s.origin, Vec3d(b.hi) + s.origin};
  };
  EXPECT_NE(again.origin, Vec3d());
  for (const size_t end : {0u, 1u}) EXPECT_LT(length(box(again)[end] - box(scene)[end]), 2e-3);
  EXPECT_LT(
      length(Vec3d(again.camera.from) + again.origin - Vec3d(scene.camera.from) - scene.origin),
      1e-4);
}

// --- files
using GltfFile = TemporaryFolder;

TEST_F(GltfFile, SuffixesChooseTheForm) {
  const Scene scene = mesh_scene();
  ASSERT_TRUE(write_scene(scene, file("a.glb"), "by a test"));
  ASSERT_TRUE(write_scene(scene, file("b.GLTF"), "by a test"));
  EXPECT_EQ(entries(), 2);  // numbers and pictures are in the text
  EXPECT_TRUE(get(file("a.glb")).starts_with("glTF"));
  EXPECT_EQ(json::parse(get(file("b.GLTF")))["asset"],
            json({{"version", "2.0"}, {"generator", "by a test"}}));
  const auto a = read_scene(file("a.glb")), b = read_scene(file("b.GLTF"));
  ASSERT_TRUE(a && b);
  EXPECT_EQ(content_hash(a->scene), content_hash(b->scene));
}

TEST_F(GltfFile, ShearedInstancesBecomeFaces) {
  Scene object = with_triangle(), scene = data_scene();
  scene.prototypes = {object};
  scene.instances = {{0, {1, 0.5f, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}, {0, kIdentity}};
  EXPECT_THAT(write_gltf(scene, GltfForm::text).error(), HasSubstr("shear"));
  ASSERT_TRUE(write_scene(scene, file("a.gltf")));
  EXPECT_EQ(json::parse(get(file("a.gltf")))["nodes"].size(), 2u);
  EXPECT_EQ(faces_of(read_scene(file("a.gltf"))->scene)[1][2][0], 0.5f);
}

TEST_F(GltfFile, FailedWritesLeaveNothing) {
  EXPECT_FALSE(write_scene(mesh_scene(), file("missing/a.glb")));
  put(file("some"), "other");
  EXPECT_FALSE(write_scene(mesh_scene(), file("some/a.gltf")));
  Scene planes = data_scene();
  planes.planes = {{{0, 0, 0}, {0, 0, 1}}};
  planes.plane_materials = {0};
  put(file("old.glb"), "before");
  const auto nothing = write_scene(planes, file("old.glb"));
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, HasSubstr("nothing in the scene can be converted"));
  EXPECT_EQ(get(file("old.glb")), "before");
  EXPECT_EQ(entries(), 2);
  EXPECT_THAT(not_in_gltf(planes), HasSubstr("1 plane"));
}

TEST_F(GltfFile, NamesMayHoldAnything) {
  Scene scene = mesh_scene();
  scene.name = "a \"b\" \\ \n \x01 </script> \xff\xc3";
  ASSERT_TRUE(write_scene(scene, file("a.glb"), scene.name));
  ASSERT_TRUE(write_scene(scene, file("a.gltf"), scene.name));
  EXPECT_EQ(json::parse(get(file("a.gltf")))["nodes"][0]["name"],
            "a \"b\" \\ \n \x01 </script> \xef\xbf\xbd\xef\xbf\xbd");
  for (const char* name : {"a.glb", "a.gltf"}) EXPECT_TRUE(read_scene(file(name))) << name;
}

using GltfCommandLine = CommandLine;

TEST_F(GltfCommandLine, ConvertsWithANotice) {
  put(file("two.xyz"), "2\n\nC 0 0 0\nC 9 0 0\n");
  for (const char* name : {"two.glb", "two.gltf"}) {
    const Outcome done = raio({"convert", "two.xyz", name});
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_THAT(done.err, HasSubstr("the exact form of 2 round shapes, replaced by triangles"));
    EXPECT_EQ(raio({"render", "--quiet", name, "--size", "8x8", "-o", "a.png"}).status, 0);
  }
  expect_refusal({"convert", "two.xyz", "no/two.glb"}, 3, "no/two.glb");
  EXPECT_FALSE(std::filesystem::exists(file("no")));
}

TEST_F(GltfCommandLine, SurfacesAreCounted) {
  Scene scene = mesh_scene();
  scene.standard_surfaces = {{.emission = {0, 1, 0}}, {}};
  scene.physical_lights = {{.position = {0, 0, 5}}};
  ASSERT_TRUE(write_scene(scene, file("a.glb")));
  const std::string text = raio({"info", "a.glb"}).out;
  EXPECT_THAT(text, HasSubstr("2 with the parameters of glTF, of which 1 emit light"));
  EXPECT_THAT(text, HasSubstr("lights      1\n            1 point, in physical units"));
  const json materials = json::parse(raio({"info", "--json", "a.glb"}).out)["materials"];
  EXPECT_EQ(materials["standard"], 2);
  EXPECT_EQ(materials["emitting"], 1);
  for (const SceneFormat format : {SceneFormat::nff, SceneFormat::pov, SceneFormat::ply})
    EXPECT_THAT(lost_features(scene, format), HasSubstr("glTF's parameters of 2 materials"));
}

// Everything in a scene is written or reported as lost.
TEST(GltfWrite, RichScenes) {
  for (uint32_t seed = 1; seed < 5; ++seed) {
    const Scene scene = tests::rich_scene(seed), again = read_again(scene);
    EXPECT_GT(faces_of(again).size(), 1000u);
    const Box3f a = bounds(scene), b = bounds(again);
    EXPECT_LT(length(a.lo - b.lo) + length(a.hi - b.hi), 0.05f * length(a.hi - a.lo));
    for (const char* lost :
         {"1 plane", "round shapes", "names of 3 objects", "roughness", "the background", "lens"})
      EXPECT_THAT(not_in_gltf(scene), HasSubstr(lost));
  }
}

}  // namespace
}  // namespace raio::core
