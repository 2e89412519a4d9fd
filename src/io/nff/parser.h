// One pass over an NFF text. Internal to the reader: read.cpp goes from entity to entity, reads
// numbers and recovers from errors; pieces.cpp reads long texts in pieces, in parallel. The readers
// of entities (keywords.h) use the public part.
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

namespace raio::core::nff {

/// The coordinates of a point, as in messages.
inline constexpr std::string_view kXyz[] = {"x", "y", "z"};

class Parser {
 public:
  Parser(const TextBuffer& text, std::string_view file, TextReport& report);

  /// Reads the whole text. The scene is valid if the report has no error afterwards.
  Scene run();

  using Names = std::span<const std::string_view>;

  /// Which vertex, say, a number belongs to: "vertex 3".
  struct Item {
    std::string_view noun;
    size_t number = 0;
  };

  // Numbers. On an error these functions report it, skip to the next entity and return false or
  // nothing.
  bool numbers(std::span<double> out, Names names, Item item);
  bool numbers(std::span<double> out, Names names) { return numbers(out, names, Item()); }
  std::optional<int64_t> whole_number(std::string_view name, int64_t least, int64_t most);
  /// Reads how many items follow; more than the rest of the text can hold is an error.
  std::optional<size_t> count(std::string_view name, size_t least, size_t least_bytes_each);
  size_t numbers_left_in_line() const;
  /// The rest of the line up to a comment, without blanks around it.
  std::string_view rest_of_line();

  /// The start of the entity.
  const char* begin() const { return begin_; }
  /// The start of the next word, where all of the above begin. The text ends with a zero byte.
  const char* next() { return p_ = skip_blanks(p_); }
  void pass(std::string_view word) { p_ += word.size(); }
  /// The start of the number that was read last.
  const char* last_word() const;
  void skip_to_entity(bool in_camera);

  // Reports an error in an entity that was read completely: the entity is left out, and nothing is
  // skipped. The location is the start of the entity, or `where`.
  void reject(std::string message, const char* where = nullptr) {
    report_.error(offset(where ? where : begin_), std::move(message));
  }
  void warn(std::string message, const char* where = nullptr) {
    report_.warning(offset(where ? where : begin_), std::move(message));
  }
  void warn_once(bool& warned, std::string message);
  /// Reports that the next word belongs to a dialect that Raio refuses.
  void refuse(const RefusedWord& word, bool in_camera);
  int line_of(const char* p) const { return report_.line_of(offset(p)); }

  // The scene.
  Scene& scene() { return scene_; }
  Vec3f place(Vec3d p) const { return Vec3f(p - scene_.origin); }
  /// Reports a point beyond the range of a float.
  bool too_far(Vec3f p, const char* where = nullptr) {
    if (is_finite(p)) return false;
    reject("too far from the camera for a float", where);
    return true;
  }
  /// The material of the object being read.
  MaterialId material_here() {
    seen.object = true;
    return material_ ? *material_ : default_material();
  }
  /// A material and its values in the parallel columns (Scene::add_material).
  struct Surface {
    Material material;
    Rgb specular{1};
    float roughness = 0;

    friend bool operator==(const Surface&, const Surface&) = default;
  };
  void set_material(const Surface& surface) { material_ = material_id(surface); }
  template <class Shape>
  void add(const Shape& shape, MaterialId material) {
    constexpr PoolMembers<Shape> pool = kPoolOf<Shape>;
    (scene_.*pool.shapes).push_back(shape);
    (scene_.*pool.materials).push_back(material);
  }

  /// What was read so far, for later entities and for the checks at the end.
  struct Seen {
    const char* camera = nullptr;  // the start of the first one
    bool camera_lost = false;      // an error may have hidden it
    bool object = false, background = false, sky = false;
    bool late_light = false, no_material = false;  // whether these warnings were given
  } seen;

  /// The vertices of the polygon being read; a member so that its memory is reused.
  struct Corners {
    std::vector<Vec3d> written;
    std::vector<Vec3f> placed;  // the same relative to the origin
    std::vector<Vec3f> normals;
  } corners;

 private:
  // Pieces (pieces.cpp).
  struct Piece;
  Parser(const Parser& whole, const char* begin, TextReport& report);
  const char* next_cut(const char* begin) const;
  void read_pieces(const char* cut);
  std::vector<Piece> some_pieces(const char* cut) const;
  void read(Piece& piece) const;
  void append(Piece& piece);

  // Traversal of entities. `p_` is after the last word read.
  void walk(const char* end);
  const Entity* entity();
  void unknown(std::string_view word);
  void finish();

  void bad_number(std::string_view name, Item item);
  std::string number_fault(std::string_view word) const;
  size_t offset(const char* p) const { return size_t(p - text_.begin()); }
  bool in_camera() const { return entity_->word == kCameraKeyword; }

  MaterialId default_material();
  MaterialId material_id(const Surface& surface);

  const TextBuffer& text_;
  TextReport& report_;
  const char* p_;
  const char* begin_;               // of the entity being read
  const Entity* entity_ = nullptr;  // its row; between entities the row of the last one
  Scene scene_;

  struct SurfaceHash {
    size_t operator()(const Surface& s) const;
  };
  std::unordered_map<Surface, MaterialId, SurfaceHash> material_ids_;
  std::optional<MaterialId> material_;  // set by the last `f`

  std::set<std::string_view> refused_;  // each word of a dialect is reported once
};

}  // namespace raio::core::nff
