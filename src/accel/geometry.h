// A scene prepared for structures and shading: the kinds that rays hit, polygons as triangles,
// meshes' triangles after the scene's own, and values precomputed for hits. Made once from a Scene.
// Reads the scene's pools in place where possible, so large scenes are not stored twice.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/box.h"
#include "base/memory.h"
#include "base/placement.h"
#include "base/random.h"
#include "base/ray.h"
#include "scene/scene.h"
#include "shape/triangle.h"

namespace raio::core {

/// A triangle's data for shading: 16 bytes.
struct Facet {
  Vec3f normal;  // of the polygon, for its pieces
  MaterialId material = 0;
};

/// The optical depth of an opacity a: a depth of n transmits 2^(-n / kHalving) of the light, 1 - a.
/// Depths are integers, so the order of additions does not matter; sums saturate at
/// kMaxOpticalDepth, which transmits nothing.
inline constexpr uint32_t kHalving = 1u << 20, kMaxOpticalDepth = 64 * kHalving,
                          kOpaque = 0xffffffffu;
uint32_t depth_of_opacity(float opacity);
/// The transmittance.
float passed(uint32_t depth);
/// Whether the depth stops the ray with this 32-bit number. The fraction of all numbers that pass
/// is the transmittance, to 1e-7.
bool stops(uint32_t depth, uint32_t number);

/// The type that tracing uses for a kind, as returned by its bake(). If it differs from the pool's
/// type, it is computed once and stored, else made from the scene's pool each time.
template <PrimitiveKind kind>
using Baked = std::remove_cvref_t<decltype(bake(std::declval<const PrimitiveType<kind>&>()))>;
template <PrimitiveKind kind>
inline constexpr bool kKeepsBaked = !std::is_same_v<Baked<kind>, PrimitiveType<kind>>;

/// By kind, for those stored in baked form.
template <class = std::make_index_sequence<kPrimitiveKinds>>
struct BakedColumnsOf;
template <size_t... k>
struct BakedColumnsOf<std::index_sequence<k...>> {
  using type = std::tuple<std::conditional_t<kKeepsBaked<PrimitiveKind(k)>,
                                             Column<Baked<PrimitiveKind(k)>>, std::monostate>...>;
};

class Geometry {
 public:
  /// Of the scene itself or an object that it shows; both must outlive the result. With
  /// `one_sided`, opaque surfaces are visible from outside only, as in the NFF text.
  /// `with_sources`: source_of() will be called. `opacity`: of primitives without their own.
  Geometry(const Scene& scene, const Object& object, bool one_sided = false,
           bool with_sources = false, float opacity = 1);
  Geometry(Geometry&&) = default;

  /// The scene with the object's materials and textures.
  const Scene& scene() const { return *scene_; }
  const Object& object() const { return *object_; }

  /// Without instances: the primitives in a structure.
  size_t count(PrimitiveKind kind) const { return first_[size_t(kind) + 1] - first_[size_t(kind)]; }
  /// With instances.
  uint64_t count_all(PrimitiveKind kind) const;

  /// Primitive `index` of a kind.
  PrimitiveId id_of(PrimitiveKind kind, uint32_t index) const {
    return first_[size_t(kind)] + index;
  }
  PrimitiveKind kind_of(PrimitiveId id) const {
    size_t kind = kPrimitiveKinds - 1;
    while (kind > 0 && id < first_[kind]) --kind;
    return PrimitiveKind(kind);
  }
  /// Its index, if the kind is known.
  uint32_t index_of(PrimitiveKind kind, PrimitiveId id) const { return id - first_[size_t(kind)]; }
  uint32_t index_of(PrimitiveId id) const { return index_of(kind_of(id), id); }
  /// A number that does not depend on the number of primitives of other kinds.
  static uint32_t key_of(PrimitiveKind kind, uint32_t index) {
    return uint32_t(kind) << 29 ^ index;
  }
  uint32_t key_of(PrimitiveId id) const {
    const PrimitiveKind kind = kind_of(id);
    return key_of(kind, index_of(kind, id));
  }

  Sides sides_of(PrimitiveKind kind, uint32_t index) const {
    const auto& s = sides_[size_t(kind)];
    return s.empty() ? Sides::both : s[index];
  }
  /// Whether both sides of all primitives of the kind are visible.
  bool two_sided(PrimitiveKind kind) const { return sides_[size_t(kind)].empty(); }

