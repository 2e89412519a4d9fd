#include "accel/geometry.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <memory>

#include "base/exact_math.h"
#include "base/parallel.h"
#include "shape/polygon.h"

namespace raio::core {
namespace {

template <class T>
size_t column_bytes(const Column<T>& v) {
  return v.capacity() * sizeof(T);
}

constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};

// Intermediate triangles.
struct Pieces {
  std::vector<TriangleIndices> corners, normals;
  std::vector<Facet> facets;
  std::vector<uint32_t> sources;
  bool with_sources = false;

  void push(const TriangleIndices& c, const Facet& facet, const TriangleIndices& n, size_t source) {
    corners.push_back(c);
    facets.push_back(facet);
    normals.push_back(n);
    if (with_sources) sources.push_back(uint32_t(source));
  }
};

Triangle triangle_of(const Object& s, const TriangleIndices& c) {
  return {s.positions[c[0]], s.positions[c[1]], s.positions[c[2]]};
}

// Bit by bit.
template <class Elements>
bool same_elements(const Elements& a, const Elements& b) {
  using Bytes = std::array<std::byte, sizeof(typename Elements::value_type)>;
  if (a.size() != b.size()) return false;
  std::atomic<bool> same = true;
  for_chunks(a.size(), [&](size_t, size_t first, size_t end) {
    for (size_t i = first; i < end && same.load(std::memory_order_relaxed); ++i)
      if (std::bit_cast<Bytes>(a[i]) != std::bit_cast<Bytes>(b[i]))
        same.store(false, std::memory_order_relaxed);
  });
  return same;
}

void add_polygon(const Object& s, size_t i, size_t source, Pieces& out) {
  const Polygon& p = s.polygons[i];
  const std::span corners(s.positions.data() + p.first, p.count);
  const Facet facet{polygon_normal(corners), s.polygon_materials[i]};
  for (const auto& [a, b, c] : triangulate(corners)) {
    const TriangleIndices piece = {p.first + a, p.first + b, p.first + c};
    if (triangle_normal(triangle_of(s, piece)) != Vec3f()) out.push(piece, facet, kFlat, source);
  }
}

}  // namespace

uint32_t depth_of_opacity(float opacity) {
  const double passes = 1 - double(opacity);
  if (!(passes > 0)) return kOpaque;
  return uint32_t(std::llround(-exact_log2(std::min(passes, 1.0)) * kHalving));
}

// The transmittance of a fraction of a halving, in units of 2^-31. Linear interpolation is accurate
// to 6e-8.
static uint32_t part_of_halving(uint32_t depth) {
  static constexpr uint32_t kSteps = 1024, kStep = kHalving / kSteps;
  static const auto parts = [] {
    std::array<uint32_t, kSteps + 1> out{};
    for (size_t i = 0; i <= kSteps; ++i)
      out[i] = uint32_t(std::llround(0x1p31 * exact_exp2(-double(i) / kSteps)));
    return out;
  }();
  const uint32_t step = depth / kStep;
  const uint64_t fall = uint64_t(parts[step] - parts[step + 1]) * (depth % kStep) / kStep;
  return parts[step] - uint32_t(fall);
}

float passed(uint32_t depth) {
  // Too little for a film to record.
  if (depth >= 40 * kHalving) return 0;
  const double halved = double(uint64_t(1) << (depth / kHalving));
  return float(double(part_of_halving(depth % kHalving)) * 0x1p-31 / halved);
}

bool stops(uint32_t depth, uint32_t number) {
  const uint32_t halvings = depth / kHalving;
  return halvings >= 31 || number >> 1 >= part_of_halving(depth % kHalving) >> halvings;
}

