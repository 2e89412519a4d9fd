// One pass over an NFF text. Internal to the reader: read.cpp walks from entity to entity and
// recovers from errors, nff_camera.cpp reads `v`, nff_objects.cpp the rest; nff_pieces.cpp has long
// texts read in pieces, on all threads.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/nff/keywords.h"
#include "io/nff/text_cursor.h"
#include "io/nff/text_report.h"
#include "scene/scene.h"

namespace raio::nff {

class Parser {
 public:
  Parser(const TextBuffer& text, std::string_view file, TextReport& report);

  /// Reads the whole text. The scene is sound if the report has no error afterwards.
  Scene run();

 private:
  using Names = std::span<const std::string_view>;

  /// Which of many a number belongs to: "corner 3".
  struct Item {
    std::string_view noun;
    size_t number = 0;
  };

  // Pieces (nff_pieces.cpp).
  struct Piece;
  Parser(const Parser& whole, const char* begin, TextReport& report);
  const char* next_cut(const char* begin) const;
  void read_pieces(const char* cut);
  std::vector<Piece> some_pieces(const char* cut) const;
  void read(Piece& piece) const;
  void append(Piece& piece);

  // Walking (read.cpp). `p_` is behind what has been read.
  void walk(const char* end);
  Keyword entity();
  void read_entity(Keyword keyword);
  void unknown(std::string_view word);
  void refuse(const RefusedWord& word, bool in_camera);
  void finish();
  void skip_to_entity(bool in_camera);

  // Numbers (read.cpp). On an error they report, skip to the next entity and return false.
  bool numbers(std::span<double> out, Names names, Item item);
  bool numbers(std::span<double> out, Names names) { return numbers(out, names, Item()); }
  void bad_number(std::string_view name, Item item);
  const char* last_word() const;
  std::string number_fault(std::string_view word) const;
  std::optional<size_t> count(std::string_view name, size_t least, size_t least_bytes_each);
  std::optional<long> whole_number(std::string_view name, long least, long most);
  size_t numbers_left_in_line() const;

  // What is wrong with an entity that was read to its end: it is left out, nothing is skipped.
  void reject(const std::string& message) { report_.error(offset(begin_), message); }
  void warn(const std::string& message) { report_.warning(offset(begin_), message); }
  void warn_once(bool& warned, const std::string& message);
  size_t offset(const char* p) const { return size_t(p - text_.begin()); }

  // The camera (nff_camera.cpp).
  struct CameraText;
  void camera();
  bool camera_piece(CameraWord word, CameraText& v);
  void camera_done(CameraText& v);
  void camera_lens(const CameraText& v, Camera& out);
  void choose_origin(const CameraText& v);

  // Everything else (nff_objects.cpp).
  void background();
  void light();
  void material();
  void sphere();
  void cone();
  void plane();
  void ellipsoid();
  void disc();
  void polygon(bool smooth);
  void box();
  void mesh();
  void mesh_faces(size_t first, size_t vertices, size_t faces);
  void accel();

  bool corners(size_t n, bool smooth);
  void add_flat(std::span<const Vec3f> points);
  void add_smooth();
  void add_triangle(TriangleIndices corners, TriangleIndices normals);
  MaterialId material_here();
  MaterialId material_id(const Material& material);
  Vec3f place(Vec3d p) const { return Vec3f(p - scene_.origin); }
  bool too_far(Vec3f p);

  const TextBuffer& text_;
  TextReport& report_;
  const char* p_;
  const char* begin_;                // of the entity being read
  Keyword keyword_ = Keyword::none;  // of that entity
  std::string_view noun_;            // of that entity, for messages
  Scene scene_;

  struct MaterialHash {
    size_t operator()(const Material& m) const;
  };
  std::unordered_map<Material, MaterialId, MaterialHash> material_ids_;
  std::optional<MaterialId> material_;  // of the last `f`

  std::vector<Vec3d> corners_;  // of the polygon being read, as written
  std::vector<Vec3f> placed_;   // the same relative to the origin
  std::vector<Vec3f> normals_;

  std::set<std::string_view> refused_;  // each dialect's word is reported once
  const char* camera_begin_ = nullptr;
  bool camera_lost_ = false;  // an error may have hidden it
  bool object_seen_ = false, background_seen_ = false;
  bool warned_late_light_ = false, warned_no_material_ = false;
};

}  // namespace raio::nff
