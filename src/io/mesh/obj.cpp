// OBJ and MTL of Wavefront (1992): positions, normals, texture coordinates and faces, a keyword a
// line, and a file of materials beside it. Of curves, surfaces, lines and points nothing is kept.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <ranges>
#include <set>
#include <unordered_map>

#include "base/srgb.h"
#include "io/mesh/builder.h"
#include "io/mesh/read.h"

namespace raio {
namespace {

namespace fs = std::filesystem;

// What map_Kd says.
struct PaintMap {
  fs::path library;  // the MTL file
  int line = 0;
  std::string name;  // of the picture, from that file on; empty: there is none
  bool clamp = false;
  std::array<float, 2> offset{0, 0}, scale{1, 1};

  bool moves() const { return offset != std::array{0.0f, 0.0f} || scale != std::array{1.0f, 1.0f}; }
};

struct Paint {
  std::optional<Rgb> color;
  double opacity = 1;
  PaintMap map;
};
using Paints = std::map<std::string, Paint, std::less<>>;

// The line of a map_Kd behind its keyword. Options that are not known are told.
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
      (void)words.next();  // how it is filtered
    } else {
      const bool takes_numbers = option == "-t" || option == "-mm" || option == "-boost";
      for (int i = 0; i < 3 && takes_numbers && looks_like_number(words.peek()); ++i)
        (void)words.next();
      if (!takes_numbers) (void)words.next();
      warnings.push_back({Severity::warning, library.string(), map.line, 1,
                          fmt::format("the option {} of map_Kd is left out", raio::quoted(option)),
                          ""});
    }
  }
  map.name = words.rest();
  return map;
}

// What the words of an MTL file say of its materials; throws ReadFailure. `left_out`: textures.
void read_mtl(const TextBuffer& text, const fs::path& library, Paints& out, size_t& left_out,
              Diagnostics& warnings) {
  Words words(text);
  Paint* paint = nullptr;
  const auto read_line = [&] {
    const std::string_view word = words.next();
    if (word == "newmtl") {
      paint = &out[std::string(words.rest())];
    } else if (word == "Kd" && paint && looks_like_number(words.peek())) {
      const auto part = [&] { return linear_from_srgb(float(words.number("a part of a colour"))); };
      const float red = part(), green = part();
      paint->color = Rgb(red, green, part());
    } else if (word == "d" && paint) {
      if (words.peek() == "-halo") (void)words.next();
      paint->opacity = words.number("an opacity");
    } else if (word == "Tr" && paint) {
      paint->opacity = 1 - words.number("a transparency");
    } else if (word == "map_Kd" && paint) {
      paint->map = read_map(words, library, warnings);
    } else if (word == "map_d") {
      ++left_out;
    }
  };
  if (!words.peek().empty()) read_line();
  while (words.next_line()) read_line();
}

class ObjReader {
 public:
  ObjReader(const TextBuffer& text, const ReadOptions& options, MeshBuilder& out)
      : words_(text), options_(options), out_(out) {}

  void read() {
    if (!words_.peek().empty()) read_line();
    while (words_.next_line()) read_line();
    finish();
  }

 private:
  void read_line() {
    const std::string_view word = words_.next();
    if (word == "v")
      read_vertex();
    else if (word == "vn")
      read_normal();
    else if (word == "vt")
      read_uv();
    else if (word == "f" || word == "fo")
      read_face();
    else if (word == "usemtl")
      use(words_.rest());
    else if (word == "mtllib")
      read_libraries(words_.rest());
    else
      (void)words_.rest();
  }

  void read_vertex() {
    places_.push_back(words_.place());
    first_uses_.push_back({});
    // Some programs write a weight behind it, others a colour.
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
    const Vec3f n = words_.place();
    const float size = length(n);
    out_.normals.push_back(size > 0 && std::isfinite(size) ? n / size : Vec3f(0, 0, 1));
  }
  void read_uv() {
    const float u = words_.coordinate();
    uvs_.push_back({u, words_.peek().empty() ? 0 : words_.coordinate()});
  }

  // A number from 1, or from -1 backwards, as an index into `count` things; p moves behind it.
  uint32_t index_at(const char*& p, const char* end, size_t count, std::string_view what) {
    long number = 0;
    const auto [stop, error] = std::from_chars(p, end, number);
    if (number < 0) number += long(count) + 1;
    if (error != std::errc() || number < 1 || number > long(count))
      words_.fail_expected(count == 0
                               ? fmt::format("no {}: there are none before this line", what)
                               : fmt::format("a {} from 1 to {} or -1 to -{}", what, count, count));
    p = stop;
    return uint32_t(number - 1);
  }

