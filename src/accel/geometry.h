// A scene as structures and shading see it: the kinds that rays meet, polygons cut into triangles,
// those of meshes behind the scene's own, what a hit wants to know worked out beforehand. Made once
// from a Scene, whose own pools it reads in place wherever it can: large scenes are not stored
// twice.
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

namespace raio {

/// What shading wants of a triangle: 16 bytes.
struct Facet {
  Vec3f normal;  // of the polygon, for a piece of one
  MaterialId material = 0;
};

/// The optical depth of an opacity a: light that passes a depth of n is 2^(-n / kHalving) of what
/// it was, 1 - a. Depths are whole numbers, so that it does not matter in which order they are
/// added; a sum counts up to kMaxOpticalDepth, where nothing is left.
inline constexpr uint32_t kHalving = 1u << 20, kMaxOpticalDepth = 64 * kHalving,
                          kOpaque = 0xffffffffu;
uint32_t depth_of_opacity(float opacity);
/// The part of the light that passes.
float passed(uint32_t depth);
/// Does the depth stop one of the rays that have all 32-bit numbers? As many pass as there is light
/// that passes, to 1e-7.
bool stops(uint32_t depth, uint32_t number);

/// What tracing wants of a kind, as the kind's bake() returns it. Where that is a type of its own,
/// it is worked out once and kept, else made of the scene's own pool each time.
template <PrimitiveKind kind>
using Baked = std::remove_cvref_t<decltype(bake(std::declval<const PrimitiveType<kind>&>()))>;
template <PrimitiveKind kind>
inline constexpr bool kKeepsBaked = !std::is_same_v<Baked<kind>, PrimitiveType<kind>>;

/// By kind, for those that keep what is baked.
template <class = std::make_index_sequence<kPrimitiveKinds>>
struct BakedColumnsOf;
template <size_t... k>
struct BakedColumnsOf<std::index_sequence<k...>> {
  using type = std::tuple<std::conditional_t<kKeepsBaked<PrimitiveKind(k)>,
                                             Column<Baked<PrimitiveKind(k)>>, std::monostate>...>;
};

class Geometry {
 public:
  /// Of an object that the scene shows, or of the scene itself; both must outlive the result. With
  /// `one_sided`, opaque surfaces are seen from outside only, as the NFF text has it.
  /// `with_sources`: source_of() will be asked. `opacity`: of what has none.
  Geometry(const Scene& scene, const Object& object, bool one_sided = false,
           bool with_sources = false, float opacity = 1);
  Geometry(Geometry&&) = default;

  /// What the object's materials and textures are those of.
  const Scene& scene() const { return *scene_; }
  const Object& object() const { return *object_; }

  /// Without those of instances: what a structure is built over.
  size_t count(PrimitiveKind kind) const { return first_[size_t(kind) + 1] - first_[size_t(kind)]; }
  /// With those of instances.
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
  /// Its index, where the kind is known.
  uint32_t index_of(PrimitiveKind kind, PrimitiveId id) const { return id - first_[size_t(kind)]; }
  uint32_t index_of(PrimitiveId id) const { return index_of(kind_of(id), id); }
  /// A number that does not depend on how many primitives of other kinds there are.
  uint32_t key_of(PrimitiveKind kind, uint32_t index) const { return uint32_t(kind) << 29 ^ index; }
  uint32_t key_of(PrimitiveId id) const {
    const PrimitiveKind kind = kind_of(id);
    return key_of(kind, index_of(kind, id));
  }

  Sides sides_of(PrimitiveKind kind, uint32_t index) const {
    const auto& s = sides_[size_t(kind)];
    return s.empty() ? Sides::both : s[index];
  }
  /// Are both sides of all primitives of the kind seen?
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
  /// The scene's, or, where it has meshes, copies of those and of the meshes'.
  std::span<const Vec3f> positions() const { return positions_; }
  std::span<const Vec3f> normals() const { return normals_; }

  Plane plane(uint32_t i) const { return get<PrimitiveKind::plane>(i); }
  Sphere sphere(uint32_t i) const { return get<PrimitiveKind::sphere>(i); }
  Triangle triangle(uint32_t i) const { return get<PrimitiveKind::triangle>(i); }