  /// Primitive i of a kind, baked: by value or by reference.
  template <PrimitiveKind kind>
  decltype(auto) get(uint32_t i) const {
    if constexpr (kind == PrimitiveKind::triangle) {
      const TriangleIndices& t = triangles_[i];
      return Triangle{positions_[t[0]], positions_[t[1]], positions_[t[2]]};
    } else if constexpr (kKeepsBaked<kind>) {
      return (std::get<size_t(kind)>(baked_)[i]);
    } else {
      return bake((object_->*kPoolOf<PrimitiveType<kind>>.shapes)[i]);
    }
  }
  /// The scene's own or, if it has meshes, a copy of both.
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }

  Plane plane(uint32_t i) const { return get<PrimitiveKind::plane>(i); }
  Sphere sphere(uint32_t i) const { return get<PrimitiveKind::sphere>(i); }
  Triangle triangle(uint32_t i) const { return get<PrimitiveKind::triangle>(i); }

  /// Indices into positions().
  const TriangleIndices& corners(uint32_t triangle) const { return triangles_[triangle]; }
  /// Prefetches the primitive.
  void prefetch(PrimitiveId id) const {
    const PrimitiveKind kind = kind_of(id);
    const uint32_t i = index_of(kind, id);
    if (kind == PrimitiveKind::sphere) __builtin_prefetch(object_->spheres.address(i));
    if (kind == PrimitiveKind::triangle) __builtin_prefetch(&triangles_[i]);
  }

  const Facet& facet(uint32_t triangle) const { return facets_[triangle]; }
  /// The normals at a triangle's vertices, or null if it is flat.
  const TriangleIndices* corner_normals(uint32_t triangle) const {
    if (triangle >= triangle_normals_.size() || triangle_normals_[triangle][0] == kNoNormal)
      return nullptr;
    return &triangle_normals_[triangle];
  }
  bool any_smooth() const { return !triangle_normals_.empty(); }

  /// A colour per item of the kind, or empty: then the materials' colours apply.
  const StridedArray<Rgb>& colors(PrimitiveKind kind) const;
  bool any_colors() const { return any_colors_; }
  /// By index in positions(), multiplied into the colours of triangles; or empty.
  std::span<const Rgb> vertex_colors() const { return own_vertex_colors_; }
  /// By index in positions(), if materials have textures and meshes coordinates; else empty.
  std::span<const Uv> texture_coordinates() const { return own_uv_; }

  /// The optical depth of a primitive; kOpaque if nothing passes.
  uint32_t depth_of(PrimitiveKind kind, uint32_t index) const {
    const auto& depths = depths_[size_t(kind)];
    return depths.empty() ? kOpaque : depths[index];
  }
  uint32_t depth_of(PrimitiveId id) const {
    const PrimitiveKind kind = kind_of(id);
    return depth_of(kind, index_of(kind, id));
  }
  bool is_opaque(PrimitiveKind kind, uint32_t index) const {
    return depth_of(kind, index) == kOpaque;
  }
  /// Whether the transparent primitive stops the ray with this key (Accel::next_transparent()).
  bool stops(PrimitiveKind kind, uint32_t index, uint32_t key) const {
    return core::stops(depth_of(kind, index), hash_of(key, key_of(kind, index)));
  }
  /// The opacity of a triangle or of a piece of a polygon, without its material's texture.
  float triangle_opacity(size_t i) const;
  /// Whether all of the kind are opaque.
  bool all_opaque(PrimitiveKind kind) const { return depths_[size_t(kind)].empty(); }
  /// Primitives of bounded kinds that transmit some light and absorb some; and the opaque ones, if
  /// not all are. In the order of ids.
  Column<PrimitiveId> list_transparent() const;
  Column<PrimitiveId> list_opaque() const;
  bool any_transparent() const { return any_transparent_; }