  void read_face() {
    corners_.clear(), normals_.clear();
    for (std::string_view word; !(word = words_.peek()).empty(); (void)words_.next()) {
      const char *p = word.data(), *const end = p + word.size();
      const uint32_t place = index_at(p, end, places_.size(), "vertex");
      uint32_t uv = kNone;
      if (p != end && *p == '/') {
        if (++p != end && *p != '/')
          uv = moved(index_at(p, end, uvs_.size(), "texture coordinate"));
        if (p != end && *p == '/')
          normals_.push_back(index_at(++p, end, out_.normals.size(), "normal"));
      }
      if (p != end) words_.fail_expected("a corner such as 1, 1/2, 1//3 or 1/2/3");
      corners_.push_back(vertex(place, uv));
      if (corners_.size() > kMostCorners) words_.fail("a face has at most 65535 corners");
    }
    if (corners_.empty()) words_.fail_expected("the corners of a face");
    if (corners_.size() < 3) return;  // a point or a line
    if (!normals_.empty() && normals_.size() != corners_.size())
      words_.fail("some corners of this face have a normal and others have none");
    has_smooth_ |= !normals_.empty();
    out_.add_face(corners_, material_ ? *material_ : usual(), normals_);
  }

  // That of the mesh at this place with these texture coordinates.
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
  // Texture coordinates where the material's picture is moved or scaled.
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
      id = usual();
      ++missing_;
    } else {
      const double a = paint->second.opacity;
      const uint32_t texture = texture_of(paint->second.map);
      const Rgb usual = texture == kNoTexture ? kPlainColor : Rgb(1);
      id =
          out_.paint(paint->second.color.value_or(usual), a >= 0 && a <= 1 ? float(a) : 1, texture);
    }
    return materials_.emplace(std::string(name), id).first->second;
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
         fmt::format("the texture {}: {}", raio::quoted(map.name), texture.error()), ""});
    return kNoTexture;
  }

  fs::path library_file(std::string_view name) const {
    std::string path(name);
    std::ranges::replace(path, '\\', '/');
    return options_.folder ? *options_.folder / path : fs::path();
  }
  // One, whose name may have blanks in it, or several.
  void read_libraries(std::string_view names) {
    std::error_code error;
    if (names.find(' ') == names.npos || fs::is_regular_file(library_file(names), error))
      return read_library(std::string(names));
    for (const auto word : std::views::split(names, ' '))
      if (!word.empty()) read_library(std::string(std::string_view(word)));
  }
  void read_library(const std::string& name) {
    if (!libraries_.insert(name).second) return;
    const fs::path file = library_file(name);
    std::error_code error;
    // Not what would wait for somebody to write to it.
    if (!options_.folder || !fs::is_regular_file(file, error))
      return out_.warn(
          fmt::format("its materials: there is no file {} beside it", raio::quoted(name)));
    const auto text = TextBuffer::read_file(file);
    if (!text)
      return out_.warn(fmt::format("its materials: {}: {}", raio::quoted(name), text.error()));
    try {
      read_mtl(*text, file, paints_, left_out_, out_.warnings);
    } catch (const ReadFailure& failure) {
      out_.warn(fmt::format("its materials: {}:{}:{}: {}", raio::quoted(name), failure.line,
                            failure.column, failure.message));
    }
  }

  void finish() {
    if (!out_.colors.empty()) out_.colors.resize(out_.positions.size(), Rgb(1));
    if (!out_.uv.empty()) out_.uv.resize(out_.positions.size());
    if (!has_smooth_) out_.normals.clear();
    if (missing_ > 0 && !paints_.empty())
      out_.warn(
          fmt::format("{} materials that it names are not in its files of materials", missing_));
    if (left_out_ > 0)
      out_.warn(fmt::format("{} textures of opacity (map_d) are left out", left_out_));
  }

  static constexpr uint32_t kNone = 0xffffffffu, kMoved = 0x80000000u;
  struct Use {
    uint32_t vertex = kNone, uv = kNone;
  };

  Words words_;
  const ReadOptions& options_;
  MeshBuilder& out_;
  // As the file has them.
  std::vector<Vec3f> places_;
  std::vector<Rgb> colors_;
  std::vector<Uv> uvs_, moved_uvs_;
  std::map<std::pair<const PaintMap*, uint32_t>, uint32_t> moved_;  // to moved_uvs_ and kMoved
  const PaintMap* map_ = nullptr;                      // of the faces to come, where it moves
  std::vector<Use> first_uses_;                        // of each place
  std::unordered_map<uint64_t, uint32_t> other_uses_;  // by place and texture coordinates
  std::vector<uint32_t> corners_, normals_;            // of a face
  std::set<std::string> libraries_;
  Paints paints_;
  std::map<std::string, MaterialId, std::less<>> materials_;
  std::optional<MaterialId> material_;  // of the faces to come
  size_t missing_ = 0, left_out_ = 0;
  bool has_smooth_ = false;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_obj(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options) {
  return read_guarded(file, [&] {
    MeshBuilder builder;
    ObjReader(bytes, options, builder).read();
    return builder.finish({0, 1, 0});
  });
}

}  // namespace raio
