// The Polygon File Format of Greg Turk (1994): a header that declares elements and their
// properties, then the elements, as text or binary in either byte order.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/srgb.h"
#include "io/atoms/rows.h"
#include "io/colormaps.h"
#include "io/far_origin.h"
#include "io/fit_camera.h"
#include "io/mesh/builder.h"
#include "io/mesh/ply_rows.h"
#include "io/mesh/read.h"
#include "io/mesh/write.h"
#include "io/points.h"

namespace raio::core {
namespace {

// Vertex properties, with the names that programs use.
enum Wanted : size_t { kX, kY, kZ, kRadius, kRed, kGreen, kBlue, kAlpha, kNx, kNy, kNz, kU, kV };
constexpr size_t kWanted = 13;
constexpr std::array<std::array<std::string_view, 4>, kWanted> kNames = {
    {{"x"},
     {"y"},
     {"z"},
     {"radius"},
     {"red", "diffuse_red", "r"},
     {"green", "diffuse_green", "g"},
     {"blue", "diffuse_blue", "b"},
     {"alpha", "opacity"},
     {"nx"},
     {"ny"},
     {"nz"},
     {"u", "s", "texture_u"},
     {"v", "t", "texture_v"}}};
using Values = std::array<double, kWanted>;

class PlyReader {
 public:
  PlyReader(const TextBuffer& bytes, const ReadOptions& options, FileOrigin& origin)
      : file_(bytes), options_(options), origin_(origin) {}

  ReadScene read() {
    has_faces_ = std::ranges::any_of(
        file_.elements(), [](const PlyElement& e) { return is_of_faces(e) && e.count > 0; });
    std::vector<std::pair<const PlyElement*, PlyCursor>> before_vertices;
    for (const PlyElement& element : file_.elements()) {
      if (element.name == "vertex") {
        read_vertices(element);
      } else if (is_of_faces(element) && count_ > 0) {
        read_faces(element);
      } else {
        if (is_of_faces(element)) before_vertices.emplace_back(&element, file_.at());
        file_.skip(element);
      }
    }
    for (const auto& [element, start] : before_vertices) {
      if (count_ == 0) break;
      file_.at() = start;
      read_faces(*element);
    }
    return finish();
  }

 private:
  [[noreturn]] void fail(std::string message) const { file_.fail(std::move(message)); }
  static bool is_of_faces(const PlyElement& element) {
    return element.name == "face" || element.name == "tristrips";
  }

