#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <unordered_map>

#include "base/hash.h"
#include "base/srgb.h"
#include "io/mesh/write.h"
#include "scene/columns.h"
#include "shape/polygon.h"

namespace raio::core {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they are");

using Bytes = std::array<uint8_t, 4>;  // the last one is unused

uint8_t byte_of(float value) { return uint8_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255)); }
Bytes stored_bytes(Rgb color) {
  return {byte_of(srgb_from_linear(color.x)), byte_of(srgb_from_linear(color.y)),
          byte_of(srgb_from_linear(color.z)), 0};
}

class PlyWriter {
 public:
  PlyWriter(const Scene& scene, std::string_view comment)
      : scene_(scene), comment_(comment), moved_(scene.origin != Vec3d()) {}

  std::string write() {
    if (has_faces(scene_))
      write_mesh();
    else
      write_spheres();
    return std::move(out_);
  }

 private:
  // A vertex with all attributes that PLY stores.
  struct Corner {
    Vec3f place, normal;
    Uv uv;
    Bytes color{};
  };
  static_assert(sizeof(Corner) == 36, "it has no gaps, so that its bytes can be compared");

  template <class T>
  void add(const T& number) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &number, sizeof(T));
    body_.append(bytes, sizeof(T));
  }
  void add(Vec3f v) { add(v.x), add(v.y), add(v.z); }
  void add(const Bytes& color) { body_.append(reinterpret_cast<const char*>(color.data()), 3); }
  void add_place(Vec3f place) {
    if (!moved_) return add(place);
    for (int i = 0; i < 3; ++i) add(double(place[i]) + scene_.origin[i]);
  }

  void begin(size_t vertices) {
    out_ = "ply\nformat binary_little_endian 1.0\n";
    if (!comment_.empty()) out_ += fmt::format("comment {}\n", comment_);
    if (scene_.dialect == Dialect::data) out_ += camera_comment();
    out_ += fmt::format("element vertex {}\n", vertices);
    properties(moved_ ? "double" : "float", {"x", "y", "z"});
  }
  std::string camera_comment() const {
    const Camera& c = scene_.camera;
    const auto text = [](Vec3d v) { return fmt::format("{} {} {}", v.x, v.y, v.z); };
    return fmt::format("comment {}{} {} {} {} {} {}\n", kPlyCamera,
                       text(scene_.origin + Vec3d(c.from)), text(scene_.origin + Vec3d(c.at)),
                       text(Vec3d(c.up)), c.fov_deg, c.horizontal_fov_deg, int(c.projection));
  }
  void properties(std::string_view type, std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) out_ += fmt::format("property {} {}\n", type, name);
  }
  void end() { out_ += "end_header\n", out_ += body_; }

  Rgb color_of(MaterialId id) const {
    const Material& m = scene_.materials[id];
    return m.color * m.kd;
  }
  Rgb color_of(const StridedArray<MaterialId>& materials, const StridedArray<Rgb>& colors,
               size_t i) const {
    return colors.empty() ? color_of(materials[i]) : colors[i] * scene_.materials[materials[i]].kd;
  }

  void write_spheres() {
    const bool clear = !scene_.sphere_opacity.empty() || !scene_.material_opacity.empty();
    begin(scene_.spheres.size());
    properties("float", {"radius"});
    properties("uchar", {"red", "green", "blue"});
    if (clear) properties("uchar", {"alpha"});
    for (size_t i = 0; i < scene_.spheres.size(); ++i) {
      const MaterialId id = scene_.sphere_materials[i];
      add_place(scene_.spheres[i].center), add(std::abs(scene_.spheres[i].radius));
      add(stored_bytes(color_of(scene_.sphere_materials, scene_.sphere_colors, i)));
      if (!clear) continue;
      const float own = scene_.sphere_opacity.empty() ? -1 : scene_.sphere_opacity[i];
      add(byte_of(own >= 0 ? own : scene_.opacity_of(id)));
    }
    end();
  }

  void write_mesh() {
    smooth_ = !scene_.triangle_normals.empty();
    for (const Mesh& mesh : scene_.meshes)
      smooth_ |= !mesh.normals.empty(), has_uv_ |= !mesh.uv.empty();
    gather();
    begin(corners_.size());
    if (smooth_) properties("float", {"nx", "ny", "nz"});
    properties("uchar", {"red", "green", "blue"});
    if (has_uv_) properties("float", {"u", "v"});
    out_ +=
        fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", faces_.size());
    for (const Corner& c : corners_) {
      add_place(c.place);
      if (smooth_) add(c.normal);
      add(c.color);
      if (has_uv_) add(c.uv);
    }
    for (const TriangleIndices& face : faces_) add(uint8_t(3)), add(face);
    end();
  }

  void gather() {
    const Scene& s = scene_;
    for (size_t i = 0; i < s.triangles.size(); ++i) {
      const Bytes color = stored_bytes(color_of(s.triangle_materials, s.triangle_colors, i));
      const TriangleIndices& t = s.triangles[i];
      const bool flat = s.triangle_normals.empty() || s.triangle_normals[i][0] == kNoNormal;
      const Vec3f normal =
          smooth_ && flat ? face_normal(s.positions[t[0]], s.positions[t[1]], s.positions[t[2]])
                          : Vec3f();
      TriangleIndices face;
      for (size_t k = 0; k < 3; ++k)
        face[k] = number_of(
            {s.positions[t[k]], flat ? normal : s.normals[s.triangle_normals[i][k]], {}, color});
      faces_.push_back(face);
    }
    for (size_t i = 0; i < s.polygons.size(); ++i) add_polygon(i);
    for (const Mesh& mesh : s.meshes) add_mesh(mesh);
  }

  void add_polygon(size_t i) {
    const Polygon& polygon = scene_.polygons[i];
    const std::span<const Vec3f> corners(scene_.positions.data() + polygon.first, polygon.count);
    const Bytes color = stored_bytes(color_of(scene_.polygon_materials, scene_.polygon_colors, i));
    for (const TriangleIndices& t : triangulate(corners)) {
      const Vec3f normal =
          smooth_ ? face_normal(corners[t[0]], corners[t[1]], corners[t[2]]) : Vec3f();
      TriangleIndices face;
      for (size_t k = 0; k < 3; ++k) face[k] = number_of({corners[t[k]], normal, {}, color});
      faces_.push_back(face);
    }
  }

  void add_mesh(const Mesh& mesh) {
    const auto& normals = mesh.normal_indices.empty() ? mesh.triangles : mesh.normal_indices;
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      const TriangleIndices& t = mesh.triangles[i];
      const Rgb color = color_of(mesh.materials[mesh.materials.size() == 1 ? 0 : i]);
      const bool flat = mesh.normals.empty() || normals[i][0] == kNoNormal;
      const Vec3f normal = smooth_ && flat ? face_normal(mesh.positions[t[0]], mesh.positions[t[1]],
                                                         mesh.positions[t[2]])
                                           : Vec3f();
      TriangleIndices face;
      for (size_t k = 0; k < 3; ++k)
        face[k] =
            number_of({mesh.positions[t[k]], flat ? normal : mesh.normals[normals[i][k]],
                       mesh.uv.empty() ? Uv{} : mesh.uv[t[k]],
                       stored_bytes(mesh.colors.empty() ? color : mesh.colors[t[k]] * color)});
      faces_.push_back(face);
    }
  }

  static Vec3f face_normal(Vec3f a, Vec3f b, Vec3f c) {
    const Vec3d n = cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
    return length(n) > 0 ? Vec3f(normalize(n)) : Vec3f(0, 0, 1);
  }

  uint32_t number_of(const Corner& corner) {
    const auto [at, is_new] = numbers_.try_emplace(corner, uint32_t(corners_.size()));
    if (is_new) corners_.push_back(corner);
    return at->second;
  }

  struct SameBits {
    size_t operator()(const Corner& c) const {
      return hash128({reinterpret_cast<const char*>(&c), sizeof c}).first;
    }
    bool operator()(const Corner& a, const Corner& b) const {
      // Distinguishes -0 from 0, and a NaN equals itself.
      return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT(bugprone-suspicious-memory-comparison)
    }
  };

  const Scene& scene_;
  const std::string_view comment_;
  const bool moved_;
  bool smooth_ = false, has_uv_ = false;
  std::unordered_map<Corner, uint32_t, SameBits, SameBits> numbers_;
  std::vector<Corner> corners_;
  std::vector<TriangleIndices> faces_;
  std::string out_, body_;
};

}  // namespace

