// The list of a scene's arrays, written once: what hashes, checks, measures or stores scenes goes
// by it. An array that is new in scene.h is a line here.
#pragma once

#include "scene/scene.h"

namespace raio {

/// Calls f(kind, shapes, materials, colors, opacity) for each pool of primitives of `scene`, const
/// or not. Meshes, which keep theirs themselves, are none.
template <class SceneType, class F>
void for_each_pool(SceneType& s, F&& f) {
  f(PoolKind::plane, s.planes, s.plane_materials, s.plane_colors, s.plane_opacity);
  f(PoolKind::sphere, s.spheres, s.sphere_materials, s.sphere_colors, s.sphere_opacity);
  f(PoolKind::cone, s.cones, s.cone_materials, s.cone_colors, s.cone_opacity);
  f(PoolKind::triangle, s.triangles, s.triangle_materials, s.triangle_colors, s.triangle_opacity);
  f(PoolKind::polygon, s.polygons, s.polygon_materials, s.polygon_colors, s.polygon_opacity);
}

/// How the content hash counts a column. Those that came after the first version count only where
/// they are not empty, so that scenes without them keep their names.
enum class Counted : uint8_t { always, where_used };

/// A column's name, the same in files; those of meshes begin with "mesh_".
struct ColumnName {
  std::string_view name;
  Counted counted = Counted::always;
};

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

/// Calls f(ColumnName, array) for all arrays of `scene`, const or not, but lights, the names of
/// objects and those of meshes. The order is that of the hash: new ones go to the end.
template <class SceneType, class F>
void for_each_own_column(SceneType& s, F&& f) {
  f(ColumnName{"materials"}, s.materials);
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
  f(ColumnName{"plane_colors", Counted::where_used}, s.plane_colors);
  f(ColumnName{"plane_opacity", Counted::where_used}, s.plane_opacity);
  f(ColumnName{"sphere_colors", Counted::where_used}, s.sphere_colors);
  f(ColumnName{"sphere_opacity", Counted::where_used}, s.sphere_opacity);
  f(ColumnName{"cone_colors", Counted::where_used}, s.cone_colors);
  f(ColumnName{"cone_opacity", Counted::where_used}, s.cone_opacity);
  f(ColumnName{"triangle_colors", Counted::where_used}, s.triangle_colors);
  f(ColumnName{"triangle_opacity", Counted::where_used}, s.triangle_opacity);
  f(ColumnName{"polygon_colors", Counted::where_used}, s.polygon_colors);
  f(ColumnName{"polygon_opacity", Counted::where_used}, s.polygon_opacity);
  f(ColumnName{"object_ranges", Counted::where_used}, s.object_ranges);
}

/// Both: the scene's own, then those of one mesh after another.
template <class SceneType, class F>
void for_each_column(SceneType& scene, F&& f) {
  for_each_own_column(scene, f);
  for (auto& mesh : scene.meshes) for_each_mesh_column(mesh, f);
}

}  // namespace raio