  // --- vertices
  void read_vertices(const PlyElement& element) {
    if (element.count == 0) return;
    if (count_ > 0) fail("there are two lists of vertices");
    file_.check_count(element);
    for (size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (property.count) continue;
      for (size_t w = 0; w < kWanted; ++w)
        if (!property.name.empty() &&
            std::ranges::find(kNames[w], property.name) != kNames[w].end())
          at_[w] = k, is_whole_[w] = is_whole(property.type);
      if (!options_.color_by.empty() && property.name == options_.color_by) colored_by_ = k;
      if (!property.name.empty()) columns_.push_back(property.name);
    }
    // "r" alone is not a colour.
    if (at_[kRed] && !at_[kGreen] && !at_[kBlue] && element.properties[*at_[kRed]].name == "r")
      at_[kRadius] = std::exchange(at_[kRed], std::nullopt);
    if (!options_.color_by.empty() && !colored_by_)
      fail(fmt::format("vertices have no property {}; there are {}",
                       core::quoted(options_.color_by), names_of(element)));
    for (const size_t w : {kX, kY, kZ})
      if (!at_[w]) fail(fmt::format("vertices have no property {}", kNames[w][0]));
    PlyCursor& at = file_.at();
    note_left_out(element);
    choose_origin(element);
    if (at.encoding == PlyEncoding::text || element.has_lists()) {
      allocate(element.count);
      file_.read_rows(element, SIZE_MAX, [&](size_t i, const PlyRow& row, const PlyCursor&) {
        put(i, [&](size_t k) { return row.values[k]; });
      });
      return;
    }
    // With rows of fixed size, only the wanted properties are read.
    const size_t row = element.row_bytes();
    allocate(element.count);
    if (row > at.bytes_left() / element.count) fail("the file ends within its vertices");
    std::vector<size_t> offsets;
    offsets.reserve(element.properties.size());
    size_t offset = 0;
    for (const PlyProperty& property : element.properties)
      offsets.push_back(std::exchange(offset, offset + size_of(property.type)));
    for_each_index(element.count, [&](size_t i) {
      const char* const from = at.p + i * row;
      put(i, [&](size_t k) {
        return ply_number(from + offsets[k], element.properties[k].type,
                          at.encoding == PlyEncoding::big);
      });
    });
    at.p += row * element.count;
  }
  void choose_origin(const PlyElement& element) {
    PlyCursor at = file_.at();
    has_floats_ =
        at.encoding != PlyEncoding::text && element.properties[*at_[kX]].type == PlyType::f32;
    std::vector<double> values;
    for (const PlyProperty& property : element.properties) {
      values.push_back(property.count ? 0 : at.next(property.type));
      if (property.count) at.skip(property);
    }
    origin_.choose({values[*at_[kX]], values[*at_[kY]], values[*at_[kZ]]});
    mesh_.origin = origin_.value();
  }
  void note_left_out(const PlyElement& element) {
    const auto has_property = [&](std::string_view name) {
      return std::ranges::any_of(element.properties,
                                 [&](const PlyProperty& p) { return p.name == name; });
    };
    if (has_property("f_dc_0"))
      mesh_.notices.add_whole(Severity::left_out,
                              "the shapes and colours of Gaussian splats (f_dc_0, scale_0, rot_0, "
                              "...); their centres are drawn as spheres");
    for (const std::string_view comment : file_.comments())
      if (comment.starts_with("TextureFile "))
        mesh_.notices.add(Severity::left_out, "textures of a PLY file; OBJ and glTF can have some",
                          comment.substr(12));
  }
  static std::string names_of(const PlyElement& element) {
    std::string names;
    for (const PlyProperty& property : element.properties)
      if (!property.count) names += (names.empty() ? "" : ", ") + core::quoted(property.name);
    return names;
  }
  bool has(Wanted w) const { return at_[w].has_value(); }
  void allocate(size_t count) {
    count_ = count;
    if (has_faces_) places_.resize(count);
    if (!has_faces_ || has(kRadius)) spheres_.resize(count);
    if (colored_by_)
      values_.resize(count);
    else if (has(kRed) && has(kGreen) && has(kBlue))
      colors_.resize(count);
    if (has(kAlpha)) opacity_.resize(count);
    if (has(kNx) && has(kNy) && has(kNz)) normals_.resize(count);
    if (has(kU) && has(kV)) uv_.resize(count);
  }
  template <class Get>
  void put(size_t i, const Get& get) {
    const auto value = [&](Wanted w) { return float(get(*at_[w])); };
    // A text may have values beyond a byte.
    const auto light = [&](Wanted w) {
      const double x = get(*at_[w]);
      return is_whole_[w] ? kLight[size_t(x > 0 ? std::min(x, 255.0) : 0)]
                          : linear_from_srgb(float(x));
    };
    const Vec3f place(Vec3d(get(*at_[kX]), get(*at_[kY]), get(*at_[kZ])) - mesh_.origin);
    if (!places_.empty()) places_[i] = place;
    if (!spheres_.empty()) spheres_[i] = {place, has(kRadius) ? value(kRadius) : 0};
    if (!colors_.empty()) colors_[i] = {light(kRed), light(kGreen), light(kBlue)};
    if (!values_.empty()) values_[i] = float(get(*colored_by_));
    if (!opacity_.empty()) {
      const float a = is_whole_[kAlpha] ? value(kAlpha) / 255 : value(kAlpha);
      opacity_[i] = a > 0 ? std::min(a, 1.0f) : 0;
    }
    if (!normals_.empty()) normals_[i] = {value(kNx), value(kNy), value(kNz)};
    if (!uv_.empty()) uv_[i] = {value(kU), value(kV)};
  }