Geometry::Geometry(const Scene& scene, const Object& object, bool one_sided, bool with_sources,
                   float opacity)
    : scene_(&scene),
      object_(&object),
      with_sources_(with_sources),
      any_colors_(core::any_colors(object)),
      any_transparent_(opacity < 1 || core::any_transparent(scene, object)),
      opacity_(opacity) {
  bake_triangles();
  for_each_kind([&]<PrimitiveKind kind> {
    size_t count = facets_.size();
    if constexpr (kind != PrimitiveKind::triangle)
      count = (object.*kPoolOf<PrimitiveType<kind>>.shapes).size();
    first_[size_t(kind) + 1] = first_[size_t(kind)] + PrimitiveId(count);
  });
  bake_colors();
  if (any_transparent_) bake_depths();
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kKeepsBaked<kind>) {
      const auto& shapes = object.*kPoolOf<PrimitiveType<kind>>.shapes;
      auto& baked = std::get<size_t(kind)>(baked_);
      baked.resize(shapes.size());
      for_each_index(baked.size(), [&](size_t i) { baked[i] = bake(shapes[i]); });
    }
  });
  for_each_kind([&]<PrimitiveKind kind> { list_sides<kind>(one_sided); });
}

double Geometry::bytes_to_bake(const Scene& scene, const Object& object) {
  double pieces = 0, triangles = double(object.triangles.size());
  double joined = 0;  // meshes' data is copied, and with it the scene's of the same kind
  for (const Mesh& mesh : object.meshes) {
    triangles += double(mesh.triangles.size());
    // With vertex colours, which any mesh may have.
    joined += double(2 * mesh.positions.size() + mesh.normals.size()) * sizeof(Vec3f);
    if (!scene.textures.empty()) joined += double(mesh.positions.size()) * sizeof(Uv);
  }
  if (!object.meshes.empty())
    joined += double(object.positions.size() + object.normals.size()) * sizeof(Vec3f) +
              triangles * 2 * sizeof(TriangleIndices);
  for (const Polygon& p : object.polygons) pieces += p.count;  // are listed twice
  if (pieces > 0) pieces += triangles;
  double piece = sizeof(Facet) + 2 * sizeof(TriangleIndices);
  if (core::any_colors(object) || !object.object_ranges.empty())
    piece += sizeof(uint32_t) + sizeof(Rgb);
  double baked = 0, own = triangles + pieces;  // without instances
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kind != PrimitiveKind::triangle) {
      const auto count = double((object.*kPoolOf<PrimitiveType<kind>>.shapes).size());
      if constexpr (kKeepsBaked<kind>) baked += count * sizeof(Baked<kind>);
      own += count;
    }
  });
  return joined + triangles * sizeof(Facet) + baked + 2 * piece * pieces +
         own * (sizeof(Sides) + (core::any_transparent(scene, object)
                                     ? sizeof(uint32_t) + 2 * sizeof(PrimitiveId)
                                     : 0));
}

// Triangles without area are dropped, since no ray can hit them.
void Geometry::bake_triangles() {
  const Object& s = *object_;
  positions_ = s.positions, normals_ = s.normals;
  triangles_ = s.triangles;
  triangle_normals_ = s.triangle_normals;
  if (!s.meshes.empty()) join_meshes();
  facets_.resize(triangles_.size());
  std::atomic<bool> any_flat = false;
  for_each_index(facets_.size(), [&](size_t i) {
    facets_[i] = {triangle_normal(triangle(uint32_t(i))), triangle_material(i)};
    if (facets_[i].normal == Vec3f()) any_flat.store(true, std::memory_order_relaxed);
  });
  if (any_flat || !s.polygons.empty()) bake_polygons();
}

