#include "io/mesh/gltf_parts.h"

#include <fmt/format.h>

#include <cstring>
#include <map>
#include <span>
#include <string_view>
#include <unordered_map>

#include "base/hash.h"
#include "scene/columns.h"
#include "shape/polygon.h"

namespace raio::gltf {
namespace {

// Programs that show glTF draw each copy by itself, and slow down beyond.
constexpr size_t kMostPlaced = 10'000, kMostLooks = 256;
// In place of shapes: as fine as is no more than the first allows, and never more than the second.
constexpr size_t kGoodTriangles = 4'000'000, kMostTriangles = 20'000'000;

/// By their bytes, of which none is a gap.
struct SameBytes {
  template <class T>
  size_t operator()(const T& value) const {
    static_assert(std::is_trivially_copyable_v<T>);
    return hash128({reinterpret_cast<const char*>(&value), sizeof value}).first;
  }
  template <class T>
  bool operator()(const T& a, const T& b) const {
    return std::memcmp(&a, &b, sizeof a) == 0;
  }
};
template <class Key>
using NumberOf = std::unordered_map<Key, uint32_t, SameBytes, SameBytes>;

/// f(index, shape, material, color or null, opacity) for each curved one.
template <class F>
void for_each_curved(const Scene& scene, const F& f) {
  for_each_pool(scene, [&](PoolKind, auto& shapes, auto& materials, auto& colors, auto& opacity) {
    using Shape = std::remove_cvref_t<decltype(shapes[0])>;
    if constexpr (requires(const Shape& s) { placed(s); })
      for (size_t i = 0; i < shapes.size(); ++i)
        f(shapes[i], materials[i], colors.empty() ? nullptr : &colors[i],
          opacity.empty() ? -1 : opacity[i]);
  });
}

class Gatherer {
 public:
  explicit Gatherer(const Scene& scene) : scene_(scene) {}

