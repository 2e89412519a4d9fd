// Shared by the readers of meshes: the words of a text, and the mesh under construction.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/executor.h"
#include "io/nff/text_cursor.h"
#include "io/read_scene.h"
#include "io/textures.h"

namespace raio::core {

/// Maximum number of vertices of a face.
inline constexpr size_t kMaxCorners = 65535;

/// Why a file cannot be read; thrown within a reader and converted to Diagnostics by it.
struct ReadFailure {
  std::string message;
  int line = 0, column = 0;  // from 1; 0: about the whole file
};

/// The result of `read`, or the diagnostics of the failure that it throws.
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

/// Reads the words of a text, skipping comments after #. A backslash at its end continues a line.
class Words {
 public:
  /// Throws ReadFailure if the bytes are not text.
  explicit Words(const TextBuffer& text);

  bool at_end() const { return p_ == end_; }
  int line() const { return line_; }
  size_t bytes_left() const { return size_t(end_ - p_); }

  /// The next word of this line without consuming it; empty if there is none.
  std::string_view peek();
  std::string_view next();
  /// The rest of the line, without the blanks around it.
  std::string_view rest();
  /// Moves to the next line with a word; false if there is none.
  bool next_line();

  /// `what` is "a coordinate", say. Coordinates must not exceed kFarthestPlace.
  double number(std::string_view what);
  float coordinate() { return float(wide_coordinate()); }
  double wide_coordinate();
  Vec3f place();
  /// For meshes that may be far from 0; coordinates that are not finite become NaN.
  Vec3d wide_place();
  /// A whole number from `least` to `most`.
  int64_t whole(std::string_view what, int64_t least, int64_t most);
  /// The index of one of `count` vertices.
  uint32_t vertex(size_t count);
  [[noreturn]] void fail(std::string message) const;
  [[noreturn]] void fail_expected(std::string_view what);

 private:
  StopCheck look_;
  void skip_comment();  // and blanks
  double coordinate_or_nan();

  const char* p_;
  const char* end_;
  const char* line_start_;
  int line_ = 1;
};

/// The notice about meshes without has_area().
inline constexpr std::string_view kNoArea =
    "all triangles have zero area, so nothing is visible; the vertices of each are collinear or "
    "coincide";
/// Whether any triangle has an area.
bool has_area(const Mesh& mesh);

/// Which axis of a mesh points up.
enum class UpAxis : uint8_t { y = 1, z = 2 };

/// A mesh under construction, and the materials of its triangles.
class MeshBuilder {
 public:
  // Per vertex; normals and colours as in Mesh.
  std::vector<Vec3f> positions, normals;
  std::vector<Uv> uv;
  std::vector<Rgb> colors;
  Diagnostics warnings;  // their file may be omitted
  Notices notices;       // about guessed, cut and skipped data
  Vec3d origin;          // as Scene::origin

  void warn(std::string message) {
    warnings.push_back({Severity::warning, "", 0, 0, std::move(message), ""});
  }

  /// The material of a display colour in linear light; equal colours share one.
  MaterialId paint(Rgb color);
  MaterialId paint(Rgb color, float opacity, uint32_t texture = kNoTexture) {
    return scene_.add_material({.color = color, .kd = 1}, Rgb(1), 0, opacity, texture);
  }
  /// See TextureReader::add().
  std::expected<uint32_t, std::string> add_texture(std::string_view bytes, TextureWrap wrap) {
    return textures_.add(scene_, bytes, wrap, wrap);
  }

  /// Adds the triangles of a face with at least three vertices; as many normals, or none for a flat
  /// face.
  void add_face(std::span<const uint32_t> corners, MaterialId material,
                std::span<const uint32_t> face_normals = {});

  /// Appends the triangles of a flat face; thread-safe.
  void split_face(std::span<const uint32_t> corners, std::vector<TriangleIndices>& out) const;
  /// Adds triangles from split_face().
  void add_triangles(std::span<const TriangleIndices> triangles, MaterialId material);

  bool has_faces() const { return !triangles_.empty(); }

  /// The scene with a camera that shows the mesh upright (docs/files.md); throws ReadFailure if
  /// there are no triangles.
  ReadScene finish(UpAxis usual_up);
  /// The scene of a file without faces: the positions as spheres with little overlap; y is up.
  ReadScene finish_points();

 private:
  StopCheck look_;
  void note_invisible(const Box3f& box);

  Scene scene_;
  TextureReader textures_;
  std::vector<TriangleIndices> triangles_, normal_indices_;
  std::vector<MaterialId> materials_;
  std::map<std::array<float, 3>, MaterialId> paints_;
  std::vector<Vec3f> around_;  // the vertices of a face
};

/// The colour of a mesh without colours.
inline constexpr Rgb kPlainColor{0.6f, 0.6f, 0.6f};

}  // namespace raio::core