  /// Indices into positions().
  const TriangleIndices& corners(uint32_t triangle) const { return triangles_[triangle]; }
  /// Tells the processor that the primitive will be asked for soon.
  void prefetch(PrimitiveId id) const {
    const PrimitiveKind kind = kind_of(id);
    const uint32_t i = index_of(kind, id);
    if (kind == PrimitiveKind::sphere) __builtin_prefetch(object_->spheres.address(i));
    if (kind == PrimitiveKind::triangle) __builtin_prefetch(&triangles_[i]);
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
  const StridedArray<Rgb>& colors(PrimitiveKind kind) const;
  bool any_colors() const { return any_colors_; }
  /// Of positions(), each multiplied into the colours of its triangles; or empty.
  std::span<const Rgb> vertex_colors() const { return own_vertex_colors_; }
  /// Of positions(), where materials have textures and meshes coordinates for them; else empty.
  std::span<const Uv> texture_coordinates() const { return own_uv_; }

  /// The optical depth of a primitive; kOpaque where nothing passes.
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
  /// Does the primitive, which is transparent, stop the ray of this key
  /// (Accel::next_transparent())?
  bool stops(PrimitiveKind kind, uint32_t index, uint32_t key) const {
    return raio::stops(depth_of(kind, index), hash_of(key, key_of(kind, index)));
  }
  /// Are all of the kind?
  bool all_opaque(PrimitiveKind kind) const { return depths_[size_t(kind)].empty(); }
  /// Those of bounded kinds that let some of the light pass and keep some back; those that are
  /// opaque, where not all are. In the order of their ids.
  std::vector<PrimitiveId> list_transparent() const;
  std::vector<PrimitiveId> list_opaque() const;
  bool any_transparent() const { return any_transparent_; }

  /// The objects of the scene's instances as they are baked, one for each prototype. The error is
  /// one line: more instances than have ids.
  std::optional<std::string> add_objects(std::vector<const Geometry*> objects);
  bool has_instances() const { return !objects_.empty(); }
  /// Those within instances included.
  uint64_t count_instances() const { return instance_count_; }
  /// The instance of this number: its index in Scene::instances, the object that it shows, and the
  /// number in that object, which is 0 unless the object has instances itself.
  struct Placed {
    const Geometry& object;
    uint32_t index = 0;
    InstanceId inner = 0;
  };
  Placed placed(InstanceId instance) const;
  /// The other way.
  InstanceId instance_id(uint32_t index, InstanceId inner = 0) const {
    return (first_instance_.empty() ? index + 1 : first_instance_[index]) + inner;
  }
  /// The object that has the primitives of an instance, or this for number 0.
  const Geometry& object_at(InstanceId instance) const;
  Placement placement(uint32_t index) const {
    return {object_->instances[index].matrix, inverses_[index]};
  }

  /// Where a triangle comes from: its number among the scene's own triangles, those of meshes and
  /// the polygons, in this order.
  size_t source_of(uint32_t triangle) const {
    return sources_.empty() ? triangle : sources_[triangle];
  }
  /// How many triangles the scene and its meshes have, those without area included.
  size_t count_of_triangles() const;

  /// The id of the object (Scene::object_names) to which the primitive belongs; 0: to none. In an
  /// instance it is the outermost that an instance around it belongs to, else its own.
  uint32_t object_of(PrimitiveId id, InstanceId instance = 0) const;
  /// Do both belong to the same object or to none? A primitive that has its object from a prototype
  /// belongs to another one in each instance.
  bool same_object(const Hit& a, const Hit& b) const;
  MaterialId material_of(PrimitiveId id, InstanceId instance = 0) const;

  /// About how many bytes baking an object takes, those that it frees again included.
  static double bytes_to_bake(const Scene& scene, const Object& object);

  Box3f bounds(PrimitiveId id) const;  // not for planes, which have none
  size_t bytes() const;                // besides the scene

 private:
  void bake_triangles();
  void join_meshes();
  size_t mesh_of(size_t i) const;
  MaterialId triangle_material(size_t i) const;
  void bake_polygons();
  void bake_colors();
  void bake_depths();
  float triangle_opacity(size_t i) const;
  float opacity_of(MaterialId id) const;
  template <class Wanted>
  std::vector<PrimitiveId> list(const Wanted& wanted) const;
  bool wants_sources() const {
    return with_sources_ || any_colors_ || any_transparent_ || !object_->object_ranges.empty();
  }
  template <PrimitiveKind kind>
  void list_sides(bool one_sided);

  bool same_object(PrimitiveId a, InstanceId in_a, PrimitiveId b, InstanceId in_b) const;

  const Scene* scene_;
  const Object* object_;
  std::array<PrimitiveId, kPrimitiveKinds + 1> first_{};  // of each kind; the last: how many
  std::vector<const Geometry*> objects_;
  Column<Placement::Inverse> inverses_;  // of the instances
  Column<InstanceId> first_instance_;    // of each instance; empty: no object has instances
  uint64_t instance_count_ = 0;
  bool with_sources_ = false, any_colors_ = false, any_transparent_ = false, bakes_colors_ = false;
  float opacity_ = 1;
  // The scene's own where it has no meshes, else those below.
  std::span<const Vec3f> positions_, normals_;
  Column<Vec3f> own_positions_, own_vertex_normals_;
  Column<Rgb> own_vertex_colors_;
  Column<Uv> own_uv_;
  // The scene's own where every primitive is a triangle with an area, else those below.
  std::span<const TriangleIndices> triangles_, triangle_normals_;
  Column<TriangleIndices> own_triangles_, own_normals_;
  // How many triangles come before each mesh's: the scene's own and those of the meshes before.
  std::vector<uint32_t> mesh_begin_;
  // Of each triangle its source_of(). Empty where that is its index, or where nothing asks.
  Column<uint32_t> sources_;
  StridedArray<Rgb> triangle_colors_;  // the object's or baked
  Column<Facet> facets_;
  BakedColumnsOf<>::type baked_;
  std::array<Column<Sides>, kPrimitiveKinds> sides_;      // empty: both sides of all
  std::array<Column<uint32_t>, kPrimitiveKinds> depths_;  // empty: all are opaque
};

}  // namespace raio