  // --- faces, and triangle strips separated by -1
  // The faces of a chunk of rows.
  struct Faces {
    std::vector<TriangleIndices> triangles;
    std::vector<Rgb> colors;        // of each face, if faces have colours
    std::vector<size_t> ends;       // the number of triangles up to the end of each face
    std::vector<uint32_t> corners;  // of a face
    size_t left_out = 0;            // faces with a vertex without a finite position
  };
  static constexpr uint32_t kApart = 0xffffffffu;  // marks -1

  void read_faces(const PlyElement& element) {
    if (element.count == 0) return;
    file_.check_count(element);
    if (!places_.empty()) {
      find_unplaced(places_, [](Vec3f& place) -> Vec3f& { return place; });
      mesh_.positions = std::exchange(places_, {});
    }
    const bool strips = element.name == "tristrips";
    std::array<std::optional<size_t>, 3> color;
    std::optional<size_t> corners;
    for (size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (property.count && property.name.starts_with("vertex_ind")) corners = k;
      for (size_t c = 0; c < 3; ++c)
        if (!property.count && std::ranges::count(kNames[kRed + c], property.name) > 0)
          color[c] = k;
    }
    if (!corners) fail(fmt::format("elements {} have no list vertex_indices", element.name));
    // Vertex colours, including those by `color_by`, take precedence.
    const bool colored = colors_.empty() && !colored_by_ && color[0] && color[1] && color[2];
    std::vector<Faces> chunks(chunks_of(element.count));
    file_.read_rows(element, *corners, [&](size_t i, const PlyRow& row, const PlyCursor& at) {
      Faces& faces = chunks[i / kLoopChunk];
      if (i % kLoopChunk == 0) faces = {};  // a previous attempt may have left some
      if (!strips && row.list.size() > kMaxCorners)
        at.fail(fmt::format("a face of {} vertices is too large", row.list.size()));
      faces.corners.clear();
      for (const double index : row.list) faces.corners.push_back(vertex(index, i, strips, at));
      if (!unplaced_.empty()) leave_out_unplaced(faces, strips);
      if (strips)
        split_strip(faces.corners, faces.triangles);
      else if (faces.corners.size() >= 3)
        mesh_.split_face(faces.corners, faces.triangles);
      if (!colored) return;
      faces.ends.push_back(faces.triangles.size());
      const auto light = [&](size_t c) {
        const double unit = is_whole(element.properties[*color[c]].type) ? 255 : 1;
        return linear_from_srgb(float(row.values[*color[c]] / unit));
      };
      const float red = light(0), green = light(1);
      faces.colors.push_back({red, green, light(2)});
    });
    const MaterialId usual = mesh_.paint(colors_.empty() && !colored_by_ ? kPlainColor : Rgb(1));
    for (Faces& faces : chunks) {
      if (faces.left_out > 0)
        mesh_.notices.add(Severity::left_out, "faces with a non-finite vertex", {}, 0,
                          faces.left_out);
      const std::span<const TriangleIndices> triangles = faces.triangles;
      if (!colored) mesh_.add_triangles(triangles, usual);
      for (size_t i = 0, first = 0; i < faces.ends.size(); first = faces.ends[i++])
        mesh_.add_triangles(triangles.subspan(first, faces.ends[i] - first),
                            mesh_.paint(faces.colors[i]));
      faces = {};
    }
  }
  void leave_out_unplaced(Faces& faces, bool strips) const {
    const auto is_unplaced = [&](uint32_t corner) { return corner != kApart && unplaced_[corner]; };
    if (std::ranges::none_of(faces.corners, is_unplaced)) return;
    ++faces.left_out;
    if (strips)
      std::ranges::replace_if(faces.corners, is_unplaced, kApart);
    else
      faces.corners.clear();
  }
  uint32_t vertex(double index, size_t face, bool strips, const PlyCursor& at) const {
    if (strips && index == -1) return kApart;
    if (!(index >= 0 && index < double(count_) && index == std::floor(index)))
      at.fail(fmt::format("face {} names vertex {}, of {}", face, index, count_));
    return uint32_t(index);
  }
  static void split_strip(std::span<const uint32_t> strip, std::vector<TriangleIndices>& out) {
    size_t first = 0;
    for (size_t k = 0; k < strip.size(); ++k) {
      if (strip[k] == kApart) first = k + 1;
      if (k < first + 2 || strip[k] == kApart) continue;
      // Every second triangle is reversed.
      const bool turned = (k - first) % 2 == 1;
      out.push_back({strip[k - 2 + turned], strip[k - 1 - turned], strip[k]});
    }
  }

