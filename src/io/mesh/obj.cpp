// OBJ and MTL of Wavefront (1992): positions, normals, texture coordinates and faces, one keyword
// per line, and a separate file of materials. Points are read if there are no faces; curves,
// surfaces and lines are skipped.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <ranges>
#include <set>
#include <unordered_map>

#include "base/srgb.h"
#include "io/far_origin.h"
#include "io/mesh/builder.h"
#include "io/mesh/read.h"
#include "io/points.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;

// The arguments of map_Kd.
struct PaintMap {
  fs::path library;  // the MTL file
  int line = 0;
  std::string name;  // of the picture, relative to that file; empty: none
  bool clamp = false;
  std::array<float, 2> offset{0, 0}, scale{1, 1};

  bool moves() const { return offset != std::array{0.0f, 0.0f} || scale != std::array{1.0f, 1.0f}; }
};

struct Paint {
  std::optional<Rgb> color;
  double opacity = 1;
  bool only_tr = false;  // the opacity is from Tr, without d
  PaintMap map;
};
using Paints = std::map<std::string, Paint, std::less<>>;

// Reads a map_Kd line after its keyword. Unknown options give a warning.
PaintMap read_map(Words& words, const fs::path& library, Diagnostics& warnings) {
  PaintMap map;
  map.library = library, map.line = words.line();
  const auto up_to_three = [&](std::array<float, 2>& to) {
    for (size_t i = 0; i < 3 && looks_like_number(words.peek()); ++i) {
      const float number = words.coordinate();
      if (i < to.size()) to[i] = number;
    }
  };
  while (words.peek().starts_with('-')) {
    const std::string option(words.next());
    if (option == "-o") {
      up_to_three(map.offset);
    } else if (option == "-s") {
      up_to_three(map.scale);
    } else if (option == "-clamp") {
      map.clamp = words.next() == "on";
    } else if (option == "-blendu" || option == "-blendv" || option == "-texres") {
      (void)words.next();  // texture filtering
    } else {
      const bool takes_numbers = option == "-t" || option == "-mm" || option == "-boost";
      for (int i = 0; i < 3 && takes_numbers && looks_like_number(words.peek()); ++i)
        (void)words.next();
      if (!takes_numbers) (void)words.next();
      warnings.push_back({Severity::warning, library.string(), map.line, 1,
                          fmt::format("the option {} of map_Kd is left out", core::quoted(option)),
                          ""});
    }
  }
  map.name = words.rest();
  return map;
}

// Reads the materials of an MTL file; throws ReadFailure. `left_out` counts skipped textures.
void read_mtl(const TextBuffer& text, const fs::path& library, Paints& out, size_t& left_out,
              Diagnostics& warnings) {
  Words words(text);
  Paint* paint = nullptr;
  bool has_d = false;  // for the current material
  const auto read_line = [&] {
    const std::string_view word = words.next();
    if (word == "newmtl") {
      paint = &out[std::string(words.rest())], has_d = false;
    } else if (word == "Kd" && paint && looks_like_number(words.peek())) {
      const auto part = [&] { return linear_from_srgb(float(words.number("a part of a colour"))); };
      const float red = part(), green = part();
      paint->color = Rgb(red, green, part());
    } else if (word == "d" && paint) {
      if (words.peek() == "-halo") (void)words.next();
      paint->opacity = words.number("an opacity"), paint->only_tr = false, has_d = true;
    } else if (word == "Tr" && paint) {
      const double opacity = 1 - words.number("a transparency");
      if (!has_d) paint->opacity = opacity, paint->only_tr = true;
    } else if (word == "map_Kd" && paint) {
      paint->map = read_map(words, library, warnings);
    } else if (word == "map_d") {
      ++left_out;
    }
  };
  if (!words.peek().empty()) read_line();
  while (words.next_line()) read_line();
}

/// Thrown if a face or usemtl refers to something later in the file.
struct OutOfOrder {};

class ObjReader {
 public:
  ObjReader(const TextBuffer& text, const ReadOptions& options, FileOrigin& origin,
            MeshBuilder& out)
      : words_(text), start_(words_), options_(options), origin_(origin), out_(out) {}

