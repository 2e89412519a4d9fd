#include "io/mesh/gltf_parts.h"

#include <fmt/format.h>

#include <cstring>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>

#include "base/hash.h"
#include "scene/columns.h"
#include "shape/polygon.h"

namespace raio::core::gltf {
namespace {

// glTF viewers draw each node separately and slow down beyond these numbers.
constexpr size_t kMaxPlaced = 10'000, kMaxLooks = 256, kMaxNodes = 1'000'000;
// Tessellation is as fine as possible with at most kGoodTriangles triangles stored and 50 million
// drawn; never more than kMaxTriangles.
constexpr size_t kGoodTriangles = 4'000'000, kMaxTriangles = 20'000'000;
constexpr double kGoodDrawn = 50e6;

/// Compares bytes; the types have no padding.
struct SameBytes {
  template <class T>
  size_t operator()(const T& value) const {
    static_assert(std::is_trivially_copyable_v<T>);
    return hash128({reinterpret_cast<const char*>(&value), sizeof value}).first;
  }
  template <class T>
  bool operator()(const T& a, const T& b) const {
    return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
  }
};
template <class Key>
using NumberOf = std::unordered_map<Key, uint32_t, SameBytes, SameBytes>;

/// Calls f(shape, material, color or null, opacity) for each curved shape outside objects.
template <class F>
void for_each_own(const Object& scene, const F& f) {
  for_each_pool(scene, [&](PoolKind, auto& shapes, auto& materials, auto& colors, auto& opacity) {
    using Shape = std::remove_cvref_t<decltype(shapes[0])>;
    if constexpr (requires(const Shape& s) { placed(s); })
      for (size_t i = 0; i < shapes.size(); ++i) {
        const Rgb color = colors.empty() ? Rgb() : colors[i];
        f(shapes[i], materials[i], colors.empty() ? nullptr : &color,
          opacity.empty() ? -1 : opacity[i]);
      }
  });
}

/// The same for each stored shape, including those in objects.
template <class F>
void for_each_curved(const Object& scene, const F& f) {
  for_each_own(scene, f);
  for (const Object& object : scene.prototypes) for_each_curved(object, f);
}

/// Sums `count` over the scene and all instances, nested ones included.
template <class F>
double sum_of_copies(const Object& scene, const F& count) {
  std::vector<double> of_objects;
  of_objects.reserve(scene.prototypes.size());
  for (const Object& object : scene.prototypes) of_objects.push_back(sum_of_copies(object, count));
  double sum = double(count(scene));
  for (const Instance& copy : scene.instances) sum += of_objects[copy.prototype];
  return sum;
}

size_t count_own(const Object& scene) {
  size_t count = 0;
  for_each_own(scene, [&](auto&&...) { ++count; });
  return count;
}

class Gatherer {
 public:
  explicit Gatherer(const Scene& scene) : whole_(scene) {}

  std::expected<SurfaceParts, std::string> gather() {
    if (std::string wrong = choose_form(); !wrong.empty()) return std::unexpected(std::move(wrong));
    add_object(whole_);
    return std::move(out_);
  }

 private:
  struct Corner {
    Vec3f place, normal;
    Uv uv{};
    Rgb color;
    uint32_t surface = 0;
  };
  static_assert(sizeof(Corner) == 48);
  // Identifies a surface without instances: one appearance, and the same columns everywhere.
  struct Columns {
    uint32_t look = 0;
    uint8_t normals = 0, uv = 0, colors = 0, unused = 0;
  };

  // Returns the object's index. Materials are those of the scene.
  uint32_t add_object(const Object& object) {
    const auto number = uint32_t(out_.objects.size());
    out_.objects.emplace_back();
    own_ = &object, fixed_.clear(), corners_.clear();
    add_triangles();
    add_polygons();
    for (size_t i = 0; i < object.moving_triangles.size(); ++i) {
      const Triangle at = object.moving_triangles[i].from;
      add_flat(kPoolOf<MovingTriangle>, i, {at.a, at.b, at.c});
    }
    for (const Mesh& mesh : object.meshes) add_mesh(mesh);
    if (detail_)
      add_baked(*detail_);
    else
      add_shapes();
    std::vector<uint32_t> numbers;
    numbers.reserve(object.prototypes.size());
    for (const Object& inner : object.prototypes) numbers.push_back(add_object(inner));
    for (const Instance& copy : object.instances)
      out_.objects[number].copies.push_back(
          {numbers[copy.prototype], place_of(copy.matrix).value()});
    return number;
  }

