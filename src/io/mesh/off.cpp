// OFF, the Object File Format of Geomview, as text: vertices and faces
// (http://www.geomview.org/docs/html/OFF.html).
#include <fmt/format.h>

#include <cmath>

#include "base/srgb.h"
#include "io/far_origin.h"
#include "io/mesh/builder.h"
#include "io/mesh/read.h"

namespace raio::core {
namespace {

class OffReader {
 public:
  OffReader(const TextBuffer& text, FileOrigin& origin, MeshBuilder& out)
      : words_(text), origin_(origin), out_(out) {}

  void read() {
    if (words_.peek().empty()) words_.next_line();
    read_header();
    if (words_.peek().empty()) words_.next_line();
    // A vertex takes at least six bytes, a face four.
    const auto vertices = size_t(words_.whole("the number of vertices", 1, most(6)));
    const auto faces = size_t(words_.whole("the number of faces", 1, most(4)));
    for (size_t i = 0; i < vertices; ++i) read_vertex(i);
    for (size_t i = 0; i < faces; ++i) read_face();
    if (words_.next_line()) words_.fail_expected("the end of the file");
    out_.origin = origin_.value();
    if (ignored_indices_) out_.warn("face colours that are indices of a colour table are left out");
  }

 private:
  int64_t most(int64_t bytes_each) const { return int64_t(words_.bytes_left()) / bytes_each + 1; }

  void read_header() {
    std::string_view word = words_.peek();
    const auto has = [&](std::string_view part) {
      if (!word.starts_with(part)) return false;
      word.remove_prefix(part.size());
      return true;
    };
    has_uv_ = has("ST");
    has_colors_ = has("C");
    has_normals_ = has("N");
    if (word != "OFF") words_.fail_expected("OFF, COFF, NOFF, CNOFF or these after ST");
    (void)words_.next();
    if (words_.peek() == "BINARY") words_.fail("binary OFF files cannot be read; write text");
  }

  void need_line() {
    if (!words_.next_line()) words_.fail_expected("more vertices and faces");
  }

  // The next word may be on a new line.
  void need_word() {
    if (words_.peek().empty()) need_line();
  }
  double coordinate() {
    need_word();
    return words_.wide_coordinate();
  }

  // Numbers with a decimal point are fractions, others are from 0 to 255.
  std::optional<Rgb> color() {
    double c[4];
    int count = 0;
    bool parts = false;
    while (count < 4 && !words_.peek().empty()) {
      parts |= words_.peek().find_first_of(".eE") != std::string_view::npos;
      c[count++] = words_.number("a part of a colour");
    }
    if (count == 1) ignored_indices_ = true;
    if (count < 3) return std::nullopt;
    const double unit = parts ? 1 : 255;
    const auto light = [&](size_t k) { return linear_from_srgb(float(c[k] / unit)); };
    return Rgb(light(0), light(1), light(2));
  }

  void read_vertex(size_t i) {
    need_line();
    const double x = coordinate(), y = coordinate();
    out_.positions.push_back(origin_.local({x, y, coordinate()}));
    if (has_normals_) {
      const Vec3f n = words_.place();
      const float size = length(n);
      out_.normals.push_back(size > 0 && std::isfinite(size) ? n / size : Vec3f(0, 0, 1));
    }
    if (has_colors_) {
      const auto of_vertex = color();
      if (!of_vertex) words_.fail(fmt::format("vertex {} has no colour of three numbers", i));
      out_.colors.push_back(*of_vertex);
    }
    if (has_uv_) {
      const float u = words_.coordinate();
      out_.uv.push_back({u, words_.coordinate()});
    }
    (void)words_.rest();
  }

  void read_face() {
    need_line();
    const int64_t count = words_.whole("a number of vertices, 1 to 65535", 1, int64_t(kMaxCorners));
    corners_.clear();
    for (int64_t k = 0; k < count; ++k) {
      need_word();
      corners_.push_back(words_.vertex(out_.positions.size()));
    }
    const auto of_face = color();
    (void)words_.rest();
    if (count < 3) return;  // a point or a line
    out_.add_face(corners_, out_.paint(has_colors_ ? Rgb(1) : of_face.value_or(kPlainColor)));
  }

  Words words_;
  FileOrigin& origin_;
  MeshBuilder& out_;
  bool has_uv_ = false, has_colors_ = false, has_normals_ = false, ignored_indices_ = false;
  std::vector<uint32_t> corners_;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_off(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& /*options*/) {
  return read_guarded(file, [&] {
    return read_about([&](FileOrigin& origin) {
      MeshBuilder builder;
      OffReader(bytes, origin, builder).read();
      return builder.finish(UpAxis::y);
    });
  });
}

}  // namespace raio::core