// Concatenates the scene's own triangles and those of meshes.
void Geometry::join_meshes() {
  const Object& s = *object_;
  size_t positions = s.positions.size(), normals = s.normals.size(), count = s.triangles.size();
  bool smooth = !s.triangle_normals.empty();
  for (const Mesh& mesh : s.meshes) {
    mesh_begin_.push_back(uint32_t(count));
    positions += mesh.positions.size(), normals += mesh.normals.size();
    count += mesh.triangles.size();
    smooth |= !mesh.normals.empty();
  }
  own_positions_.reserve(positions), own_vertex_normals_.reserve(normals);
  own_triangles_.reserve(count);
  if (smooth) own_normals_.reserve(count);
  const auto fill = [](auto& to, size_t more, const auto& value) {
    const size_t before = to.size();
    to.resize(before + more);
    for_each_index(more, [&](size_t i) { to[before + i] = value; });
  };
  const auto append = [](auto& to, const auto& from) {
    const size_t before = to.size();
    to.resize(before + from.size());
    for_each_index(from.size(), [&](size_t i) { to[before + i] = from[i]; });
  };
  const auto append_corners = [](Column<TriangleIndices>& to, const Array<TriangleIndices>& from,
                                 size_t first) {
    const size_t before = to.size();
    to.resize(before + from.size());
    for_each_index(from.size(), [&](size_t i) {
      TriangleIndices& moved = to[before + i] = from[i];
      for (uint32_t& vertex : moved)
        if (vertex != kNoNormal) vertex += uint32_t(first);
    });
  };
  append(own_positions_, s.positions), append(own_vertex_normals_, s.normals);
  append(own_triangles_, s.triangles), append(own_normals_, s.triangle_normals);
  if (smooth && s.triangle_normals.empty()) fill(own_normals_, s.triangles.size(), kFlat);
  for (const Mesh& mesh : s.meshes) {
    append_corners(own_triangles_, mesh.triangles, own_positions_.size());
    if (!mesh.normals.empty())
      append_corners(own_normals_,
                     mesh.normal_indices.empty() ? mesh.triangles : mesh.normal_indices,
                     own_vertex_normals_.size());
    else if (smooth)
      fill(own_normals_, mesh.triangles.size(), kFlat);
    append(own_positions_, mesh.positions), append(own_vertex_normals_, mesh.normals);
  }
  // Elements without values get the `usual` one.
  const auto join = [&]<class T>(Column<T>& to, Array<T> Mesh::* column, const T& usual) {
    if (std::ranges::all_of(s.meshes, [&](const Mesh& mesh) { return (mesh.*column).empty(); }))
      return;
    to.reserve(positions);
    fill(to, s.positions.size(), usual);
    for (const Mesh& mesh : s.meshes)
      if (const Array<T>& from = mesh.*column; from.empty())
        fill(to, mesh.positions.size(), usual);
      else
        append(to, from);
  };
  join(own_vertex_colors_, &Mesh::colors, Rgb(1));
  if (!scene_->textures.empty()) join(own_uv_, &Mesh::uv, Uv{});
  positions_ = own_positions_, normals_ = own_vertex_normals_;
  triangles_ = own_triangles_, triangle_normals_ = own_normals_;
}

// The mesh of triangle `i`, counted with the scene's own.
size_t Geometry::mesh_of(size_t i) const {
  return size_t(std::ranges::upper_bound(mesh_begin_, i) - mesh_begin_.begin()) - 1;
}

// The scene's own and those of meshes.
size_t Geometry::count_of_triangles() const {
  return mesh_begin_.empty() ? object_->triangles.size()
                             : mesh_begin_.back() + object_->meshes.back().triangles.size();
}

// Of the scene's own or of a mesh, before any is dropped.
MaterialId Geometry::triangle_material(size_t i) const {
  const Object& s = *object_;
  if (i < s.triangles.size()) return s.triangle_materials[i];
  const size_t m = mesh_of(i);
  const Array<MaterialId>& materials = s.meshes[m].materials;
  return materials[materials.size() == 1 ? 0 : i - mesh_begin_[m]];
}