  std::expected<SurfaceParts, std::string> gather() {
    add_triangles();
    add_polygons();
    for (size_t i = 0; i < scene_.moving_triangles.size(); ++i) add_moving_triangle(i);
    for (const Mesh& mesh : scene_.meshes) add_mesh(mesh);
    if (std::string wrong = add_curved(); !wrong.empty()) return std::unexpected(std::move(wrong));
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
  // What decides a surface that is fixed: it has one look, and all of it the same columns.
  struct Columns {
    uint32_t look = 0;
    uint8_t normals = 0, uv = 0, colors = 0, unused = 0;
  };

  // Colours of their own are those of corners, unless they are few.
  Look look_of(MaterialId id, const Rgb* color, float opacity, bool at_corners) const {
    const float usual = scene_.material_opacity.empty() ? 1 : scene_.material_opacity[id];
    return {id,
            !color       ? scene_.materials[id].color
            : at_corners ? Rgb(1)
                         : *color,
            opacity >= 0 ? opacity : usual};
  }
  uint32_t number_of(const Look& look) {
    const auto [at, is_new] = looks_.try_emplace(look, uint32_t(out_.looks.size()));
    if (is_new) out_.looks.push_back(look);
    return at->second;
  }
  uint32_t surface_with(const Columns& columns) {
    const auto [at, is_new] = fixed_.try_emplace(columns, uint32_t(out_.surfaces.size()));
    if (is_new) {
      out_.surfaces.emplace_back();
      out_.fixed.push_back({at->second, columns.look});
    }
    return at->second;
  }

  // The corners tell apart what the columns do not have.
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

  // Of a pool without normals.
  template <class Shape>
  void add_flat(const PoolMembers<Shape>& pool, size_t i, const std::array<Vec3f, 3>& places,
                const std::array<Vec3f, 3>* normals = nullptr) {
    const auto& colors = scene_.*pool.colors;
    const auto& opacity = scene_.*pool.opacity;
    const Rgb* const color = colors.empty() ? nullptr : &colors[i];
    const Look look =
        look_of((scene_.*pool.materials)[i], color, opacity.empty() ? -1 : opacity[i], true);
    std::array<Corner, 3> corners;
    for (size_t k = 0; k < 3; ++k)
      corners[k] = {places[k], normals ? (*normals)[k] : Vec3f(), {}, color ? *color : Rgb()};
    add_face({number_of(look), normals != nullptr, false, color != nullptr}, corners);
  }

  void add_triangles() {
    for (size_t i = 0; i < scene_.triangles.size(); ++i) {
      const auto three = [](const Array<Vec3f>& pool, const TriangleIndices& t) {
        return std::array{pool[t[0]], pool[t[1]], pool[t[2]]};
      };
      const auto places = three(scene_.positions, scene_.triangles[i]);
      const auto& normals = scene_.triangle_normals;
      if (normals.empty() || normals[i][0] == kNoNormal) {
        add_flat(kPoolOf<TriangleIndices>, i, places);
      } else {
        const auto at_corners = three(scene_.normals, normals[i]);
        add_flat(kPoolOf<TriangleIndices>, i, places, &at_corners);
      }
    }
  }

  void add_polygons() {
    for (size_t i = 0; i < scene_.polygons.size(); ++i) {
      const Polygon& polygon = scene_.polygons[i];
      const std::span<const Vec3f> corners(scene_.positions.data() + polygon.first, polygon.count);
      for (const TriangleIndices& t : triangulate(corners))
        add_flat(kPoolOf<Polygon>, i, {corners[t[0]], corners[t[1]], corners[t[2]]});
    }
  }

  void add_moving_triangle(size_t i) {
    const Triangle& t = scene_.moving_triangles[i].from;
    add_flat(kPoolOf<MovingTriangle>, i, {t.a, t.b, t.c});
  }

  void add_mesh(const Mesh& mesh) {
    const auto& normals = mesh.normal_indices.empty() ? mesh.triangles : mesh.normal_indices;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const MaterialId id = mesh.materials[mesh.materials.size() == 1 ? 0 : i];
      Look look = look_of(id, nullptr, -1, true);
      look.textured = !mesh.uv.empty() && !scene_.material_texture.empty() &&
                      scene_.material_texture[id] != kNoTexture;
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

  // --- shapes that glTF does not have; what is wrong, or nothing
  std::string add_curved() {
    const size_t count = count_curved(scene_);
    if (count == 0) return {};
    NumberOf<Look> looks;
    for_each_curved(scene_, [&](auto&, MaterialId id, const Rgb* color, float opacity) {
      if (looks.size() <= kMostLooks) looks.try_emplace(look_of(id, color, opacity, false), 0);
    });
    const bool few_looks = looks.size() <= kMostLooks;
    if (few_looks && count <= kMostPlaced)
      add_copies();
    else if (const int detail = affordable_detail(); detail >= 0)
      add_baked(detail, few_looks);
    else
      return fmt::format(
          "glTF has neither spheres nor cylinders, and {} of them are more than triangles can "
          "stand for; leave some out, or choose another format: .raio keeps all, .ply spheres",
          count);
    return {};
  }

  void add_copies() {
    std::map<UnitShape, uint32_t> surfaces;
    for_each_curved(scene_, [&](auto& shape, MaterialId id, const Rgb* color, float opacity) {
      const PlacedShape at = placed(shape);
      const auto [known, is_new] = surfaces.try_emplace(at.shape, uint32_t(out_.surfaces.size()));
      if (is_new) out_.surfaces.push_back(surface_of(at.shape, kFinest));
      out_.copies.push_back(
          {{known->second, number_of(look_of(id, color, opacity, false))}, at.place});
    });
  }

  // Negative: even the coarsest is not.
  int affordable_detail() const {
    std::array<size_t, kFinest + 1> triangles{};
    for_each_curved(scene_, [&](auto& shape, auto&&...) {
      const UnitShape unit = placed(shape).shape;
      for (int detail = 0; detail <= kFinest; ++detail)
        triangles[size_t(detail)] += triangles_of(unit, detail);
    });
    int detail = kFinest;
    while (detail > 0 && triangles[size_t(detail)] > kGoodTriangles) --detail;
    return triangles[size_t(detail)] > kMostTriangles ? -1 : detail;
  }

  void add_baked(int detail, bool few_looks) {
    UnitShape known;
    Surface unit = surface_of(known, detail);
    for_each_curved(scene_, [&](auto& shape, MaterialId id, const Rgb* color, float opacity) {
      const PlacedShape at = placed(shape);
      if (at.shape != known) known = at.shape, unit = surface_of(known, detail);
      const bool at_corners = color && !few_looks;
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

  const Scene& scene_;
  SurfaceParts out_;
  NumberOf<Look> looks_;
  NumberOf<Columns> fixed_;
  NumberOf<Corner> corners_;
};

}  // namespace

std::expected<SurfaceParts, std::string> surface_parts(const Scene& scene) {
  return Gatherer(scene).gather();
}

size_t count_curved(const Scene& scene) {
  size_t count = 0;
  for_each_curved(scene, [&](auto&&...) { ++count; });
  return count;
}

}  // namespace raio::gltf