  ReadScene read() {
    read_lines();
    return finish();
  }
  /// Reads faces after everything that they may refer to.
  ReadScene read_in_two_passes() {
    pass_ = Pass::named;
    read_lines();
    words_ = start_;
    pass_ = Pass::faces;
    read_lines();
    return finish();
  }

 private:
  // The contents read by a pass: everything, everything except faces, or only faces.
  enum class Pass : uint8_t { one, named, faces };

  void read_lines() {
    before_ = {};
    if (!words_.peek().empty()) read_line();
    while (words_.next_line()) read_line();
  }
  void read_line() {
    const std::string_view word = words_.next();
    const bool reads_named = pass_ != Pass::faces, reads_faces = pass_ != Pass::named;
    if (word == "v") {
      ++before_.places;
      if (reads_named) read_vertex();
    } else if (word == "vn") {
      ++before_.normals;
      if (reads_named) read_normal();
    } else if (word == "vt") {
      ++before_.uvs;
      if (reads_named) read_uv();
    } else if (word == "mtllib") {
      if (reads_named) read_libraries(words_.rest());
    } else if (!reads_faces) {
      (void)words_.rest();
    } else if (word == "f" || word == "fo") {
      read_face();
    } else if (word == "usemtl") {
      use(words_.rest());
    } else if (word == "p") {
      read_points();
    } else if (word == "l" || word == "curv" || word == "surf") {
      out_.notices.add(Severity::left_out, "lines, curves and surfaces of an OBJ file", word,
                       size_t(words_.line()));
    }
  }

  void read_vertex() {
    places_.push_back(origin_.local(words_.wide_place()));
    first_uses_.push_back({});
    // Some programs append a weight, others a colour.
    double more[4];
    size_t count = 0;
    while (count < 4 && !words_.peek().empty()) more[count++] = words_.number("a number");
    if (count < 3 && colors_.empty()) return;
    colors_.resize(places_.size(), Rgb(1));
    if (count < 3) return;
    const double* const rgb = more + (count == 4);
    const auto light = [&](int k) { return linear_from_srgb(float(rgb[k])); };
    colors_.back() = {light(0), light(1), light(2)};
  }
  void read_normal() {
    const Vec3f n(words_.wide_place());
    const float size = length(n);
    const bool is_known = !std::isnan(size);
    out_.normals.push_back(size > 0 && std::isfinite(size) ? n / size : Vec3f(0, 0, 1));
    if (!is_known) unknown_normals_.insert(uint32_t(out_.normals.size() - 1));
  }
  void read_uv() {
    const float u = words_.coordinate();
    uvs_.push_back({u, words_.peek().empty() ? 0 : words_.coordinate()});
  }

  // An index from 1, or from -1 backwards relative to this line; 0 if there is none.
  int64_t index_at(const char*& p, const char* end, size_t before) {
    int64_t number = 0;
    const auto [stop, error] = std::from_chars(p, end, number);
    if (error != std::errc()) return 0;
    p = stop;
    if (number > int64_t(before) && pass_ == Pass::one) throw OutOfOrder();
    return number < 0 ? std::max<int64_t>(number + int64_t(before) + 1, 0) : number;
  }
  uint32_t place_at(const char*& p, const char* end) {
    const size_t count = places_.size();
    const int64_t number = index_at(p, end, before_.places);
    if (number < 1 || number > int64_t(count))
      words_.fail_expected(
          count == 0 ? "no vertex: there is none"
                     : fmt::format("a vertex from 1 to {} or -1 to -{} (vertices count from 1)",
                                   count, before_.places));
    return uint32_t(number - 1);
  }
  // An optional index of a normal or texture coordinate.
  uint32_t other_at(const char*& p, const char* end, size_t count, size_t before,
                    std::string_view what) {
    const std::string_view word(p, size_t(end - p));
    const char* const from = p;
    const int64_t number = index_at(p, end, before);
    if (p == from || (number < 1 && !word.starts_with('-')))
      words_.fail_expected(fmt::format("a {} from 1 on", what));
    if (number >= 1 && number <= int64_t(count)) return uint32_t(number - 1);
    out_.notices.add(Severity::left_out,
                     fmt::format("{}s that faces refer to and the file does not have", what), {},
                     size_t(words_.line()));
    return kNone;
  }