bool has_faces(const Scene& scene) {
  return !scene.triangles.empty() || !scene.polygons.empty() ||
         std::ranges::any_of(scene.meshes, [](const Mesh& m) { return !m.triangles.empty(); });
}

std::string write_ply(const Scene& scene, std::string_view comment) {
  return PlyWriter(scene, comment).write();
}

std::string not_in_ply(const Scene& scene) {
  std::string lost;
  const auto add = [&](std::string_view what) {
    lost += (lost.empty() ? "" : ", ") + std::string(what);
  };
  const bool faces = has_faces(scene);
  for_each_pool(scene, [&](PoolKind kind, auto& shapes, auto&, auto&, auto&) {
    const bool kept =
        faces ? kind == PoolKind::triangle || kind == PoolKind::polygon : kind == PoolKind::sphere;
    if (!kept && !shapes.empty())
      add(fmt::format("{} {}{}", shapes.size(), kPoolNames[size_t(kind)],
                      shapes.size() == 1 ? "" : "s"));
  });
  if (faces) {
    if (!scene.triangle_opacity.empty() || !scene.polygon_opacity.empty() ||
        !scene.material_opacity.empty())
      add("opacity");
  }
  for (const Feature feature :
       {Feature::textures, Feature::object_names, Feature::physical_lights, Feature::environment})
    if (const std::string lost_too = text_of(scene, {feature}); !lost_too.empty()) add(lost_too);
  if (scene.dialect != Dialect::data) add("camera, lights, and materials except colours");
  return lost;
}

}  // namespace raio::core