  // --- the scene
  // Finds vertices without a finite position and gives them a finite one.
  template <class T, class Place>
  void find_unplaced(std::vector<T>& vertices, const Place& place) {
    size_t count = 0;
    for (size_t i = 0; i < count_; ++i) {
      Vec3f& at = place(vertices[i]);
      if (is_place(at)) {
        if (!origin_.is_far()) continue;
        origin_.check(Vec3d(at));
        farthest_ = std::max(farthest_, max_component(abs(at)));
        continue;
      }
      if (count++ == 0) unplaced_.resize(count_);
      unplaced_[i] = true, at = {};
    }
    if (count == count_) fail("no vertex has finite coordinates");
    tell_floats();
    if (count > 0)
      mesh_.notices.add(Severity::left_out, "vertices without finite coordinates", {}, 0, count);
  }
  // Binary floats far from 0 have lost visible digits.
  void tell_floats() {
    constexpr double kSeen = 1e-4;  // relative to the extent of the picture
    const double step = float_step(max_component(abs(mesh_.origin)));
    if (has_floats_ && origin_.is_far() && step > kSeen * double(farthest_))
      mesh_.notices.add_whole(
          Severity::warning,
          fmt::format("this far from 0, coordinates that are floats are multiples of {:g}; doubles "
                      "keep more digits",
                      step));
  }
  void leave_out_unplaced_points() {
    const auto keep = [&](auto& values) {
      if (values.empty()) return;
      size_t kept = 0;
      for (size_t i = 0; i < values.size(); ++i)
        if (!unplaced_[i]) values[kept++] = values[i];
      values.resize(kept);
    };
    keep(spheres_), keep(colors_), keep(values_), keep(opacity_);
    count_ = spheres_.size();
  }
  ReadScene finish() {
    if (count_ == 0) fail("there are no vertices");
    if (!has_faces_) find_unplaced(spheres_, [](Sphere& s) -> Vec3f& { return s.center; });
    if (!has_faces_ && !unplaced_.empty()) leave_out_unplaced_points();
    std::optional<ColorScale> scale;
    if (colored_by_) {
      auto mapped = map_colors(values_, options_.colormap, options_.color_range);
      if (!mapped) fail(mapped.error());
      colors_ = std::move(mapped->colors);
      scale = mapped->scale, scale->name = options_.color_by;
    } else if (!options_.colormap.empty() || options_.color_range) {
      fail("a colour map or range has no effect without `color-by`; leave it out");
    }
    ReadScene read;
    if (mesh_.has_faces()) {
      read = make_mesh();
    } else {
      read.scene.dialect = Dialect::data;
      read.scene.origin = mesh_.origin;
      make_spheres(read.scene);
      fit_camera(read.scene, FitView::three_quarter);
      append(read.notices, mesh_.notices, "");
    }
    set_written_camera(read.scene);
    read.colors = scale;
    read.choices.columns = std::move(columns_), read.choices.color_by = options_.color_by;
    return read;
  }
  // Restores the camera from a comment of write_ply().
  void set_written_camera(Scene& scene) const {
    for (std::string_view comment : file_.comments()) {
      if (!comment.starts_with(kPlyCamera)) continue;
      comment.remove_prefix(kPlyCamera.size());
      const auto words = words_of(comment);
      std::array<double, 12> n{};
      for (size_t i = 0; i < n.size(); ++i)
        if (words.size() != n.size() || !parse_number(words[i].data(), n[i])) return;
      Camera camera = scene.camera;
      camera.from = Vec3f(Vec3d(n[0], n[1], n[2]) - scene.origin);
      camera.at = Vec3f(Vec3d(n[3], n[4], n[5]) - scene.origin);
      camera.up = Vec3f(Vec3d(n[6], n[7], n[8]));
      camera.fov_deg = float(n[9]), camera.horizontal_fov_deg = float(n[10]);
      if (n[11] == 1 || n[11] == 2) camera.projection = Projection(int(n[11]));
      // A comment may contain anything.
      const bool are_angles = camera.fov_deg > 0 && camera.fov_deg < 180 &&
                              camera.horizontal_fov_deg >= 0 && camera.horizontal_fov_deg < 180;
      if (are_angles && is_place(camera.from) && is_place(camera.at) && is_place(camera.up) &&
          camera_problem(camera).empty())
        scene.camera = camera;
    }
  }
  static Material paint(Rgb color) { return {.color = color, .kd = 1}; }