// Appends the pieces of polygons to the triangles with area.
void Geometry::bake_polygons() {
  const Object& s = *object_;
  const size_t n = triangles_.size(), count = n + s.polygons.size();
  const bool smooth = any_smooth();
  std::vector<Pieces> chunks(chunks_of(count));
  for_chunks(count, [&](size_t c, size_t first, size_t end) {
    chunks[c].with_sources = wants_sources();
    for (size_t i = first; i < end; ++i)
      if (i >= n)
        add_polygon(s, i - n, i, chunks[c]);
      else if (facets_[i].normal != Vec3f())
        chunks[c].push(triangles_[i], facets_[i], smooth ? triangle_normals_[i] : kFlat, i);
  });
  std::vector<size_t> begin = {0};
  for (const Pieces& chunk : chunks) begin.push_back(begin.back() + chunk.corners.size());
  own_triangles_.resize(begin.back());
  if (smooth) own_normals_.resize(begin.back());
  if (wants_sources()) sources_.resize(begin.back());
  facets_ = Column<Facet>(begin.back());
  for_chunks(count, [&](size_t c, size_t, size_t) {
    const auto at = ptrdiff_t(begin[c]);
    std::ranges::copy(chunks[c].corners, own_triangles_.begin() + at);
    std::ranges::copy(chunks[c].facets, facets_.begin() + at);
    if (smooth) std::ranges::copy(chunks[c].normals, own_normals_.begin() + at);
    if (wants_sources()) std::ranges::copy(chunks[c].sources, sources_.begin() + at);
    chunks[c] = {};
  });
  triangles_ = own_triangles_;
  triangle_normals_ = own_normals_;
}

// If others have colours, a triangle without one gets its material's.
void Geometry::bake_colors() {
  const Object& s = *object_;
  if (s.triangle_colors.empty() && s.polygon_colors.empty()) return;
  triangle_colors_ = s.triangle_colors;
  if (facets_.size() == triangle_colors_.size() && sources_.empty()) return;
  const size_t polygons = count_of_triangles();
  const auto baked = std::make_shared<Column<Rgb>>(facets_.size());
  Column<Rgb>& colors = *baked;
  for_each_index(facets_.size(), [&](size_t i) {
    const size_t source = source_of(uint32_t(i));
    if (source < s.triangle_colors.size())
      colors[i] = s.triangle_colors[source];
    else if (source >= polygons && !s.polygon_colors.empty())
      colors[i] = s.polygon_colors[source - polygons];
    else
      colors[i] = scene_->materials[facets_[i].material].color;
  });
  triangle_colors_ = Array<Rgb>::borrow(colors.data(), colors.size(), baked);
  bakes_colors_ = true;
}

float Geometry::triangle_opacity(size_t i) const {
  const Object& s = *object_;
  const size_t source = source_of(uint32_t(i)), polygons = count_of_triangles();
  if (source < s.triangle_opacity.size()) return s.triangle_opacity[source];
  if (source >= polygons && !s.polygon_opacity.empty()) return s.polygon_opacity[source - polygons];
  return opacity_of(facets_[i].material);
}

// Of primitives without their own.
float Geometry::opacity_of(MaterialId id) const {
  const Array<float>& opacity = scene_->material_opacity;
  return opacity.empty() || opacity[id] == 1 ? opacity_ : opacity[id];
}

void Geometry::bake_depths() {
  const Object& s = *object_;
  for_each_kind([&]<PrimitiveKind kind> {
    const auto opacity = [&](size_t i) {
      if constexpr (kind == PrimitiveKind::triangle) {
        // The opacity of cutouts applies where rays hit them.
        return scene_->has_cutouts(facets_[i].material) ? 1 : triangle_opacity(i);
      } else {
        const auto& own = s.*kPoolOf<PrimitiveType<kind>>.opacity;
        if (!own.empty()) return own[i];
        return opacity_of(material_of(id_of(kind, uint32_t(i))));
      }
    };
    std::atomic<bool> any = false;
    for_chunks(count(kind), [&](size_t, size_t first, size_t end) {
      bool here = false;
      for (size_t i = first; i < end; ++i) here |= opacity(i) < 1;
      if (here) any.store(true, std::memory_order_relaxed);
    });
    if (!any) return;
    Column<uint32_t>& depths = depths_[size_t(kind)];
    depths.resize(count(kind));
    for_each_index(depths.size(), [&](size_t i) { depths[i] = depth_of_opacity(opacity(i)); });
  });
}