  // Colours become materials if there are few, else vertex colours.
  GltfAppearance look_of(MaterialId id, const Rgb* color, float opacity, bool at_corners) const {
    return {id,
            !color       ? whole_.materials[id].color
            : at_corners ? Rgb(1)
                         : *color,
            opacity >= 0 ? opacity : whole_.opacity_of(id)};
  }
  bool has_texture(MaterialId id) const {
    const auto is_one = [](uint32_t texture) { return texture != kNoTexture; };
    const StandardSurface* const s = whole_.standard_surface_of(id);
    return is_one(whole_.texture_of(id)) ||
           (s && (is_one(s->metallic_roughness_texture) || is_one(s->normal_texture) ||
                  is_one(s->emission_texture) || is_one(s->transmission_texture)));
  }
  uint32_t number_of(const GltfAppearance& look) {
    const auto [at, is_new] = looks_.try_emplace(look, uint32_t(out_.looks.size()));
    if (is_new) out_.looks.push_back(look);
    return at->second;
  }
  uint32_t surface_with(const Columns& columns) {
    const auto [at, is_new] = fixed_.try_emplace(columns, uint32_t(out_.surfaces.size()));
    if (is_new) {
      out_.surfaces.emplace_back();
      out_.objects.back().fixed.push_back({at->second, columns.look});
    }
    return at->second;
  }

  // Vertices are identical only if the columns they have are.
  void add_face(const Columns& columns, std::array<Corner, 3> corners) {
    const uint32_t number = surface_with(columns);
    Surface& surface = out_.surfaces[number];
    TriangleIndices face;
    for (size_t k = 0; k < 3; ++k) {
      Corner& c = corners[k];
      c.surface = number;
      const auto [at, is_new] = corners_.try_emplace(c, uint32_t(surface.positions.size()));
      if (is_new) {
        surface.positions.push_back(c.place);
        if (columns.normals) surface.normals.push_back(c.normal);
        if (columns.uv) surface.uv.push_back(c.uv);
        if (columns.colors) surface.colors.push_back(c.color);
      }
      face[k] = at->second;
    }
    surface.triangles.push_back(face);
  }

  // For pools without normals.
  template <class Shape>
  void add_flat(const PoolMembers<Shape>& pool, size_t i, const std::array<Vec3f, 3>& places,
                const std::array<Vec3f, 3>* normals = nullptr) {
    const auto& colors = own_->*pool.colors;
    const auto& opacity = own_->*pool.opacity;
    const Rgb own = colors.empty() ? Rgb() : colors[i];
    const Rgb* const color = colors.empty() ? nullptr : &own;
    const GltfAppearance look =
        look_of((own_->*pool.materials)[i], color, opacity.empty() ? -1 : opacity[i], true);
    std::array<Corner, 3> corners;
    for (size_t k = 0; k < 3; ++k)
      corners[k] = {places[k], normals ? (*normals)[k] : Vec3f(), {}, color ? *color : Rgb()};
    add_face({number_of(look), normals != nullptr, false, color != nullptr}, corners);
  }

  void add_triangles() {
    for (size_t i = 0; i < own_->triangles.size(); ++i) {
      const auto three = [](const Array<Vec3f>& pool, const TriangleIndices& t) {
        return std::array{pool[t[0]], pool[t[1]], pool[t[2]]};
      };
      const auto places = three(own_->positions, own_->triangles[i]);
      const auto& normals = own_->triangle_normals;
      if (normals.empty() || normals[i][0] == kNoNormal) {
        add_flat(kPoolOf<TriangleIndices>, i, places);
      } else {
        const auto at_corners = three(own_->normals, normals[i]);
        add_flat(kPoolOf<TriangleIndices>, i, places, &at_corners);
      }
    }
  }

  void add_polygons() {
    for (size_t i = 0; i < own_->polygons.size(); ++i) {
      const Polygon& polygon = own_->polygons[i];
      const std::span<const Vec3f> corners(own_->positions.data() + polygon.first, polygon.count);
      for (const TriangleIndices& t : triangulate(corners))
        add_flat(kPoolOf<Polygon>, i, {corners[t[0]], corners[t[1]], corners[t[2]]});
    }
  }

  void add_mesh(const Mesh& mesh) {
    const auto& normals = mesh.normal_indices.empty() ? mesh.triangles : mesh.normal_indices;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const MaterialId id = mesh.materials[mesh.materials.size() == 1 ? 0 : i];
      GltfAppearance look = look_of(id, nullptr, -1, true);
      look.textured = !mesh.uv.empty() && has_texture(id);
      const bool smooth = !mesh.normals.empty() && normals[i][0] != kNoNormal;
      const Columns columns{number_of(look), smooth, !mesh.uv.empty(), !mesh.colors.empty()};
      std::array<Corner, 3> corners;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t at = mesh.triangles[i][k];
        corners[k] = {mesh.positions[at], smooth ? mesh.normals[normals[i][k]] : Vec3f(),
                      columns.uv ? mesh.uv[at] : Uv{}, columns.colors ? mesh.colors[at] : Rgb()};
      }
      add_face(columns, corners);
    }
  }

