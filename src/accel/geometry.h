// A scene baked for tracing: one array per number, in pools of the kinds that rays meet. Polygons
// are triangles here. Made once from a Scene, then only read.
#pragma once

#include <array>
#include <vector>

#include "base/box.h"
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

struct Geometry {
  std::vector<Plane> planes;
  std::vector<MaterialId> plane_materials;

  struct {
    std::vector<float> x, y, z, radius;  // radius >= 0; what is seen is in `sides`
    std::vector<MaterialId> material;
  } spheres;

  struct {
    std::array<std::vector<float>, 3> a, b, c;  // corner[axis][triangle]
    std::vector<Facet> facets;
  } triangles;
  /// Parallel to triangles, as in Scene; empty when none is smooth.
  std::vector<TriangleIndices> triangle_normals;
  std::vector<Vec3f> normals;

  std::vector<BakedCone> cones;
  std::vector<MaterialId> cone_materials;

  /// Per item of a kind which side is seen; empty: both sides of all of them.
  std::array<std::vector<Sides>, kItemKinds> sides;

  size_t count(ItemKind kind) const;
  Sides sides_of(ItemId id) const {
    const auto& s = sides[size_t(item_kind(id))];
    return s.empty() ? Sides::both : s[item_index(id)];
  }
  Triangle triangle(uint32_t i) const {
    const auto& t = triangles;
    return {{t.a[0][i], t.a[1][i], t.a[2][i]},
            {t.b[0][i], t.b[1][i], t.b[2][i]},
            {t.c[0][i], t.c[1][i], t.c[2][i]}};
  }
  Sphere sphere(uint32_t i) const {
    return {{spheres.x[i], spheres.y[i], spheres.z[i]}, spheres.radius[i]};
  }

  Box3f bounds(ItemId id) const;  // not for planes, which have none
  size_t bytes() const;
};

/// With `one_sided`, opaque surfaces are seen from outside only, as the NFF text has it.
Geometry bake(const Scene& scene, bool one_sided = false);

}  // namespace raio
