// The arrays of a scene, listed once, for code that hashes, checks, measures or stores scenes. A
// new array of scene.h is added here; a new pool, to kScenePools.
#pragma once

#include <algorithm>
#include <array>

#include "scene/scene.h"

namespace raio::core {

/// Calls f(kind, shapes, materials, colors, opacity) for each pool of primitives of `scene`, const
/// or not. Excludes meshes, which store their own materials and colours.
template <class SceneType, class F>
void for_each_pool(SceneType& s, F&& f) {
  for_each_pool([&](auto pool) {
    f(pool.kind, s.*pool.shapes, s.*pool.materials, s.*pool.colors, s.*pool.opacity);
  });
}

/// How the content hash counts a column. Columns added after the first version count only if they
/// are not empty, so that older scenes keep their hashes.
enum class Counted : uint8_t { always, where_used };

/// The name of a column, also in files; the names of mesh columns begin with "mesh_".
struct ColumnName {
  std::string_view name;
  Counted counted = Counted::always;
};

/// The names of a pool's columns: "discs", "disc_materials" and so on.
struct PoolColumns {
  using Name = std::array<char, 32>;  // padded with zeros
  Name shapes, materials, colors, opacity;
};
inline constexpr auto kPoolColumns = [] {
  std::array<PoolColumns, kPoolNames.size()> all{};
  const auto joined = [](std::string_view pool, std::string_view column) {
    PoolColumns::Name name{};
    std::ranges::copy(column, std::ranges::copy(pool, name.begin()).out);
    return name;
  };
  for (size_t i = 0; i < all.size(); ++i) {
    const std::string_view pool = kPoolNames[i];
    all[i] = {joined(pool, "s"), joined(pool, "_materials"), joined(pool, "_colors"),
              joined(pool, "_opacity")};
  }
  return all;
}();

/// Calls f(ColumnName, array) for the columns of one mesh, const or not.
template <class MeshType, class F>
void for_each_mesh_column(MeshType& mesh, F&& f) {
  f(ColumnName{"mesh_materials", Counted::where_used}, mesh.materials);
  f(ColumnName{"mesh_positions", Counted::where_used}, mesh.positions);
  f(ColumnName{"mesh_normals", Counted::where_used}, mesh.normals);
  f(ColumnName{"mesh_uv", Counted::where_used}, mesh.uv);
  f(ColumnName{"mesh_colors", Counted::where_used}, mesh.colors);
  f(ColumnName{"mesh_triangles", Counted::where_used}, mesh.triangles);
  f(ColumnName{"mesh_normal_indices", Counted::where_used}, mesh.normal_indices);
}

/// Calls f(ColumnName, array) for the arrays of `object`, const or not, except its instances and
/// the arrays of meshes and prototypes. The order is that of the hash.
template <class ObjectType, class F>
void for_each_pool_column(ObjectType& s, F&& f) {
  f(ColumnName{"planes"}, s.planes);
  f(ColumnName{"plane_materials"}, s.plane_materials);
  f(ColumnName{"spheres"}, s.spheres);
  f(ColumnName{"sphere_materials"}, s.sphere_materials);
  f(ColumnName{"cones"}, s.cones);
  f(ColumnName{"cone_materials"}, s.cone_materials);
  f(ColumnName{"positions"}, s.positions);
  f(ColumnName{"normals"}, s.normals);
  f(ColumnName{"triangles"}, s.triangles);
  f(ColumnName{"triangle_materials"}, s.triangle_materials);
  f(ColumnName{"triangle_normals"}, s.triangle_normals);
  f(ColumnName{"polygons"}, s.polygons);
  f(ColumnName{"polygon_materials"}, s.polygon_materials);
  for_each_pool(s, [&](PoolKind pool, auto& shapes, auto& materials, auto& colors, auto& opacity) {
    const PoolColumns& names = kPoolColumns[size_t(pool)];
    if (pool > PoolKind::mesh) {  // the others are above
      f(ColumnName{names.shapes.data(), Counted::where_used}, shapes);
      f(ColumnName{names.materials.data(), Counted::where_used}, materials);
    }
    f(ColumnName{names.colors.data(), Counted::where_used}, colors);
    f(ColumnName{names.opacity.data(), Counted::where_used}, opacity);
  });
  f(ColumnName{"object_ranges", Counted::where_used}, s.object_ranges);
}
inline constexpr ColumnName kInstances = {"instances", Counted::where_used};

/// The same, including instances.
template <class ObjectType, class F>
void for_each_object_column(ObjectType& object, F&& f) {
  for_each_pool_column(object, f);
  f(kInstances, object.instances);
}

/// Calls f(ColumnName, array) for the arrays of `scene`, const or not, except NFF's lights, object
/// names and the arrays of meshes and prototypes. The order is that of the hash, so new arrays go
/// at the end.
template <class SceneType, class F>
void for_each_own_column(SceneType& s, F&& f) {
  f(ColumnName{"materials"}, s.materials);
  for_each_pool_column(s, f);
  f(ColumnName{"material_specular", Counted::where_used}, s.material_specular);
  f(ColumnName{"material_roughness", Counted::where_used}, s.material_roughness);
  f(ColumnName{"material_opacity", Counted::where_used}, s.material_opacity);
  f(kInstances, s.instances);
  f(ColumnName{"material_texture", Counted::where_used}, s.material_texture);
  f(ColumnName{"textures", Counted::where_used}, s.textures);
  f(ColumnName{"texels", Counted::where_used}, s.texels);
  f(ColumnName{"physical_lights", Counted::where_used}, s.physical_lights);
  f(ColumnName{"environment", Counted::where_used}, s.environment);
  f(ColumnName{"environment_texels", Counted::where_used}, s.environment_texels);
  f(ColumnName{"standard_surfaces", Counted::where_used}, s.standard_surfaces);
}

/// The scene's own arrays, then those of each mesh.
template <class SceneType, class F>
void for_each_column(SceneType& scene, F&& f) {
  for_each_own_column(scene, f);
  for (auto& mesh : scene.meshes) for_each_mesh_column(mesh, f);
}

}  // namespace raio::core