  void set_radii() {
    // All faces are degenerate.
    if (spheres_.empty())
      for (const Vec3f& place : mesh_.positions) spheres_.push_back({place, 0});
    if (has(kRadius)) {
      for (size_t i = 0; i < count_; ++i)
        if (const float r = spheres_[i].radius; !(r > 0 && r <= kFarthestPlace))
          fail(fmt::format("vertex {} has a radius of {}; expected a positive number", i, r));
      return;
    }
    float radius = options_.radius;
    if (!(radius > 0)) {
      Box3f box;
      for (const Sphere& s : spheres_) box.extend(s.center);
      radius = mean_spacing(box, count_) / 2;
    }
    for (Sphere& s : spheres_) s.radius = radius;
  }
  void make_spheres(Scene& scene) {
    set_radii();
    scene.spheres = std::move(spheres_);
    scene.sphere_materials.assign(count_, 0);
    const bool one = std::ranges::all_of(colors_, [&](const Rgb& c) { return c == colors_[0]; });
    scene.materials = std::vector<Material>{paint(colors_.empty() ? kPlainColor : colors_[0])};
    if (!one) scene.sphere_colors = std::move(colors_);
    if (std::ranges::any_of(opacity_, [](float a) { return a < 1; }))
      scene.sphere_opacity = std::move(opacity_);
  }
  ReadScene make_mesh() {
    if (options_.radius > 0) fail("`radius` has no effect on a mesh; leave it out");
    if (std::ranges::any_of(opacity_, [](float a) { return a < 1; }))
      mesh_.warn("the opacities of its vertices are left out");
    for (Vec3f& n : normals_) {
      const float size = length(n);
      n = size > 0 && std::isfinite(size) ? n / size : Vec3f(0, 0, 1);
    }
    mesh_.normals = std::move(normals_);
    mesh_.colors = std::move(colors_);
    if (std::ranges::all_of(
            uv_, [](const Uv& at) { return std::isfinite(at[0]) && std::isfinite(at[1]); }))
      mesh_.uv = std::move(uv_);
    return mesh_.finish(UpAxis::y);
  }

  static inline const std::array<float, 256> kLight = [] {
    std::array<float, 256> light{};
    for (size_t i = 0; i < light.size(); ++i) light[i] = linear_from_srgb(float(i) / 255);
    return light;
  }();

  PlyFile file_;
  const ReadOptions& options_;
  FileOrigin& origin_;
  bool has_floats_ = false;  // coordinates are binary floats
  float farthest_ = 0;       // from the origin; 0 if data is near it
  size_t count_ = 0;
  std::array<std::optional<size_t>, kWanted> at_;  // indices of vertex properties
  std::array<bool, kWanted> is_whole_{};
  std::optional<size_t> colored_by_;  // index of the vertex property for colours
  std::vector<std::string> columns_;  // properties of vertices
  bool has_faces_ = false;
  std::vector<Sphere> spheres_;          // vertices of a file without faces
  std::vector<Vec3f> places_, normals_;  // vertices of a file with faces
  std::vector<float> opacity_, values_;
  std::vector<Rgb> colors_;
  std::vector<Uv> uv_;
  std::vector<bool> unplaced_;  // vertices without a finite position; empty: none
  MeshBuilder mesh_;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_ply(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options) {
  return read_guarded(file, [&] {
    return read_about([&](FileOrigin& origin) { return PlyReader(bytes, options, origin).read(); });
  });
}

}  // namespace raio::core