  // --- shapes that glTF does not have
  // Chooses between instanced unit shapes and separate triangles. Returns the error, or nothing.
  std::string choose_form() {
    NumberOf<GltfAppearance> looks;
    for_each_curved(whole_, [&](const auto&, MaterialId id, const Rgb* color, float opacity) {
      if (looks.size() <= kMaxLooks) looks.try_emplace(look_of(id, color, opacity, false), 0);
    });
    few_looks_ = looks.size() <= kMaxLooks;
    const double copies = sum_of_copies(whole_, [](const Object& s) { return s.instances.size(); });
    if (copies > double(kMaxNodes))
      return fmt::format(
          "glTF needs a node for each of {:.0f} instances, and viewers handle at most about "
          "{}; leave some out, or choose another format: .raio keeps all",
          copies, kMaxNodes);
    if (few_looks_ && sum_of_copies(whole_, count_own) <= double(kMaxPlaced)) return {};
    detail_ = affordable_detail();
    if (*detail_ >= 0) return {};
    size_t count = 0;
    for_each_curved(whole_, [&](auto&&...) { ++count; });
    return fmt::format(
        "glTF has no spheres or cylinders, and {} of them are too many to convert to "
        "triangles; leave some out, or choose another format: .raio keeps all, .ply spheres",
        count);
  }

  void add_shapes() {
    for_each_own(*own_, [&](const auto& shape, MaterialId id, const Rgb* color, float opacity) {
      const PlacedShape at = placed(shape);
      const auto [known, is_new] = units_.try_emplace(at.shape, uint32_t(out_.surfaces.size()));
      if (is_new) out_.surfaces.push_back(surface_of(at.shape, kFinest));
      out_.objects.back().shapes.push_back(
          {{known->second, number_of(look_of(id, color, opacity, false))}, at.place});
    });
  }

  // Negative: even the coarsest level is too expensive.
  int affordable_detail() const {
    for (int detail = kFinest; detail >= 0; --detail) {
      const auto triangles = [&](const auto& shape) {
        return triangles_of(placed(shape).shape, detail);
      };
      size_t stored = 0;
      for_each_curved(whole_, [&](const auto& shape, auto&&...) { stored += triangles(shape); });
      const double drawn = sum_of_copies(whole_, [&](const Object& scene) {
        size_t own = 0;
        for_each_own(scene, [&](const auto& shape, auto&&...) { own += triangles(shape); });
        return own;
      });
      if (stored <= kGoodTriangles && drawn <= kGoodDrawn) return detail;
      if (detail == 0 && stored <= kMaxTriangles) return detail;
    }
    return -1;
  }

  void add_baked(int detail) {
    UnitShape known;
    Surface unit = surface_of(known, detail);
    for_each_own(*own_, [&](const auto& shape, MaterialId id, const Rgb* color, float opacity) {
      const PlacedShape at = placed(shape);
      if (at.shape != known) known = at.shape, unit = surface_of(known, detail);
      const bool at_corners = color && !few_looks_;
      const Columns columns{number_of(look_of(id, color, opacity, at_corners)), true, false,
                            at_corners};
      Surface& to = out_.surfaces[surface_with(columns)];
      const auto first = uint32_t(to.positions.size());
      const Transform place{placement_matrix(at.place)};
      for (size_t i = 0; i < unit.positions.size(); ++i) {
        to.positions.push_back(Vec3f(place.point(Vec3d(unit.positions[i]))));
        to.normals.push_back(Vec3f(normalize(place.normal(Vec3d(unit.normals[i])))));
      }
      if (at_corners) to.colors.insert(to.colors.end(), unit.positions.size(), *color);
      for (const auto& [a, b, c] : unit.triangles)
        to.triangles.push_back({first + a, first + b, first + c});
    });
  }

  const Scene& whole_;
  const Object* own_ = nullptr;  // the current object, the last one of out_.objects
  SurfaceParts out_;
  bool few_looks_ = true;
  std::optional<int> detail_;  // level of separate triangles
  NumberOf<GltfAppearance> looks_;
  std::map<UnitShape, uint32_t> units_;  // by their unit shape
  NumberOf<Columns> fixed_;              // of the current object
  NumberOf<Corner> corners_;
};

}  // namespace

std::expected<SurfaceParts, std::string> surface_parts(const Scene& scene) {
  return Gatherer(scene).gather();
}

size_t count_curved(const Scene& scene) { return size_t(sum_of_copies(scene, count_own)); }

}  // namespace raio::core::gltf
