// A scene with some of everything that a Scene can hold.
#pragma once

#include "scenes.h"

namespace raio::core::tests {

/// random_scene() plus colours and opacities of all kinds, two meshes (one with normals, one with
/// everything at its vertices and a texture) and three objects.
inline Scene rich_scene(uint32_t seed = 1) {
  Scene s = random_scene(40, seed);
  std::mt19937 rng(seed + 1000);
  std::uniform_real_distribution<float> unit(0, 1);
  const auto color = [&] {
    const float r = unit(rng), g = unit(rng), b = unit(rng);
    return Rgb(r, g, b);
  };
  const auto paint = [&](size_t count, StridedArray<Rgb>& colors, StridedArray<float>& opacity) {
    for (size_t i = 0; i < count; ++i) colors.push_back(color()), opacity.push_back(unit(rng));
  };
  paint(s.planes.size(), s.plane_colors, s.plane_opacity);
  paint(s.spheres.size(), s.sphere_colors, s.sphere_opacity);
  paint(s.cones.size(), s.cone_colors, s.cone_opacity);
  paint(s.triangles.size(), s.triangle_colors, s.triangle_opacity);
  paint(s.polygons.size(), s.polygon_colors, s.polygon_opacity);
  s.lights[0].color = Rgb(1, 0.5f, 0.25f);
  for (size_t m = 0; m < s.materials.size(); ++m)
    s.material_specular.push_back(color()), s.material_roughness.push_back(unit(rng));
  s.camera.lens_radius = 0.01f;
  s.requests.near_clip = 1;

  Mesh pyramid;
  pyramid.positions = {{0.1f, -0.5f, 0}, {0.6f, -0.5f, 0}, {0.3f, -0.1f, 0}, {0.3f, -0.3f, 0.7f}};
  pyramid.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 0, 1}};  // the last has no area
  pyramid.normals = {{0, -1, 0}, {0, 0, 1}};
  pyramid.normal_indices = {{0, 0, 1}, {0, 1, 1}, {kNoNormal, kNoNormal, kNoNormal}, {0, 0, 0}};
  pyramid.materials = {0, 1, 0, 1};
  Mesh sheet;
  sheet.positions = {{-0.9f, -0.9f, 0.2f}, {-0.2f, -0.9f, 0.2f}, {-0.2f, -0.3f, 0.6f}};
  sheet.normals.assign(3, {0, 0, 1});
  sheet.uv = {{0, 0}, {1, 0}, {1, 1}};
  sheet.colors = {color(), color(), color()};
  sheet.triangles = {{0, 1, 2}};
  sheet.materials = {1};
  s.material_texture.assign(s.materials.size(), kNoTexture);
  s.material_texture[1] = 1;
  s.standard_surfaces.assign(s.materials.size(), {.is_standard = 0});
  s.standard_surfaces[0] = {.metallic = 0.5f, .normal_texture = 0};
  s.texels = {0x0000ff, 0x80ff00, 0x20c0a0, 0xffffff, 0x405060, 0x102030};
  s.textures = {{0, 2, 3},
                {.first = 2,
                 .width = 4,
                 .height = 1,
                 .wrap_u = TextureWrap::clamp,
                 .wrap_v = TextureWrap::mirror}};
  s.meshes = {pyramid, sheet};

  s.object_names = {"some spheres", "pyramid", "the floor and a sphere"};
  s.object_ranges = {{PoolKind::sphere, 1, 3, 1},
                     {PoolKind::sphere, 6, 1, 3},
                     {PoolKind::polygon, uint32_t(s.polygons.size()) - 1, 1, 3},
                     {PoolKind::mesh, 0, 1, 2}};
  return s;
}

/// Instances of an object, and of one that consists of instances; some belong to objects.
inline Scene nested_scene() {
  Scene s = random_scene(4, 1);
  s.planes.clear(), s.plane_materials.clear();
  s.object_names = {"a copy", "spheres of an object"};
  s.object_ranges = {{PoolKind::instance, 1, 2, 1}};
  Scene object;
  object.materials = s.materials;
  object.spheres = {{{0, 0, 0}, 0.2f}, {{0.25f, 0, 0}, 0.1f}};
  object.sphere_materials = {0, 1};
  object.object_ranges = {{PoolKind::sphere, 0, 1, 2}};
  Scene pair;
  pair.materials = s.materials;
  pair.prototypes = {object};
  pair.instances = {{0, kIdentity}, {0, {0, -1, 0, 0.1f, 1, 0, 0, 0.5f, 0, 0, 2, 0}}};
  s.prototypes = {object, pair};
  s.instances = {{0, {1, 0, 0, -0.5f, 0, 1, 0, 0, 0, 0, 1, 0.5f}},
                 {1, {1, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1, 0.5f}},
                 {1, {1, 0, 0, 0, 0, 1, 0, -0.5f, 0, 0, -1, 0.7f}}};
  return s;
}

}  // namespace raio::core::tests