  void read_face() {
    corners_.clear(), normals_.clear();
    bool is_whole = true;
    size_t smooth = 0;
    for (std::string_view word; !(word = words_.peek()).empty(); (void)words_.next()) {
      const char *p = word.data(), *const end = p + word.size();
      const uint32_t place = place_at(p, end);
      uint32_t uv = kNone, normal = kNone;
      if (p != end && *p == '/') {
        ++p;
        if (p != end && *p != '/') {
          uv = other_at(p, end, uvs_.size(), before_.uvs, "texture coordinate");
          if (uv != kNone) uv = moved(uv);
        }
        if (p != end && *p == '/') {
          if (++p != end)
            normal = other_at(p, end, out_.normals.size(), before_.normals, "normal");
          else
            out_.notices.add(Severity::guessed,
                             "face vertices that end with \"/\", read without a normal", word,
                             size_t(words_.line()));
        }
      }
      if (p != end) words_.fail_expected("a face vertex such as 1, 1/2, 1//3 or 1/2/3");
      is_whole &= is_place(places_[place]);
      corners_.push_back(is_whole ? vertex(place, uv) : 0);
      normals_.push_back(normal);
      smooth += normal != kNone && !unknown_normals_.contains(normal);
      if (corners_.size() > kMaxCorners) words_.fail("a face has at most 65535 vertices");
    }
    if (corners_.empty()) words_.fail_expected("the vertices of a face");
    if (corners_.size() < 3)
      return out_.notices.add(Severity::left_out, "faces with fewer than three vertices", {},
                              size_t(words_.line()));
    if (!is_whole)
      return out_.notices.add(Severity::left_out, "faces with a non-finite vertex", {},
                              size_t(words_.line()));
    if (smooth > 0 && smooth < corners_.size())
      out_.notices.add(Severity::left_out, "normals of faces where some vertices have none", {},
                       size_t(words_.line()));
    if (smooth < corners_.size()) normals_.clear();
    has_smooth_ |= !normals_.empty();
    out_.add_face(corners_, material_ ? *material_ : usual(), normals_);
  }

  void read_points() {
    ++point_lines_;
    while (!words_.peek().empty()) {
      const std::string_view word = words_.peek();
      const char* p = word.data();
      points_.push_back(place_at(p, p + word.size()));
      (void)words_.next();
    }
  }

  // The mesh's vertex with this position and these texture coordinates.
  uint32_t vertex(uint32_t place, uint32_t uv) {
    Use& first = first_uses_[place];
    if (first.vertex == kNone) first = {add_vertex(place, uv), uv};
    if (first.uv == uv) return first.vertex;
    const auto [at, is_new] = other_uses_.emplace(uint64_t(place) << 32 | uv, 0);
    if (is_new) at->second = add_vertex(place, uv);
    return at->second;
  }
  uint32_t add_vertex(uint32_t place, uint32_t uv) {
    const size_t number = out_.positions.size();
    if (number >= kNone) words_.fail("there are too many vertices");
    out_.positions.push_back(places_[place]);
    if (place < colors_.size()) {
      out_.colors.resize(number, Rgb(1));
      out_.colors.push_back(colors_[place]);
    }
    if (uv != kNone) {
      out_.uv.resize(number);
      out_.uv.push_back(uv & kMoved ? moved_uvs_[uv & ~kMoved] : uvs_[uv]);
    }
    return uint32_t(number);
  }
  // Texture coordinates transformed by the material's map_Kd options.
  uint32_t moved(uint32_t uv) {
    if (uvs_.size() >= kMoved) words_.fail("there are too many texture coordinates");
    if (!map_) return uv;
    const auto [at, is_new] = moved_.emplace(std::pair(map_, uv), 0);
    if (is_new) {
      at->second = uint32_t(moved_uvs_.size()) | kMoved;
      const auto along = [&](size_t i) {
        const float x = uvs_[uv][i] * map_->scale[i] + map_->offset[i];
        return std::isfinite(x) ? x : 0;
      };
      moved_uvs_.push_back({along(0), along(1)});
    }
    return at->second;
  }

