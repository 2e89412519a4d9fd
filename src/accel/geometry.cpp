#include "accel/geometry.h"

#include <algorithm>
#include <atomic>

#include "accel/parallel.h"
#include "shape/polygon.h"

namespace raio {
namespace {

template <class T>
size_t column_bytes(const Column<T>& v) {
  return v.capacity() * sizeof(T);
}

constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};

// Triangles on their way to their places.
struct Pieces {
  std::vector<TriangleIndices> corners, normals;
  std::vector<Facet> facets;

  void push(const TriangleIndices& c, const Facet& facet, const TriangleIndices& n) {
    corners.push_back(c);
    facets.push_back(facet);
    normals.push_back(n);
  }
};

Triangle triangle_of(const Scene& s, const TriangleIndices& c) {
  return {s.positions[c[0]], s.positions[c[1]], s.positions[c[2]]};
}

void add_polygon(const Scene& s, size_t i, Pieces& out) {
  const Polygon& p = s.polygons[i];
  const std::span corners(s.positions.data() + p.first, p.count);
  const Facet facet{polygon_normal(corners), s.polygon_materials[i]};
  for (const auto& [a, b, c] : triangulate(corners)) {
    const TriangleIndices piece = {p.first + a, p.first + b, p.first + c};
    if (triangle_normal(triangle_of(s, piece)) != Vec3f()) out.push(piece, facet, kFlat);
  }
}

}  // namespace

Geometry::Geometry(const Scene& scene, bool one_sided) : scene_(&scene) {
  bake_triangles();
  cones_.resize(scene.cones.size());
  for_each_index(cones_.size(), [&](size_t i) { cones_[i] = BakedCone(scene.cones[i]); });
  list_sides(one_sided);
}

double Geometry::bytes_to_bake(const Scene& s) {
  double pieces = 0;  // are listed twice
  for (const Polygon& p : s.polygons) pieces += p.count;
  if (pieces > 0) pieces += double(s.triangles.size());
  const double piece = sizeof(Facet) + 2 * sizeof(TriangleIndices);
  return double(s.triangles.size()) * sizeof(Facet) + double(s.cones.size()) * sizeof(BakedCone) +
         2 * piece * pieces + double(s.primitive_count()) * sizeof(Sides);
}

// Triangles without area are left out, since no ray can hit one.
void Geometry::bake_triangles() {
  const Scene& s = *scene_;
  triangles_ = s.triangles;
  triangle_normals_ = s.triangle_normals;
  facets_.resize(s.triangles.size());
  std::atomic<bool> any_flat = false;
  for_each_index(facets_.size(), [&](size_t i) {
    facets_[i] = {triangle_normal(triangle(uint32_t(i))), s.triangle_materials[i]};
    if (facets_[i].normal == Vec3f()) any_flat.store(true, std::memory_order_relaxed);
  });
  if (any_flat || !s.polygons.empty()) bake_polygons();
}

// Puts the pieces of polygons after the triangles with an area.
void Geometry::bake_polygons() {
  const Scene& s = *scene_;
  const size_t n = s.triangles.size(), count = n + s.polygons.size();
  const bool smooth = any_smooth();
  std::vector<Pieces> chunks(chunks_of(count));
  for_chunks(count, [&](size_t c, size_t first, size_t end) {
    for (size_t i = first; i < end; ++i)
      if (i >= n)
        add_polygon(s, i - n, chunks[c]);
      else if (facets_[i].normal != Vec3f())
        chunks[c].push(s.triangles[i], facets_[i], smooth ? s.triangle_normals[i] : kFlat);
  });
  std::vector<size_t> begin = {0};
  for (const Pieces& chunk : chunks) begin.push_back(begin.back() + chunk.corners.size());
  own_triangles_.resize(begin.back());
  if (smooth) own_normals_.resize(begin.back());
  facets_ = Column<Facet>(begin.back());
  for_chunks(count, [&](size_t c, size_t, size_t) {
    const auto at = ptrdiff_t(begin[c]);
    std::ranges::copy(chunks[c].corners, own_triangles_.begin() + at);
    std::ranges::copy(chunks[c].facets, facets_.begin() + at);
    if (smooth) std::ranges::copy(chunks[c].normals, own_normals_.begin() + at);
    chunks[c] = {};
  });
  triangles_ = own_triangles_;
  triangle_normals_ = own_normals_;
}

// Which side of each item is seen, for the kinds that have one of which it is not both.
void Geometry::list_sides(bool one_sided) {
  const Scene& s = *scene_;
  const auto list = [&](PrimitiveKind kind, auto&& material, auto&& inside_only) {
    const auto side = [&](size_t i) {
      const bool opaque = s.materials[material(i)].transmission == 0;
      return inside_only(i) ? Sides::inside : one_sided && opaque ? Sides::outside : Sides::both;
    };
    std::atomic<bool> any = false;
    for_chunks(count(kind), [&](size_t, size_t first, size_t end) {
      bool here = false;
      for (size_t i = first; i < end; ++i) here |= side(i) != Sides::both;
      if (here) any.store(true, std::memory_order_relaxed);
    });
    if (!any) return;
    Column<Sides>& sides = sides_[size_t(kind)];
    sides.resize(count(kind));
    for_each_index(sides.size(), [&](size_t i) { sides[i] = side(i); });
  };
  const auto never = [](size_t) { return false; };
  list(
      PrimitiveKind::sphere, [&](size_t i) { return s.sphere_materials[i]; },
      [&](size_t i) { return s.spheres[i].radius < 0; });
  list(
      PrimitiveKind::cone, [&](size_t i) { return s.cone_materials[i]; },
      [&](size_t i) { return s.cones[i].base_radius < 0 || s.cones[i].apex_radius < 0; });
  list(PrimitiveKind::plane, [&](size_t i) { return s.plane_materials[i]; }, never);
  if (one_sided)
    list(PrimitiveKind::triangle, [&](size_t i) { return facets_[i].material; }, never);
}

size_t Geometry::count(PrimitiveKind kind) const {
  switch (kind) {
    case PrimitiveKind::plane:
      return scene_->planes.size();
    case PrimitiveKind::sphere:
      return scene_->spheres.size();
    case PrimitiveKind::triangle:
      return facets_.size();
    case PrimitiveKind::cone:
      return cones_.size();
  }
  return 0;
}

Box3f Geometry::bounds(PrimitiveId id) const {
  const uint32_t i = primitive_index(id);
  switch (primitive_kind(id)) {
    case PrimitiveKind::sphere:
      return raio::bounds(sphere(i));
    case PrimitiveKind::triangle:
      return raio::bounds(triangle(i));
    case PrimitiveKind::cone:
      return raio::bounds(cone(i));
    case PrimitiveKind::plane:
      break;
  }
  return {};
}

size_t Geometry::bytes() const {
  size_t sum = column_bytes(own_triangles_) + column_bytes(own_normals_) + column_bytes(facets_) +
               column_bytes(cones_);
  for (const auto& s : sides_) sum += column_bytes(s);
  return sum;
}

}  // namespace raio
