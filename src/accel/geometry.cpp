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
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kKeepsBaked<kind>) {
      const auto& shapes = scene.*kPoolOf<PrimitiveType<kind>>.shapes;
      auto& baked = std::get<size_t(kind)>(baked_);
      baked.resize(shapes.size());
      for_each_index(baked.size(), [&](size_t i) { baked[i] = bake(shapes[i]); });
    }
  });
  for_each_kind([&]<PrimitiveKind kind> { list_sides<kind>(one_sided); });
}

double Geometry::bytes_to_bake(const Scene& s) {
  double pieces = 0;  // are listed twice
  for (const Polygon& p : s.polygons) pieces += p.count;
  if (pieces > 0) pieces += double(s.triangles.size());
  const double piece = sizeof(Facet) + 2 * sizeof(TriangleIndices);
  double baked = 0;
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kKeepsBaked<kind>)
      baked += double((s.*kPoolOf<PrimitiveType<kind>>.shapes).size()) * sizeof(Baked<kind>);
  });
  return double(s.triangles.size()) * sizeof(Facet) + baked + 2 * piece * pieces +
         double(s.primitive_count()) * sizeof(Sides);
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

// Which side of each primitive is seen, for the kinds that have one of which it is not both.
template <PrimitiveKind kind>
void Geometry::list_sides(bool one_sided) {
  constexpr bool kFlat = kind == PrimitiveKind::triangle;
  if (kFlat && !one_sided) return;  // of large scenes most, and never seen from inside only
  const Scene& s = *scene_;
  const auto side = [&](size_t i) {
    bool inside_only = false;
    if constexpr (!kFlat)
      inside_only = only_inside_seen((s.*kPoolOf<PrimitiveType<kind>>.shapes)[i]);
    const MaterialId material = material_of(primitive_id(kind, uint32_t(i)));
    const bool opaque = s.materials[material].transmission == 0;
    return inside_only ? Sides::inside : one_sided && opaque ? Sides::outside : Sides::both;
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
}

size_t Geometry::count(PrimitiveKind kind) const {
  return with_kind(kind, [&]<PrimitiveKind k> {
    if constexpr (k == PrimitiveKind::triangle)
      return facets_.size();
    else
      return (scene_->*kPoolOf<PrimitiveType<k>>.shapes).size();
  });
}

MaterialId Geometry::material_of(PrimitiveId id) const {
  const uint32_t i = primitive_index(id);
  return with_kind(primitive_kind(id), [&]<PrimitiveKind kind> {
    if constexpr (kind == PrimitiveKind::triangle)
      return facets_[i].material;
    else
      return (scene_->*kPoolOf<PrimitiveType<kind>>.materials)[i];
  });
}

Box3f Geometry::bounds(PrimitiveId id) const {
  return with_kind(primitive_kind(id), [&]<PrimitiveKind kind> {
    if constexpr (kIsBounded<kind>)
      return raio::bounds(get<kind>(primitive_index(id)));
    else
      return Box3f();
  });
}

size_t Geometry::bytes() const {
  size_t sum = column_bytes(own_triangles_) + column_bytes(own_normals_) + column_bytes(facets_);
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kKeepsBaked<kind>) sum += column_bytes(std::get<size_t(kind)>(baked_));
  });
  for (const auto& s : sides_) sum += column_bytes(s);
  return sum;
}

}  // namespace raio
