#include "io/mesh/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "io/fit_camera.h"
#include "io/points.h"
#include "shape/polygon.h"

namespace raio::core {

// --- words
Words::Words(const TextBuffer& text)
    : p_(text.begin()), end_(text.end()), line_start_(text.begin()) {
  if (std::string wrong = not_text(text.view()); !wrong.empty())
    throw ReadFailure{std::move(wrong)};
}

void Words::skip_comment() {
  p_ = skip_blanks_in_line(p_);
  // A backslash at its end continues a line.
  while (*p_ == '\\' && (p_[1] == '\n' || (p_[1] == '\r' && p_[2] == '\n'))) {
    p_ += p_[1] == '\n' ? 2 : 3;
    ++line_;
    line_start_ = p_;
    p_ = skip_blanks_in_line(p_);
  }
  if (*p_ == '#')
    while (*p_ != '\0' && !is_char(*p_, kLineEnd)) ++p_;
}

std::string_view Words::peek() {
  skip_comment();
  return word_at(p_);
}

std::string_view Words::next() {
  const std::string_view word = peek();
  p_ += word.size();
  return word;
}

std::string_view Words::rest() {
  skip_comment();
  const char* const from = p_;
  while (*p_ != '\0' && !is_char(*p_, kLineEnd)) ++p_;
  const char* to = p_;
  while (to > from && is_char(to[-1], kBlank)) --to;
  return {from, size_t(to - from)};
}

bool Words::next_line() {
  look_();
  (void)rest();
  do {
    if (at_end()) return false;
    // The line end "\r
    // " counts once.
    line_ += *p_ == '\n' || p_[1] != '\n';
    line_start_ = ++p_;
    skip_comment();
  } while (at_end() || is_char(*p_, kLineEnd));
  return true;
}

void Words::fail(std::string message) const {
  throw ReadFailure{std::move(message), line_, int(p_ - line_start_) + 1};
}

void Words::fail_expected(std::string_view what) {
  const std::string_view word = peek();
  fail(fmt::format(
      "expected {}, found {}", what,
      word.empty() ? at_end() ? "the end of the file" : "the end of the line" : quoted(word)));
}

double Words::number(std::string_view what) {
  skip_comment();
  double value = 0;
  const char* const stop = parse_number(p_, value);
  if (!stop) fail_expected(what);
  p_ = stop;
  return value;
}

double Words::wide_coordinate() {
  skip_comment();
  const char* const at = p_;
  const double value = number("a coordinate");
  if (std::abs(value) <= double(kFarthestPlace)) return value;
  p_ = at;
  fail_expected("a coordinate between -1e25 and 1e25");
}

Vec3f Words::place() {
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

double Words::coordinate_or_nan() {
  std::string word(peek().substr(0, 9));
  if (!word.empty() && (word[0] == '-' || word[0] == '+')) word.erase(0, 1);
  for (char& c : word) c = char(std::tolower(uint8_t(c)));
  // "-nan(ind)" is written on Windows
  if (!word.starts_with("nan") && word != "inf" && word != "infinity") return wide_coordinate();
  (void)next();
  return NAN;
}

Vec3d Words::wide_place() {
  const double x = coordinate_or_nan(), y = coordinate_or_nan();
  return {x, y, coordinate_or_nan()};
}

int64_t Words::whole(std::string_view what, int64_t least, int64_t most) {
  skip_comment();
  const char* const at = p_;
  const double value = number(what);
  if (value >= double(least) && value <= double(most) && value == std::floor(value))
    return int64_t(value);
  p_ = at;
  fail_expected(what);
}

uint32_t Words::vertex(size_t count) {
  skip_comment();
  const char* const at = p_;
  double value = 0;
  const char* const stop = parse_number(p_, value);
  if (stop && value >= 0 && value < double(count) && value == std::floor(value)) {
    p_ = stop;
    return uint32_t(value);
  }
  p_ = at;
  fail_expected(fmt::format("a vertex from 0 to {}", count - 1));
}

// --- meshes
MaterialId MeshBuilder::paint(Rgb color) {
  const auto [at, is_new] = paints_.emplace(std::array{color.x, color.y, color.z}, 0);
  if (is_new) at->second = paint(color, 1);
  return at->second;
}

void MeshBuilder::add_face(std::span<const uint32_t> corners, MaterialId material,
                           std::span<const uint32_t> face_normals) {
  look_();
  constexpr TriangleIndices kFlat{kNoNormal, kNoNormal, kNoNormal};
  // Flat faces need the marker only if some face is smooth.
  if (!face_normals.empty()) normal_indices_.resize(triangles_.size(), kFlat);
  const bool any_smooth = !face_normals.empty() || !normal_indices_.empty();
  const auto add = [&](size_t a, size_t b, size_t c) {
    triangles_.push_back({corners[a], corners[b], corners[c]});
    materials_.push_back(material);
    if (any_smooth)
      normal_indices_.push_back(
          face_normals.empty()
              ? kFlat
              : TriangleIndices{face_normals[a], face_normals[b], face_normals[c]});
  };
  if (corners.size() == 3) return add(0, 1, 2);
  around_.clear();
  for (const uint32_t corner : corners) around_.push_back(positions[corner]);
  for (const auto& [a, b, c] : triangulate(around_)) add(a, b, c);
}

void MeshBuilder::split_face(std::span<const uint32_t> corners,
                             std::vector<TriangleIndices>& out) const {
  if (corners.size() == 3) return out.push_back({corners[0], corners[1], corners[2]});
  std::vector<Vec3f> around;
  for (const uint32_t corner : corners) around.push_back(positions[corner]);
  for (const auto& [a, b, c] : triangulate(around))
    out.push_back({corners[a], corners[b], corners[c]});
}

void MeshBuilder::add_triangles(std::span<const TriangleIndices> triangles, MaterialId material) {
  triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
  materials_.resize(triangles_.size(), material);
}

namespace {

// The area of triangles at the six faces of the bounding box, relative to the area of the face,
// without overlaps: first the lower ends of x, y and z, then the upper ones. An object that stands
// has a base.
struct Ends {
  std::array<double, 6> covered{};

  Ends(const Mesh& mesh, const Box3f& box) {
    constexpr float kThick = 0.005f;  // of the side's length
    const Vec3f low = box.lo + box.size() * kThick, high = box.hi - box.size() * kThick;
    std::vector<std::array<double, 6>> sums(chunks_of(mesh.triangles.size()));
    for_chunks(mesh.triangles.size(), [&](size_t chunk, size_t first, size_t end) {
      for (size_t i = first; i < end; ++i) {
        const auto& [ia, ib, ic] = mesh.triangles[i];
        const Vec3f &a = mesh.positions[ia], &b = mesh.positions[ib], &c = mesh.positions[ic];
        const Vec3f least = min(min(a, b), c), most = max(max(a, b), c);
        for (int axis = 0; axis < 3; ++axis) {
          const bool is_low = most[axis] <= low[axis], is_high = least[axis] >= high[axis];
          if (is_low == is_high) continue;
          const Vec3d area = cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
          sums[chunk][size_t(is_low ? axis : axis + 3)] += std::abs(area[axis]) / 2;
        }
      }
    });
    const Vec3d size(box.size());
    for (size_t i = 0; i < 6; ++i) {
      for (const auto& sum : sums) covered[i] += sum[i];
      covered[i] /= size[int(i + 1) % 3] * size[int(i + 2) % 3];
    }
  }

  // Whether the lower end of the axis is a base and no other end is similar.
  bool is_base(UpAxis axis) const {
    constexpr double kBase = 0.1, kOthers = 0.2;
    const double base = covered[size_t(axis)];
    const auto is_less = [&](double other) { return other <= kOthers * base; };
    return base >= kBase && std::ranges::count_if(covered, is_less) == 5;
  }
};

// Guesses the up axis: the usual one, unless the mesh has a base across the other.
UpAxis upright(const Mesh& mesh, const Box3f& box, UpAxis usual) {
  const UpAxis other = usual == UpAxis::y ? UpAxis::z : UpAxis::y;
  return Ends(mesh, box).is_base(other) ? other : usual;
}

}  // namespace

ReadScene MeshBuilder::finish(UpAxis usual_up) {
  if (triangles_.empty()) throw ReadFailure{"the file has no faces"};
  if (std::ranges::all_of(materials_, [&](MaterialId id) { return id == materials_[0]; }))
    materials_.resize(1);
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
  mesh.uv = std::move(uv);
  mesh.colors = std::move(colors);
  mesh.triangles = std::move(triangles_);
  mesh.normal_indices = std::move(normal_indices_);
  mesh.materials = std::move(materials_);
  scene_.dialect = Dialect::data;
  scene_.origin = origin;
  scene_.meshes.push_back(std::move(mesh));
  const Mesh& whole = scene_.meshes.back();
  Box3f box;
  for (const TriangleIndices& t : whole.triangles)
    for (const uint32_t corner : t) box.extend(whole.positions[corner]);
  note_invisible(box);
  const UpAxis up = upright(whole, box, usual_up);
  if (up != usual_up)
    notices.add_whole(Severity::guessed,
                      fmt::format("{} is up, since the mesh has a flat base across it; `up` sets "
                                  "another axis",
                                  up == UpAxis::y ? "y" : "z"));
  fit_camera(scene_, FitView::three_quarter, up == UpAxis::y ? Vec3f(0, 1, 0) : Vec3f(0, 0, 1));
  append(warnings, notices, "");
  return {std::move(scene_), std::move(warnings)};
}

ReadScene MeshBuilder::finish_points() {
  Box3f box;
  for (const Vec3f& place : positions) box.extend(place);
  const float radius = mean_spacing(box, positions.size()) / 2;
  scene_.dialect = Dialect::data;
  scene_.origin = origin;
  scene_.materials =
      std::vector<Material>{{.color = colors.empty() ? kPlainColor : Rgb(1), .kd = 1}};
  for (const Vec3f& place : positions) scene_.spheres.push_back({place, radius});
  scene_.sphere_materials.assign(positions.size(), 0);
  scene_.sphere_colors = std::move(colors);
  fit_camera(scene_, FitView::three_quarter, {0, 1, 0});
  append(warnings, notices, "");
  return {std::move(scene_), std::move(warnings)};
}

bool has_area(const Mesh& mesh) {
  return std::ranges::any_of(mesh.triangles, [&](const TriangleIndices& t) {
    const Vec3d a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    return cross(b - a, c - a) != Vec3d();
  });
}

/// Warns if nothing can be seen.
void MeshBuilder::note_invisible(const Box3f& box) {
  const Mesh& mesh = scene_.meshes.back();
  if (!has_area(mesh)) return notices.add_whole(Severity::warning, kNoArea);
  const auto opacity = [&](MaterialId id) {
    const auto& all = std::as_const(scene_).material_opacity;
    return all.empty() ? 1 : all[id];
  };
  if (std::ranges::all_of(mesh.materials, [&](MaterialId id) { return opacity(id) == 0; }))
    return notices.add_whole(Severity::warning,
                             "all materials are fully transparent, so nothing is visible");
  const double size = double(max_component(box.size()));
  if (size < 1e-15 || size > 1e15)
    notices.add_whole(
        Severity::warning,
        fmt::format("the mesh is {:g} wide; numbers so far from 1 lose precision, and its "
                    "surfaces may be invisible",
                    size));
}

}  // namespace raio::core
