// STL of 3D Systems (1988): triangles with their vertices, as text or in 50 bytes each. The normals
// are ignored, since the vertices determine them.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "io/far_origin.h"
#include "io/mesh/builder.h"
#include "io/mesh/read.h"
#include "io/points.h"

namespace raio::core {
namespace {

constexpr size_t kHeader = 80, kTriangleBytes = 50, kNormalBytes = 12;

ReadScene scene_of(std::vector<Vec3f> corners, MeshBuilder builder = {}) {
  const MaterialId plain = builder.paint(kPlainColor);
  if (corners.size() >= size_t(kNoNormal)) throw ReadFailure{"there are too many triangles"};
  builder.positions = std::move(corners);
  for (uint32_t i = 0; i < builder.positions.size(); i += 3)
    builder.add_face(std::array{i, i + 1, i + 2}, plain);
  return builder.finish(UpAxis::z);
}

// The size of the file decides between the declared number and the available room, unless the file
// ends with trailing bytes.
ReadScene read_binary(std::string_view bytes, FileOrigin& origin) {
  uint32_t named;
  std::memcpy(&named, bytes.data() + kHeader, sizeof named);
  const size_t body = bytes.size() - kHeader - 4, room = body / kTriangleBytes;
  const size_t count =
      named > 0 && body % kTriangleBytes > 0 ? std::min<size_t>(named, room) : room;
  MeshBuilder builder;
  if (count != named)
    builder.notices.add_whole(
        named > room ? Severity::cut : Severity::guessed,
        fmt::format("its header says {} triangles, the file has {}, which are read", named, count));
  if (const size_t spare = body - count * kTriangleBytes; spare > 0)
    builder.notices.add_whole(
        Severity::cut, fmt::format("{} bytes after its {} triangles are not read", spare, count));
  std::vector<Vec3f> corners(3 * count);
  for_each_index(count, [&](size_t i) {
    std::memcpy(&corners[3 * i], bytes.data() + kHeader + 4 + i * kTriangleBytes + kNormalBytes,
                3 * sizeof(Vec3f));
  });
  for (size_t i = 0; i < corners.size(); ++i)
    if (!is_place(corners[i]))
      throw ReadFailure{
          fmt::format("triangle {} has a coordinate that is too large or not finite", i / 3)};
  if (count > 0) origin.choose(Vec3d(corners[0]));
  if (origin.is_far())
    for (Vec3f& corner : corners) corner = origin.local(Vec3d(corner));
  builder.origin = origin.value();
  return scene_of(std::move(corners), std::move(builder));
}

class TextReader {
 public:
  TextReader(const TextBuffer& text, FileOrigin& origin) : words_(text), origin_(origin) {}

  ReadScene read() {
    if (words_.peek().empty()) words_.next_line();
    while (!words_.at_end()) {
      expect("solid");
      skip_to("facet");  // its name
      while (lower(words_.peek()) == "facet") read_facet();
      expect("endsolid");
      skip_to("solid");
    }
    MeshBuilder builder;
    builder.origin = origin_.value();
    return scene_of(std::move(corners_), std::move(builder));
  }

 private:
  static std::string lower(std::string_view word) {
    std::string out(word);
    for (char& c : out) c = char(std::tolower(uint8_t(c)));
    return out;
  }
  void expect(std::string_view word) {
    if (lower(words_.peek()) != word) words_.fail_expected(word);
    (void)words_.next();
  }
  void end_line() {
    if (words_.peek().empty()) words_.next_line();
  }
  // Skips to this word if it follows in the same line with more after it, or else to the next line.
  void skip_to(std::string_view word) {
    for (; !words_.peek().empty(); (void)words_.next()) {
      Words ahead = words_;
      if (lower(ahead.next()) == word && !ahead.peek().empty()) return;
    }
    words_.next_line();
  }
  void read_facet() {
    expect("facet");
    skip_to("outer");  // its normal
    expect("outer"), expect("loop"), end_line();
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      corners_.push_back(place());
      end_line();
    }
    expect("endloop"), end_line();
    expect("endfacet"), end_line();
  }

  Vec3f place() {
    const double x = words_.wide_coordinate(), y = words_.wide_coordinate();
    return origin_.local({x, y, words_.wide_coordinate()});
  }

  Words words_;
  FileOrigin& origin_;
  std::vector<Vec3f> corners_;
};

}  // namespace

bool is_binary_stl(std::string_view start, size_t size) {
  if (start.size() < kHeader + 4) return false;
  uint32_t count;
  std::memcpy(&count, start.data() + kHeader, sizeof count);
  return count > 0 && size == kHeader + 4 + kTriangleBytes * size_t(count);
}

std::expected<ReadScene, Diagnostics> read_stl(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& /*options*/) {
  return read_guarded(file, [&] {
    const std::string_view view = bytes.view();
    const auto binary = [&](FileOrigin& origin) { return read_binary(view, origin); };
    if (is_binary_stl(view, view.size())) return read_about(binary);
    if (not_text(view).empty())
      return read_about([&](FileOrigin& origin) { return TextReader(bytes, origin).read(); });
    if (view.size() < kHeader + 4 + kTriangleBytes)
      throw ReadFailure{
          fmt::format("it is neither a text nor a binary STL file; expected at least {} bytes for "
                      "one triangle; it has {}",
                      kHeader + 4 + kTriangleBytes, view.size())};
    return read_about(binary);
  });
}

}  // namespace raio::core