template <class Wanted>
Column<PrimitiveId> Geometry::list(const Wanted& wanted) const {
  Column<PrimitiveId> out;
  out.reserve(first_.back() - first_[size_t(PrimitiveKind::plane) + 1]);
  StopCheck look;
  for_each_bounded_kind([&]<PrimitiveKind kind> {
    for (uint32_t i = 0; i < count(kind); ++i, look())
      if (wanted(depth_of(kind, i))) out.push_back(id_of(kind, i));
  });
  return out;
}

Column<PrimitiveId> Geometry::list_transparent() const {
  return list([](uint32_t depth) { return depth != kOpaque && depth > 0; });
}

Column<PrimitiveId> Geometry::list_opaque() const {
  return list([](uint32_t depth) { return depth == kOpaque; });
}

const StridedArray<Rgb>& Geometry::colors(PrimitiveKind kind) const {
  return with_kind(kind, [&]<PrimitiveKind k>() -> const StridedArray<Rgb>& {
    if constexpr (k == PrimitiveKind::triangle)
      return triangle_colors_;
    else
      return object_->*kPoolOf<PrimitiveType<k>>.colors;
  });
}

uint32_t Geometry::object_of(PrimitiveId id, InstanceId instance) const {
  const Object& s = *object_;
  if (instance) {
    const Placed at = placed(instance);
    const uint32_t own = core::object_of(s, PoolKind::instance, at.index);
    return own ? own : at.object.object_of(id, at.inner);
  }
  if (s.object_ranges.empty()) return 0;
  const PrimitiveKind its_kind = kind_of(id);
  const uint32_t index = index_of(its_kind, id);
  if (its_kind != PrimitiveKind::triangle)
    return with_kind(its_kind, [&]<PrimitiveKind kind> {
      if constexpr (kind == PrimitiveKind::triangle)
        return uint32_t(0);
      else
        return core::object_of(s, kPoolOf<PrimitiveType<kind>>.kind, index);
    });
  const size_t source = source_of(index);
  if (source < s.triangles.size()) return core::object_of(s, PoolKind::triangle, source);
  if (source >= count_of_triangles())
    return core::object_of(s, PoolKind::polygon, source - count_of_triangles());
  return core::object_of(s, PoolKind::mesh, mesh_of(source));
}

bool Geometry::same_object(const Hit& a, const Hit& b) const {
  return same_object(a.primitive, a.instance, b.primitive, b.instance);
}

bool Geometry::same_object(PrimitiveId a, InstanceId in_a, PrimitiveId b, InstanceId in_b) const {
  const uint32_t object = object_of(a, in_a);
  if (object != object_of(b, in_b)) return false;
  if (object == 0 || !in_a || !in_b) return true;
  const Placed at = placed(in_a), other = placed(in_b);
  // The instances themselves belong to it, or their contents do.
  const uint32_t own = core::object_of(*object_, PoolKind::instance, at.index);
  if (own || core::object_of(*object_, PoolKind::instance, other.index)) return true;
  return at.index == other.index && at.object.same_object(a, at.inner, b, other.inner);
}

