// A scene as structures and shading see it: the kinds that rays meet, polygons cut into triangles,
// what a hit wants to know worked out beforehand. Made once from a Scene, whose own pools it reads
// in place wherever it can: large scenes are not stored twice.
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

/// The kinds that structures store; the upper bits of an PrimitiveId.
enum class PrimitiveKind : uint32_t { plane, sphere, triangle, cone };
inline constexpr int kPrimitiveKinds = 4;

constexpr PrimitiveId primitive_id(PrimitiveKind kind, uint32_t index) {
  return uint32_t(kind) << kPrimitiveIndexBits | index;
}
constexpr PrimitiveKind primitive_kind(PrimitiveId id) {
  return PrimitiveKind(id >> kPrimitiveIndexBits);
}
constexpr uint32_t primitive_index(PrimitiveId id) { return id & (kMaxPrimitivesPerKind - 1); }

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

  size_t count(PrimitiveKind kind) const;
  Sides sides_of(PrimitiveId id) const {
    const auto& s = sides_[size_t(primitive_kind(id))];
    return s.empty() ? Sides::both : s[primitive_index(id)];
  }
  /// Are both sides of all items of the kind seen?
  bool two_sided(PrimitiveKind kind) const { return sides_[size_t(kind)].empty(); }

  const Plane& plane(uint32_t i) const { return scene_->planes[i]; }
  /// The radius is not negative: what is seen of the sphere is in sides_of().
  Sphere sphere(uint32_t i) const {
    const Sphere& s = scene_->spheres[i];
    return {s.center, std::abs(s.radius)};
  }
  /// Indices into the scene's positions.
  const TriangleIndices& corners(uint32_t triangle) const { return triangles_[triangle]; }
  Triangle triangle(uint32_t i) const {
    const auto& p = scene_->positions;
    const TriangleIndices& t = triangles_[i];
    return {p[t[0]], p[t[1]], p[t[2]]};
  }
  const BakedCone& cone(uint32_t i) const { return cones_[i]; }

  /// Tells the processor that the item will be asked for soon.
  void prefetch(PrimitiveId id) const {
    const uint32_t i = primitive_index(id);
    if (primitive_kind(id) == PrimitiveKind::sphere) __builtin_prefetch(&scene_->spheres[i]);
    if (primitive_kind(id) == PrimitiveKind::triangle) __builtin_prefetch(&triangles_[i]);
  }

  const Facet& facet(uint32_t triangle) const { return facets_[triangle]; }
  /// The normals at a triangle's corners, or null where it is flat.
  const TriangleIndices* corner_normals(uint32_t triangle) const {
    if (triangle >= triangle_normals_.size() || triangle_normals_[triangle][0] == kNoNormal)
      return nullptr;
    return &triangle_normals_[triangle];
  }
  bool any_smooth() const { return !triangle_normals_.empty(); }

  /// About how many bytes baking `scene` takes, those that it frees again included.
  static double bytes_to_bake(const Scene& scene);

  Box3f bounds(PrimitiveId id) const;  // not for planes, which have none
  size_t bytes() const;                // besides the scene

 private:
  void bake_triangles();
  void bake_polygons();
  void list_sides(bool one_sided);

  const Scene* scene_;
  // The scene's own where every primitive is a triangle with an area, else those below.
  std::span<const TriangleIndices> triangles_, triangle_normals_;
  Column<TriangleIndices> own_triangles_, own_normals_;
  Column<Facet> facets_;
  Column<BakedCone> cones_;
  std::array<Column<Sides>, kPrimitiveKinds> sides_;  // empty: both sides of all
};

}  // namespace raio
