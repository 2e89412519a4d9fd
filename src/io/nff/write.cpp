#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "io/nff/geometry.h"
#include "io/nff/nff.h"
#include "io/nff/text_cursor.h"
#include "io/plain_scene.h"

namespace raio {
namespace {

/// The fewest digits that give the number back.
class Digits {
 public:
  template <class Number>
  explicit Digits(Number x) : size_(std::to_chars(text_, text_ + 40, x).ptr - text_) {}

  std::string_view view() const { return {text_, size_t(size_)}; }

  /// What a reader makes of them: of the digits of a float, not always that float in double.
  double read() const {
    double value = 0;
    parse_number(text_, value);
    return value;
  }

 private:
  char text_[40 + TextBuffer::kPadding] = {};
  ptrdiff_t size_;
};

/// Readers round twice, to a double and then to a float. Of all floats one only, 7.038531e-26, goes
/// wrong that way and needs a double's digits.
Digits digits_of(float x) {
  const Digits digits(x);
  return float(digits.read()) == x ? digits : Digits(double(x));
}

/// Text that grows, with a blank between the words of a line.
class Text {
 public:
  Text& word(std::string_view word) {
    if (!out_.empty() && out_.back() != '\n') out_ += ' ';
    out_ += word;
    return *this;
  }

  Text& number(int x) { return word(std::to_string(x)); }
  Text& number(uint32_t x) { return word(std::to_string(x)); }
  Text& number(double x) { return word(Digits(x).view()); }
  Text& number(float x) { return word(digits_of(x).view()); }

  template <class T>
  Text& vector(Vec3<T> v) {
    return number(v.x).number(v.y).number(v.z);
  }

  void end_line() { out_ += '\n'; }

  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  std::string write(std::string_view comment) {
    while (!comment.empty()) {
      const size_t end = std::min(comment.find_first_of("\r\n"), comment.size());
      text_.word("#").word(comment.substr(0, end)).end_line();
      comment.remove_prefix(std::min(end + 1, comment.size()));
    }
    camera();
    text_.word("b").vector(scene_.background).end_line();
    if (scene_.samples_per_pixel > 0) text_.word("spp").number(scene_.samples_per_pixel).end_line();
    for (const Light& light : scene_.lights) {
      position("l", light.position);
      if (light.color) text_.vector(*light.color);
      text_.end_line();
    }
    objects();
    while (next_material_ < scene_.materials.size()) material(next_material_++);
    return text_.take();
  }

 private:
  void camera() {
    const Camera& c = scene_.camera;
    text_.word("v").end_line();
    position("from", c.from).end_line();
    position("at", c.at).end_line();
    text_.word("up").vector(c.up).end_line();
    text_.word("angle").number(c.fov_deg).end_line();
    text_.word("hither").number(c.hither).end_line();
    if (c.width > 0 && c.height > 0)
      text_.word("resolution").number(c.width).number(c.height).end_line();
    // As doubles, so that the reader's product rounds to the same float.
    if (c.lens_radius)
      text_.word("aperture").number(double(*c.lens_radius) / nff::pixel_size(c)).end_line();
    if (c.focus_distance)
      text_.word("focal").number(double(*c.focus_distance) / nff::view_distance(c)).end_line();
  }

  void objects() {
    for (size_t i = 0; i < scene_.planes.size(); ++i) {
      use(scene_.plane_materials[i]);
      plane(scene_.planes[i]);
    }
    for (size_t i = 0; i < scene_.spheres.size(); ++i) {
      use(scene_.sphere_materials[i]);
      const Sphere& s = scene_.spheres[i];
      position("s", s.center).number(s.radius).end_line();
    }
    for (size_t i = 0; i < scene_.cones.size(); ++i) {
      use(scene_.cone_materials[i]);
      const Cone& c = scene_.cones[i];
      position("c", c.base).number(c.base_radius);
      position({}, c.apex).number(c.apex_radius).end_line();
    }
    for (size_t i = 0; i < scene_.triangles.size(); ++i) {
      use(scene_.triangle_materials[i]);
      triangle(i);
    }
    for (size_t i = 0; i < scene_.polygons.size(); ++i) {
      use(scene_.polygon_materials[i]);
      const Polygon& p = scene_.polygons[i];
      text_.word("p").number(p.count).end_line();
      for (size_t k = p.first; k < size_t(p.first) + p.count; ++k)
        position({}, scene_.positions[k]).end_line();
    }
  }