// The visible side of each primitive, for kinds with one-sided primitives.
template <PrimitiveKind kind>
void Geometry::list_sides(bool one_sided) {
  constexpr bool kIsTriangle = kind == PrimitiveKind::triangle;
  if (kIsTriangle && !one_sided)
    return;  // most triangles of large scenes are never visible from inside only
  const Object& s = *object_;
  const auto side = [&](size_t i) {
    bool inside_only = false;
    if constexpr (!kIsTriangle)
      inside_only = only_inside_seen((s.*kPoolOf<PrimitiveType<kind>>.shapes)[i]);
    const MaterialId material = material_of(id_of(kind, uint32_t(i)));
    const bool opaque =
        scene_->materials[material].transmission == 0 && is_opaque(kind, uint32_t(i));
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

uint64_t Geometry::count_all(PrimitiveKind kind) const {
  uint64_t sum = count(kind);
  for (const Instance instance : object_->instances)
    if (has_instances()) sum += objects_[instance.prototype]->count_all(kind);
  return sum;
}

std::optional<std::string> Geometry::add_objects(std::vector<const Geometry*> objects) {
  objects_ = std::move(objects);
  const auto& instances = object_->instances;
  inverses_.resize(instances.size());
  for_each_index(instances.size(),
                 [&](size_t i) { inverses_[i] = Placement(instances[i].matrix).inverse(); });
  instance_count_ = instances.size();
  const auto has_own = [](const Geometry* object) { return object->has_instances(); };
  if (std::ranges::any_of(objects_, has_own)) {
    first_instance_.resize(instances.size());
    instance_count_ = 0;
    StopCheck look;
    for (size_t i = 0; i < instances.size() && instance_count_ <= kMaxInstances; ++i, look()) {
      first_instance_[i] = InstanceId(instance_count_ + 1);
      instance_count_ += 1 + objects_[instances[i].prototype]->count_instances();
    }
  }
  if (instance_count_ > kMaxInstances)
    return "the scene has more than " + std::to_string(kMaxInstances) +
           " instances, nested ones included";
  for (const Geometry* object : objects_) any_transparent_ |= object->any_transparent();
  return std::nullopt;
}

Geometry::Placed Geometry::placed(InstanceId instance) const {
  uint32_t index = instance - 1;
  if (!first_instance_.empty())
    index =
        uint32_t(std::ranges::upper_bound(first_instance_, instance) - first_instance_.begin()) - 1;
  return {*objects_[object_->instances[index].prototype], index, instance - instance_id(index)};
}

const Geometry& Geometry::object_at(InstanceId instance) const {
  if (!instance) return *this;
  const Placed at = placed(instance);
  return at.object.object_at(at.inner);
}

MaterialId Geometry::material_of(PrimitiveId id, InstanceId instance) const {
  if (instance) return object_at(instance).material_of(id);
  const PrimitiveKind its_kind = kind_of(id);
  const uint32_t i = index_of(its_kind, id);
  return with_kind(its_kind, [&]<PrimitiveKind kind> {
    if constexpr (kind == PrimitiveKind::triangle)
      return facets_[i].material;
    else
      return (object_->*kPoolOf<PrimitiveType<kind>>.materials)[i];
  });
}

bool Geometry::traces_like(const Geometry& other) const {
  bool same = first_ == other.first_ && sides_ == other.sides_ && depths_ == other.depths_ &&
              same_elements(triangles_, other.triangles_) &&
              same_elements(positions_, other.positions_);
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kind != PrimitiveKind::triangle) {
      constexpr auto kShapes = kPoolOf<PrimitiveType<kind>>.shapes;
      same = same && same_elements(object_->*kShapes, other.object_->*kShapes);
    }
  });
  return same;
}

// NOLINTNEXTLINE(readability-convert-member-functions-to-static): get() reads members
Box3f Geometry::bounds(PrimitiveId id) const {
  return with_kind(kind_of(id), [&]<PrimitiveKind kind> {
    if constexpr (kIsBounded<kind>)
      return core::bounds(get<kind>(index_of(kind, id)));
    else
      return Box3f();
  });
}

size_t Geometry::bytes() const {
  size_t sum = column_bytes(own_triangles_) + column_bytes(own_normals_) + column_bytes(facets_) +
               column_bytes(own_positions_) + column_bytes(own_vertex_normals_) +
               column_bytes(sources_) + (bakes_colors_ ? triangle_colors_.bytes() : 0) +
               column_bytes(own_vertex_colors_) + column_bytes(own_uv_);
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kKeepsBaked<kind>) sum += column_bytes(std::get<size_t(kind)>(baked_));
  });
  for (const auto& s : sides_) sum += column_bytes(s);
  for (const auto& depths : depths_) sum += column_bytes(depths);
  return sum + column_bytes(inverses_) + column_bytes(first_instance_);
}

}  // namespace raio::core
