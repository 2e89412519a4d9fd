// A scene as structures and shading see it: the kinds that rays meet, polygons cut into triangles,
// those of meshes behind the scene's own, what a hit wants to know worked out beforehand. Made once
// from a Scene, whose own pools it reads in place wherever it can: large scenes are not stored
// twice.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/box.h"
#include "base/memory.h"
#include "base/ray.h"
#include "scene/scene.h"
#include "shape/triangle.h"

namespace raio {

/// The kinds that structures store; the upper bits of an ItemId.
enum class ItemKind : uint32_t { plane, sphere, triangle, cone };
inline constexpr int kItemKinds = 4;

constexpr ItemId item_id(ItemKind kind, uint32_t index) {
  return uint32_t(kind) << kItemIndexBits | index;
}
constexpr ItemKind item_kind(ItemId id) { return ItemKind(id >> kItemIndexBits); }
constexpr uint32_t item_index(ItemId id) { return id & (kMaxItemsPerKind - 1); }

/// What shading wants of a triangle: 16 bytes.
struct Facet {
  Vec3f normal;  // of the polygon, for a piece of one
  MaterialId material = 0;
};

class Geometry {
 public:
  /// `scene` must outlive the result. With `one_sided`, opaque surfaces are seen from outside only,
  /// as the NFF text has it.
  explicit Geometry(const Scene& scene, bool one_sided = false);
  Geometry(Geometry&&) = default;

  const Scene& scene() const { return *scene_; }

  size_t count(ItemKind kind) const;
  Sides sides_of(ItemId id) const {
    const auto& s = sides_[size_t(item_kind(id))];
    return s.empty() ? Sides::both : s[item_index(id)];
  }
  /// Are both sides of all items of the kind seen?
  bool two_sided(ItemKind kind) const { return sides_[size_t(kind)].empty(); }

  const Plane& plane(uint32_t i) const { return scene_->planes[i]; }
  /// The radius is not negative: what is seen of the sphere is in sides_of().
  Sphere sphere(uint32_t i) const {
    const Sphere& s = scene_->spheres[i];
    return {s.center, std::abs(s.radius)};
  }
  /// The scene's, or, where it has meshes, copies of those and of the meshes'.
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }
  /// Indices into positions().
  const TriangleIndices& corners(uint32_t triangle) const { return triangles_[triangle]; }
  Triangle triangle(uint32_t i) const {
    const TriangleIndices& t = triangles_[i];
    return {positions_[t[0]], positions_[t[1]], positions_[t[2]]};
  }
  const BakedCone& cone(uint32_t i) const { return cones_[i]; }

  /// Tells the processor that the item will be asked for soon.
  void prefetch(ItemId id) const {
    const uint32_t i = item_index(id);
    if (item_kind(id) == ItemKind::sphere) __builtin_prefetch(&scene_->spheres[i]);
    if (item_kind(id) == ItemKind::triangle) __builtin_prefetch(&triangles_[i]);
  }

  const Facet& facet(uint32_t triangle) const { return facets_[triangle]; }
  /// The normals at a triangle's corners, or null where it is flat.
  const TriangleIndices* corner_normals(uint32_t triangle) const {
    if (triangle >= triangle_normals_.size() || triangle_normals_[triangle][0] == kNoNormal)
      return nullptr;
    return &triangle_normals_[triangle];
  }
  bool any_smooth() const { return !triangle_normals_.empty(); }

  /// A colour for each item of the kind, or empty: those of the materials count for all of them.
  std::span<const Rgb> colors(ItemKind kind) const;
  bool any_colors() const { return any_colors_; }

  /// The id of the object (Scene::object_names) to which the item belongs; 0: to none.
  uint32_t object_of(ItemId id) const;

  /// About how many bytes baking `scene` takes, those that it frees again included.
  static double bytes_to_bake(const Scene& scene);

  Box3f bounds(ItemId id) const;  // not for planes, which have none
  size_t bytes() const;           // besides the scene

 private:
  void bake_triangles();
  void join_meshes();
  size_t mesh_of(size_t i) const;
  size_t count_of_triangles() const;
  MaterialId triangle_material(size_t i) const;
  void bake_polygons();
  void bake_colors();
  bool wants_sources() const { return any_colors_ || !scene_->object_ranges.empty(); }
  void list_sides(bool one_sided);

  const Scene* scene_;
  bool any_colors_ = false;
  // The scene's own where it has no meshes, else those below.
  std::span<const Vec3f> positions_, normals_;
  Column<Vec3f> own_positions_, own_vertex_normals_;
  // The scene's own where every primitive is a triangle with an area, else those below.
  std::span<const TriangleIndices> triangles_, triangle_normals_;
  Column<TriangleIndices> own_triangles_, own_normals_;
  // How many triangles come before each mesh's: the scene's own and those of the meshes before.
  std::vector<uint32_t> mesh_begin_;
  // Of each triangle its number among the scene's own, those of meshes and the polygons, in this
  // order. Empty where that is its index, or where nothing asks.
  Column<uint32_t> sources_;
  std::span<const Rgb> triangle_colors_;
  Column<Rgb> own_colors_;
  Column<Facet> facets_;
  Column<BakedCone> cones_;
  std::array<Column<Sides>, kItemKinds> sides_;  // empty: both sides of all
};

}  // namespace raio