  // --- materials
  MaterialId usual() { return out_.paint(colors_.empty() ? kPlainColor : Rgb(1)); }

  void use(std::string_view name) {
    material_ = named(name);
    const auto paint = paints_.find(name);
    map_ = paint != paints_.end() && paint->second.map.moves() ? &paint->second.map : nullptr;
  }

  MaterialId named(std::string_view name) {
    if (const auto at = materials_.find(name); at != materials_.end()) return at->second;
    const auto paint = paints_.find(name);
    MaterialId id = 0;
    if (paint == paints_.end()) {
      if (pass_ == Pass::one && libraries_.empty()) throw OutOfOrder();
      id = usual();
      missing_.emplace_back(name);
    } else {
      const uint32_t texture = texture_of(paint->second.map);
      id = out_.paint(color_of(paint->first, paint->second, texture),
                      opacity_of(paint->first, paint->second), texture);
    }
    return materials_.emplace(std::string(name), id).first->second;
  }

  // Some programs write black for a texture that is meant to be shown unchanged.
  Rgb color_of(std::string_view name, const Paint& paint, uint32_t texture) {
    if (texture == kNoTexture) return paint.color.value_or(kPlainColor);
    if (paint.color != Rgb(0)) return paint.color.value_or(Rgb(1));
    out_.notices.add(Severity::guessed, "textures shown unchanged, although Kd is 0 0 0", name);
    return Rgb(1);
  }
  // A fully transparent file is not intended, and some programs write Tr 1 for opaque.
  float opacity_of(std::string_view name, const Paint& paint) {
    const double a = paint.opacity;
    if (!(a >= 0 && a <= 1)) return 1;
    if (a > 0) return float(a);
    const bool all_transparent = std::ranges::all_of(
        paints_, [](const auto& of_name) { return of_name.second.opacity == 0; });
    if (!paint.only_tr && !all_transparent) return 0;
    out_.notices.add(Severity::guessed,
                     paint.only_tr ? "materials drawn opaque, though Tr is 1: they have no d, and "
                                     "some programs mean opaque by it"
                                   : "materials drawn opaque, though d is 0: otherwise nothing of "
                                     "the file would be visible",
                     name);
    return 1;
  }

  uint32_t texture_of(const PaintMap& map) {
    if (map.name.empty()) return kNoTexture;
    const auto bytes = read_beside(map.library.parent_path(), map.name);
    const auto texture =
        bytes ? out_.add_texture(*bytes, map.clamp ? TextureWrap::clamp : TextureWrap::repeat)
              : std::unexpected(bytes.error());
    if (texture) return *texture;
    out_.warnings.push_back(
        {Severity::warning, map.library.string(), map.line, 1,
         fmt::format("the texture {}: {}", core::quoted(map.name), texture.error()), ""});
    return kNoTexture;
  }

  fs::path library_file(std::string_view name) const {
    std::string path(name);
    std::ranges::replace(path, '\\', '/');
    return options_.folder ? *options_.folder / path : fs::path();
  }
  // One file name, possibly with blanks, or several.
  void read_libraries(std::string_view names) {
    std::error_code error;
    if (names.find(' ') == std::string_view::npos ||
        fs::is_regular_file(library_file(names), error))
      return read_library(std::string(names));
    for (const auto word : std::views::split(names, ' '))
      if (!word.empty()) read_library(std::string(std::string_view(word)));
  }
  void read_library(const std::string& name) {
    if (!libraries_.insert(name).second) return;
    const fs::path file = library_file(name);
    std::error_code error;
    // Not a pipe, which could block.
    if (!options_.folder || !fs::is_regular_file(file, error))
      return out_.warn(
          fmt::format("its materials: found no file {} in its folder", core::quoted(name)));
    const auto text = TextBuffer::read_file(file);
    if (!text)
      return out_.warn(fmt::format("its materials: {}: {}", core::quoted(name), text.error()));
    try {
      read_mtl(*text, file, paints_, left_out_, out_.warnings);
    } catch (const ReadFailure& failure) {
      out_.warn(fmt::format("its materials: {}:{}:{}: {}", core::quoted(name), failure.line,
                            failure.column, failure.message));
    }
  }

