// What the readers of meshes share: the words of a text, and the mesh they gather.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/nff/text_cursor.h"
#include "io/read_scene.h"
#include "io/textures.h"

namespace raio {

/// Of a face, in any file.
inline constexpr size_t kMaxCorners = 65535;

/// Why a file cannot be read; thrown inside a reader, and made Diagnostics where it ends.
struct ReadFailure {
  std::string message;
  int line = 0, column = 0;  // from 1; 0: about the file as a whole
};

/// What `read` returns, or the diagnostics of the failure that it throws.
template <class Read>
std::expected<ReadScene, Diagnostics> read_guarded(std::string_view file, const Read& read) try {
  ReadScene result = read();
  for (Diagnostic& warning : result.notices)
    if (warning.file.empty()) warning.file = file;
  return result;
} catch (const ReadFailure& f) {
  return std::unexpected(
      Diagnostics{{Severity::error, std::string(file), f.line, f.column, f.message, ""}});
}

/// Words of a text one after another, comments behind # left out. A line that ends with a backslash
/// goes on in the next.
class Words {
 public:
  /// Throws ReadFailure if the bytes are no text.
  explicit Words(const TextBuffer& text);

  bool at_end() const { return p_ == end_; }
  int line() const { return line_; }
  size_t bytes_left() const { return size_t(end_ - p_); }

  /// The next word of this line; empty: there is none. What is next() can be looked at before.
  std::string_view peek();
  std::string_view next();
  /// What is left of the line, without the blanks around it.
  std::string_view rest();
  /// To the next line that has a word; false: there is none.
  bool next_line();

  /// `what` is "a coordinate", say. Of the coordinates of a mesh none may be beyond kFarthestPlace.
  double number(std::string_view what);
  float coordinate() { return float(wide_coordinate()); }
  double wide_coordinate();
  Vec3f place();
  /// Of a mesh that may be far from 0, or with parts that are not finite, which are NaN.
  Vec3d wide_place();
  /// A whole number from `least` to `most`.
  long whole(std::string_view what, long least, long most);
  /// The number of one of `count` vertices.
  uint32_t vertex(size_t count);
  [[noreturn]] void fail(std::string message) const;
  [[noreturn]] void fail_expected(std::string_view what);

 private:
  void skip_comment();  // and blanks
  double coordinate_or_nan();

  const char* p_;
  const char* end_;
  const char* line_start_;
  int line_ = 1;
};

/// What is told of meshes without has_area().
inline constexpr std::string_view kNoArea =
    "no triangle has an area, so that nothing is seen; the corners of each are in one line or "
    "place";
/// Whether any triangle has an area.
bool has_area(const Mesh& mesh);

/// Which axis of a mesh points up.
enum class UpAxis : uint8_t { y = 1, z = 2 };

/// A mesh while it is read, and the materials of its triangles.
class MeshBuilder {
 public:
  // Of the vertices; normals and colours as Mesh has them.
  std::vector<Vec3f> positions, normals;
  std::vector<Uv> uv;
  std::vector<Rgb> colors;
  Diagnostics warnings;  // their file may be left out
  Notices notices;       // of what is guessed, cut or left out
  Vec3d origin;          // as that of a scene

  void warn(std::string message) {
    warnings.push_back({Severity::warning, "", 0, 0, std::move(message), ""});
  }

  /// The material of a display colour in linear light; one for each colour.
  MaterialId paint(Rgb color);
  MaterialId paint(Rgb color, float opacity, uint32_t texture = kNoTexture) {
    return scene_.add_material({.color = color, .kd = 1}, Rgb(1), 0, opacity, texture);
  }
  /// As TextureReader::add().
  std::expected<uint32_t, std::string> add_texture(std::string_view bytes, TextureWrap wrap) {
    return textures_.add(scene_, bytes, wrap, wrap);
  }

  /// The triangles of a face with these corners, of which there are three at least, and as many
  /// normals, none for a flat face.
  void add_face(std::span<const uint32_t> corners, MaterialId material,
                std::span<const uint32_t> face_normals = {});

  /// Appends the triangles of a flat face. Any number of threads may do so at once.
  void split_face(std::span<const uint32_t> corners, std::vector<TriangleIndices>& out) const;
  /// Those of faces that split_face() gave.
  void add_triangles(std::span<const TriangleIndices> triangles, MaterialId material);

  bool has_faces() const { return !triangles_.empty(); }

  /// The scene with a camera, which sees the mesh upright (docs/files.md); throws ReadFailure if
  /// there are no triangles.
  ReadScene finish(UpAxis usual_up);
  /// The positions as spheres that do not overlap much, of a file without faces; y is up.
  ReadScene finish_points();

 private:
  void note_invisible(const Box3f& box);

  Scene scene_;
  TextureReader textures_;
  std::vector<TriangleIndices> triangles_, normal_indices_;
  std::vector<MaterialId> materials_;
  std::map<std::array<float, 3>, MaterialId> paints_;
  std::vector<Vec3f> around_;  // the corners of a face
};

/// The colour of a mesh that has none.
inline constexpr Rgb kPlainColor{0.6f, 0.6f, 0.6f};

}  // namespace raio
