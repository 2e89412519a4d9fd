// STL, of 3D Systems (1988): triangles with their corners, as text or in 50 bytes each. Each has a
// normal, too, which its corners give as well.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "base/parallel.h"
#include "io/mesh/builder.h"
#include "io/mesh/read.h"
#include "io/points.h"

namespace raio {
namespace {

constexpr size_t kHeader = 80, kTriangleBytes = 50, kNormalBytes = 12;

ReadScene scene_of(std::vector<Vec3f> corners) {
  MeshBuilder builder;
  const MaterialId plain = builder.paint(kPlainColor);
  if (corners.size() >= size_t(kNoNormal)) throw ReadFailure{"there are too many triangles"};
  builder.positions = std::move(corners);
  for (uint32_t i = 0; i < builder.positions.size(); i += 3)
    builder.add_face(std::array{i, i + 1, i + 2}, plain);
  return builder.finish({0, 0, 1});
}

ReadScene read_binary(std::string_view bytes) {
  const size_t count = (bytes.size() - kHeader - 4) / kTriangleBytes;
  std::vector<Vec3f> corners(3 * count);
  for_each_index(count, [&](size_t i) {
    std::memcpy(&corners[3 * i], bytes.data() + kHeader + 4 + i * kTriangleBytes + kNormalBytes,
                3 * sizeof(Vec3f));
  });
  for (size_t i = 0; i < corners.size(); ++i)
    if (!is_place(corners[i]))
      throw ReadFailure{fmt::format("triangle {} has no finite place", i / 3)};
  return scene_of(std::move(corners));
}

class TextReader {
 public:
  explicit TextReader(const TextBuffer& text) : words_(text) {}

  ReadScene read() {
    if (words_.peek().empty()) words_.next_line();
    while (!words_.at_end()) {
      expect("solid");
      (void)words_.rest();  // its name
      words_.next_line();
      while (lower(words_.peek()) == "facet") read_facet();
      expect("endsolid");
      (void)words_.rest();
      words_.next_line();
    }
    return scene_of(std::move(corners_));
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
    if (!words_.peek().empty()) words_.fail_expected("the end of the line");
    words_.next_line();
  }
  void read_facet() {
    expect("facet");
    (void)words_.rest();  // its normal
    words_.next_line();
    expect("outer"), expect("loop"), end_line();
    for (int corner = 0; corner < 3; ++corner) {
      expect("vertex");
      corners_.push_back(words_.place());
      end_line();
    }
    expect("endloop"), end_line();
    expect("endfacet"), end_line();
  }

  Words words_;
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
    if (is_binary_stl(view, view.size())) return read_binary(view);
    if (!not_text(view).empty())
      throw ReadFailure{
          "it is neither text nor as long as a binary STL file with its number of triangles"};
    return TextReader(bytes).read();
  });
}

}  // namespace raio