  ReadScene finish() {
    out_.origin = origin_.value();
    const auto unplaced =
        size_t(std::ranges::count_if(places_, [](const Vec3f& place) { return !is_place(place); }));
    if (unplaced > 0)
      out_.notices.add(Severity::left_out, "vertices without finite coordinates", {}, 0, unplaced);
    if (!unknown_normals_.empty())
      out_.notices.add(Severity::left_out, "normals that are not finite", {}, 0,
                       unknown_normals_.size());
    const bool of_points = !out_.has_faces() && unplaced < places_.size();
    if (of_points) add_points();
    if (!of_points && point_lines_ > 0)
      out_.notices.add(Severity::left_out, "points (p) in a file with faces", {}, 0, point_lines_);
    if (!out_.colors.empty()) out_.colors.resize(out_.positions.size(), Rgb(1));
    if (!out_.uv.empty()) out_.uv.resize(out_.positions.size());
    if (!has_smooth_) out_.normals.clear();
    if (!paints_.empty())
      for (const std::string& name : missing_)
        out_.notices.add(Severity::warning, "materials that are not in its MTL files", name);
    if (left_out_ > 0)
      out_.warn(fmt::format("{} textures of opacity (map_d) are left out", left_out_));
    return of_points ? out_.finish_points() : out_.finish(UpAxis::y);
  }
  // The vertices that p refers to, or else all vertices.
  void add_points() {
    std::set<uint32_t> chosen(points_.begin(), points_.end());
    out_.positions.clear(), out_.colors.clear();
    for (uint32_t i = 0; i < places_.size(); ++i) {
      if (!is_place(places_[i]) || (!chosen.empty() && !chosen.contains(i))) continue;
      out_.positions.push_back(places_[i]);
      if (!colors_.empty()) out_.colors.push_back(i < colors_.size() ? colors_[i] : Rgb(1));
    }
    if (out_.positions.empty()) throw ReadFailure{"no point has a finite position"};
  }

  static constexpr uint32_t kNone = 0xffffffffu, kMoved = 0x80000000u;
  struct Counts {
    size_t places = 0, normals = 0, uvs = 0;
  };
  struct Use {
    uint32_t vertex = kNone, uv = kNone;
  };

  Words words_, start_;
  const ReadOptions& options_;
  FileOrigin& origin_;
  MeshBuilder& out_;
  Pass pass_ = Pass::one;
  Counts before_;  // at this line
  // As in the file.
  std::vector<Vec3f> places_;
  std::vector<Rgb> colors_;
  std::vector<Uv> uvs_, moved_uvs_;
  std::map<std::pair<const PaintMap*, uint32_t>, uint32_t> moved_;  // to moved_uvs_ and kMoved
  const PaintMap* map_ = nullptr;  // of the current material, if it transforms coordinates
  std::vector<Use> first_uses_;    // of each position
  std::unordered_map<uint64_t, uint32_t> other_uses_;  // by position and texture coordinates
  std::vector<uint32_t> corners_, normals_;            // of the current face
  std::set<std::string> libraries_;
  Paints paints_;
  std::map<std::string, MaterialId, std::less<>> materials_;
  std::optional<MaterialId> material_;  // of the next faces
  std::set<uint32_t> unknown_normals_;  // not finite
  std::vector<uint32_t> points_;        // positions that p refers to
  std::vector<std::string> missing_;    // materials that are not in the MTL files
  size_t left_out_ = 0, point_lines_ = 0;
  bool has_smooth_ = false;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_obj(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options) {
  return read_guarded(file, [&] {
    return read_about([&](FileOrigin& origin) {
      try {
        MeshBuilder builder;
        return ObjReader(bytes, options, origin, builder).read();
      } catch (const OutOfOrder&) {
        MeshBuilder builder;
        return ObjReader(bytes, options, origin, builder).read_in_two_passes();
      }
    });
  });
}

}  // namespace raio::core