  void triangle(size_t i) {
    const bool smooth =
        !scene_.triangle_normals.empty() && scene_.triangle_normals[i][0] != kNoNormal;
    text_.word(smooth ? "pp 3" : "p 3").end_line();
    for (int k = 0; k < 3; ++k) {
      position({}, scene_.positions[scene_.triangles[i][k]]);
      if (smooth) text_.vector(scene_.normals[scene_.triangle_normals[i][k]]);
      text_.end_line();
    }
  }

  /// Makes material `id` the current one. The reader numbers materials as they come, so those
  /// before it that nothing has used yet are written first.
  void use(MaterialId id) {
    if (id == current_) return;
    while (next_material_ <= id) material(next_material_++);
    if (current_ != id) material(id);
  }

  void material(MaterialId id) {
    const Material& m = scene_.materials[id];
    text_.word("f").vector(m.color).number(m.kd).number(m.ks).number(m.shine);
    text_.number(m.transmission).number(m.ior).end_line();
    current_ = id;
  }

  /// A point where the file has it, in double if the scene has an origin.
  Text& position(std::string_view keyword, Vec3f p) {
    if (!keyword.empty()) text_.word(keyword);
    return scene_.origin == Vec3d() ? text_.vector(p) : text_.vector(scene_.origin + Vec3d(p));
  }

  void plane(const Plane& plane);

  const Scene& scene_;
  Text text_;
  MaterialId next_material_ = 0, current_ = 0xffffffffu;
};

/// A vector of length 1 in double that rounds to the float normal. A rounded unit vector is a
/// little longer or shorter than 1, and dividing by its length can round elsewhere; moving each
/// component by the same part of half its last bit reaches length 1 without leaving the floats'
/// rounding range.
Vec3d unrounded(Vec3f normal) {
  const Vec3d n(normal);
  Vec3d half_bit;
  double reach = 0;
  for (int a = 0; a < 3; ++a) {
    half_bit[a] = 0.5 * (double(std::nextafter(normal[a], 2 * normal[a])) - n[a]);
    reach += half_bit[a] * n[a];
  }
  if (!(reach > 0)) return n;
  const double part = std::clamp((1 - dot(n, n)) / (2 * reach), -1.0, 1.0);
  return n + half_bit * part;
}

void Writer::plane(const Plane& plane) {
  const Vec3d n = unrounded(plane.normal);
  const bool plain = scene_.origin == Vec3d();
  Vec3d point = scene_.origin + Vec3d(plane.point);
  if (plain)
    for (int a = 0; a < 3; ++a) point[a] = digits_of(plane.point[a]).read();
  // Edges whose cross product is n over its largest component, without a difference of products:
  // for that component along z they are (1, 0, -n.x/n.z) and (0, 1, -n.y/n.z).
  const int k = max_axis(abs(n)), i = (k + 1) % 3, j = (k + 2) % 3;
  const auto edges = [&](double size) {
    Vec3d u, v;
    u[i] = size, u[k] = -n[i] / n[k] * size;
    v[j] = size, v[k] = -n[j] / n[k] * size;
    if (n[k] < 0) std::swap(u, v);
    return std::pair(point + u, point + v);
  };
  // Longer edges keep more digits of a plane that is nearly upright or far away; the shortest that
  // read back will do.
  double size = 1;
  const auto reads_back = [&] {
    const auto [b, c] = edges(size);
    return nff::plane_normal(point, b, c) == plane.normal;
  };
  while (size < 1e30 && !reads_back()) size *= 1024;
  if (!reads_back()) size = 1;  // a normal that no rounding gives: as near as can be
  const auto [b, c] = edges(size);
  if (plain)
    text_.word("pl").vector(plane.point);
  else
    text_.word("pl").vector(point);
  text_.vector(b).vector(c).end_line();
}

}  // namespace

std::string write_nff(const Scene& scene, std::string_view comment) {
  if (!is_plain(scene)) return write_nff(plain_scene(scene), comment);
  return Writer(scene).write(comment);
}

}  // namespace raio