  /// Adds the baked objects of the scene's instances, one per prototype. The error is one line:
  /// more instances than ids.
  std::optional<std::string> add_objects(std::vector<const Geometry*> objects);
  bool has_instances() const { return !objects_.empty(); }
  /// Nested ones included.
  uint64_t count_instances() const { return instance_count_; }
  /// The instance with this number: its index in Scene::instances, its object, and the number
  /// within that object, which is 0 unless the object has instances.
  struct Placed {
    const Geometry& object;
    uint32_t index = 0;
    InstanceId inner = 0;
  };
  Placed placed(InstanceId instance) const;
  /// The inverse.
  InstanceId instance_id(uint32_t index, InstanceId inner = 0) const {
    return (first_instance_.empty() ? index + 1 : first_instance_[index]) + inner;
  }
  /// The object with the primitives of an instance; this one for number 0.
  const Geometry& object_at(InstanceId instance) const;
  Placement placement(uint32_t index) const {
    return {object_->instances[index].matrix, inverses_[index]};
  }

  /// The origin of a triangle: its index among the scene's own triangles, those of meshes and the
  /// polygons, in this order.
  size_t source_of(uint32_t triangle) const {
    return sources_.empty() ? triangle : sources_[triangle];
  }
  /// The number of triangles of the scene and its meshes, those without area included.
  size_t count_of_triangles() const;

  /// The id of the object (Scene::object_names) that owns the primitive; 0: none. In an instance,
  /// the outermost owner of the enclosing instances, else the primitive's own.
  uint32_t object_of(PrimitiveId id, InstanceId instance = 0) const;
  /// Whether both belong to the same object or to none. An object within a prototype is a different
  /// one in each instance.
  bool same_object(const Hit& a, const Hit& b) const;
  MaterialId material_of(PrimitiveId id, InstanceId instance = 0) const;

  /// Approximate memory for baking an object, in bytes, including temporary memory.
  static double bytes_to_bake(const Scene& scene, const Object& object);

  /// Whether a structure of the other is valid for this one, too: both have the same primitives,
  /// visible sides and optical depths. Colours and materials may differ; instances are not
  /// compared.
  bool traces_like(const Geometry& other) const;

  Box3f bounds(PrimitiveId id) const;  // not for planes, which have none
  size_t bytes() const;                // without the scene

 private:
  void bake_triangles();
  void join_meshes();
  size_t mesh_of(size_t i) const;
  MaterialId triangle_material(size_t i) const;
  void bake_polygons();
  void bake_colors();
  void bake_depths();
  float opacity_of(MaterialId id) const;
  template <class Wanted>
  Column<PrimitiveId> list(const Wanted& wanted) const;
  bool wants_sources() const {
    return with_sources_ || any_colors_ || any_transparent_ || !object_->object_ranges.empty();
  }
  template <PrimitiveKind kind>
  void list_sides(bool one_sided);

  bool same_object(PrimitiveId a, InstanceId in_a, PrimitiveId b, InstanceId in_b) const;

  const Scene* scene_;
  const Object* object_;
  std::array<PrimitiveId, kPrimitiveKinds + 1> first_{};  // of each kind; the last: the total
  std::vector<const Geometry*> objects_;
  Column<Placement::Inverse> inverses_;  // by instance
  Column<InstanceId> first_instance_;    // by instance; empty: no object has instances
  uint64_t instance_count_ = 0;
  bool with_sources_ = false, any_colors_ = false, any_transparent_ = false, bakes_colors_ = false;
  float opacity_ = 1;
  // The scene's own if it has no meshes, else those below.
  std::span<const Vec3f> positions_, normals_;
  Column<Vec3f> own_positions_, own_vertex_normals_;
  Column<Rgb> own_vertex_colors_;
  Column<Uv> own_uv_;
  // The scene's own if every primitive is a triangle with area, else those below.
  std::span<const TriangleIndices> triangles_, triangle_normals_;
  Column<TriangleIndices> own_triangles_, own_normals_;
  // The number of triangles before each mesh's: the scene's own and those of earlier meshes.
  std::vector<uint32_t> mesh_begin_;
  // source_of() of each triangle. Empty if it is the index, or never requested.
  Column<uint32_t> sources_;
  StridedArray<Rgb> triangle_colors_;  // the object's or baked
  Column<Facet> facets_;
  BakedColumnsOf<>::type baked_;
  std::array<Column<Sides>, kPrimitiveKinds> sides_;      // empty: all are two-sided
  std::array<Column<uint32_t>, kPrimitiveKinds> depths_;  // empty: all are opaque
};

}  // namespace raio::core
