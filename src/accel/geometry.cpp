#include "accel/geometry.h"

#include <tbb/parallel_for.h>

#include <atomic>

#include "shape/polygon.h"

namespace raio {
namespace {

template <class T>
size_t vector_bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

Geometry::Geometry(const Scene& scene, bool one_sided) : scene_(&scene) {
  bake_triangles();
  cones_.reserve(scene.cones.size());
  for (const Cone& cone : scene.cones) cones_.emplace_back(cone);
  list_sides(one_sided);
}

// Triangles without area are left out, since no ray can hit one.
void Geometry::bake_triangles() {
  const Scene& s = *scene_;
  const size_t n = s.triangles.size();
  triangles_ = s.triangles;
  triangle_normals_ = s.triangle_normals;
  facets_.resize(n);
  std::atomic<bool> any_flat = false;
  tbb::parallel_for(size_t(0), n, [&](size_t i) {
    facets_[i] = {triangle_normal(triangle(uint32_t(i))), s.triangle_materials[i]};
    if (facets_[i].normal == Vec3f()) any_flat.store(true, std::memory_order_relaxed);
  });
  if (!any_flat && s.polygons.empty()) return;

  const std::vector<Facet> all = std::move(facets_);
  const bool smooth = any_smooth();
  constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
  size_t count = n;
  for (const Polygon& p : s.polygons) count += p.count - 2;
  own_triangles_.reserve(count);
  facets_ = {};
  facets_.reserve(count);
  const auto push = [&](const TriangleIndices& corners, const TriangleIndices& normals,
                        const Facet& facet) {
    own_triangles_.push_back(corners);
    if (smooth) own_normals_.push_back(normals);
    facets_.push_back(facet);
  };
  for (size_t i = 0; i < n; ++i)
    if (!(all[i].normal == Vec3f()))
      push(s.triangles[i], smooth ? s.triangle_normals[i] : kFlat, all[i]);
  for (size_t i = 0; i < s.polygons.size(); ++i) {
    const Polygon& p = s.polygons[i];
    const std::span corners(s.positions.data() + p.first, p.count);
    const Facet facet{polygon_normal(corners), s.polygon_materials[i]};
    for (const auto& [a, b, c] : triangulate(corners)) {
      const TriangleIndices piece = {p.first + a, p.first + b, p.first + c};
      if (triangle_normal({s.positions[piece[0]], s.positions[piece[1]], s.positions[piece[2]]}) !=
          Vec3f())
        push(piece, kFlat, facet);
    }
  }
  triangles_ = own_triangles_;
  triangle_normals_ = own_normals_;
}

// Which side of each item is seen, for the kinds that have one of which it is not both.
void Geometry::list_sides(bool one_sided) {
  const Scene& s = *scene_;
  const auto list = [&](ItemKind kind, auto&& material, auto&& inside_only) {
    std::vector<Sides> sides;
    const size_t n = count(kind);
    for (size_t i = 0; i < n; ++i) {
      const bool opaque = s.materials[material(i)].transmission == 0;
      const Sides side = inside_only(i)        ? Sides::inside
                         : one_sided && opaque ? Sides::outside
                                               : Sides::both;
      if (side == Sides::both) continue;
      if (sides.empty()) sides.assign(n, Sides::both);
      sides[i] = side;
    }
    sides_[size_t(kind)] = std::move(sides);
  };
  const auto never = [](size_t) { return false; };
  list(
      ItemKind::sphere, [&](size_t i) { return s.sphere_materials[i]; },
      [&](size_t i) { return s.spheres[i].radius < 0; });
  list(
      ItemKind::cone, [&](size_t i) { return s.cone_materials[i]; },
      [&](size_t i) { return s.cones[i].base_radius < 0 || s.cones[i].apex_radius < 0; });
  list(ItemKind::plane, [&](size_t i) { return s.plane_materials[i]; }, never);
  if (one_sided) list(ItemKind::triangle, [&](size_t i) { return facets_[i].material; }, never);
}

size_t Geometry::count(ItemKind kind) const {
  switch (kind) {
    case ItemKind::plane:
      return scene_->planes.size();
    case ItemKind::sphere:
      return scene_->spheres.size();
    case ItemKind::triangle:
      return facets_.size();
    case ItemKind::cone:
      return cones_.size();
  }
  return 0;
}

Box3f Geometry::bounds(ItemId id) const {
  const uint32_t i = item_index(id);
  switch (item_kind(id)) {
    case ItemKind::sphere:
      return raio::bounds(sphere(i));
    case ItemKind::triangle:
      return raio::bounds(triangle(i));
    case ItemKind::cone:
      return raio::bounds(cone(i));
    case ItemKind::plane:
      break;
  }
  return {};
}

size_t Geometry::bytes() const {
  size_t sum = vector_bytes(own_triangles_) + vector_bytes(own_normals_) + vector_bytes(facets_) +
               vector_bytes(cones_);
  for (const auto& s : sides_) sum += vector_bytes(s);
  return sum;
}

}  // namespace raio
