// The Polygon File Format of Greg Turk (1994): a header that names elements and their properties,
// then the elements, as text or as numbers of either byte order.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/srgb.h"
#include "io/colormaps.h"
#include "io/fit_camera.h"
#include "io/mesh/builder.h"
#include "io/mesh/read.h"
#include "io/points.h"

namespace raio {
namespace {

enum class Type : uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::array<std::string_view, 16> kTypeNames = {
    "char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
constexpr size_t kTypes = 8;
constexpr size_t kMostCorners = 65535;
constexpr std::array<size_t, kTypes> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
  std::string name;
  Type type = Type::f32;
  std::optional<Type> count;  // of a list
};
struct Element {
  std::string name;
  size_t count = 0;
  std::vector<Property> properties;
};
enum class Encoding : uint8_t { text, little, big };

// What is wanted of a vertex, by the names that programs write.
enum Wanted : size_t { kX, kY, kZ, kRadius, kRed, kGreen, kBlue, kAlpha, kNx, kNy, kNz, kU, kV };
constexpr size_t kWanted = 13;
constexpr std::array<std::array<std::string_view, 4>, kWanted> kNames = {
    {{"x"},
     {"y"},
     {"z"},
     {"radius"},
     {"red", "diffuse_red", "r"},
     {"green", "diffuse_green", "g"},
     {"blue", "diffuse_blue", "b"},
     {"alpha", "opacity"},
     {"nx"},
     {"ny"},
     {"nz"},
     {"u", "s", "texture_u"},
     {"v", "t", "texture_v"}}};
using Values = std::array<double, kWanted>;

template <class T>
T number_at(const char* p, bool swap) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), p, sizeof(T));
  if (swap) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

double number_at(const char* p, Type type, bool swap) {
  switch (type) {
    case Type::i8:
      return double(number_at<int8_t>(p, swap));
    case Type::u8:
      return double(number_at<uint8_t>(p, swap));
    case Type::i16:
      return double(number_at<int16_t>(p, swap));
    case Type::u16:
      return double(number_at<uint16_t>(p, swap));
    case Type::i32:
      return double(number_at<int32_t>(p, swap));
    case Type::u32:
      return double(number_at<uint32_t>(p, swap));
    case Type::f32:
      return double(number_at<float>(p, swap));
    case Type::f64:
      break;
  }
  return number_at<double>(p, swap);
}

class PlyReader {
 public:
  PlyReader(const TextBuffer& bytes, const ReadOptions& options)
      : p_(bytes.begin()), end_(bytes.end()), options_(options) {}

  ReadScene read() {
    read_header();
    for (const Element& element : elements_) {
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face" || element.name == "tristrips")
        read_faces(element);
      else
        skip(element);
    }
    return finish();
  }

 private:
  [[noreturn]] void fail(std::string message) const {
    const int line = encoding_ == Encoding::text || in_header_ ? line_ : 0;
    throw ReadFailure{std::move(message), line, line > 0};
  }

  // --- the header
  std::string_view header_line() {
    const char* const stop = std::find(p_, end_, '\n');
    if (stop == end_) fail("the header has no end_header");
    std::string_view line(p_, size_t(stop - p_));
    if (line.ends_with('\r')) line.remove_suffix(1);
    p_ = stop + 1;
    ++line_;
    return line;
  }
  static std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
      const size_t first = line.find_first_not_of(" \t");
      if (first == std::string_view::npos) return words;
      line.remove_prefix(first);
      const size_t size = std::min(line.find_first_of(" \t"), line.size());
      words.push_back(line.substr(0, size));
      line.remove_prefix(size);
    }
  }
  Type type_of(std::string_view name) const {
    const auto at = std::ranges::find(kTypeNames, name);
    if (at == kTypeNames.end())
      fail(fmt::format("expected a type such as float or uchar, found {}", quoted(name)));
    return Type(size_t(at - kTypeNames.begin()) % kTypes);
  }
  void read_header() {
    if (header_line() != "ply") fail("expected \"ply\"");
    bool has_format = false;
    while (true) {
      const auto words = words_of(header_line());
      const std::string_view word = words.empty() ? "" : words[0];
      if (word == "end_header") break;
      if (word.empty() || word == "comment" || word == "obj_info") continue;
      if (word == "format" && words.size() == 3) {
        constexpr std::array<std::string_view, 3> kEncodings = {"ascii", "binary_little_endian",
                                                                "binary_big_endian"};
        const auto at = std::ranges::find(kEncodings, words[1]);
        if (at == kEncodings.end()) fail(fmt::format("unknown format {}", quoted(words[1])));
        encoding_ = Encoding(at - kEncodings.begin());
        has_format = true;
      } else if (word == "element" && words.size() == 3) {
        size_t count = 0;
        const auto [stop, error] =
            std::from_chars(words[2].data(), words[2].data() + words[2].size(), count);
        if (error != std::errc() || stop != words[2].data() + words[2].size())
          fail(fmt::format("expected a number of elements, found {}", quoted(words[2])));
        elements_.push_back({std::string(words[1]), count, {}});
      } else if (word == "property" && !elements_.empty() && words.size() == 3) {
        elements_.back().properties.push_back({std::string(words[2]), type_of(words[1]), {}});
      } else if (word == "property" && !elements_.empty() && words.size() == 5 &&
                 words[1] == "list") {
        elements_.back().properties.push_back(
            {std::string(words[4]), type_of(words[3]), type_of(words[2])});
      } else {
        fail(fmt::format("expected format, element, property, comment or end_header, found {}",
                         quoted(word)));
      }
    }
    if (!has_format) fail("the header has no line \"format\"");
    in_header_ = false;
    swap_ = encoding_ == Encoding::big;
  }

  // --- numbers, one after another
  double next(Type type) {
    if (encoding_ == Encoding::text) {
      while (is_char(*p_, kBlank) && p_ < end_) line_ += *p_++ == '\n';
      double value = 0;
      const char* const stop = p_ < end_ ? parse_number(p_, value) : nullptr;
      if (!stop)
        fail(fmt::format("expected a number, found {}",
                         p_ < end_ ? quoted(word_at(p_)) : "the end of the file"));
      p_ = stop;
      return value;
    }
    const size_t size = kSizes[size_t(type)];
    if (size_t(end_ - p_) < size) fail("the file ends within its elements");
    const double value = number_at(p_, type, swap_);
    p_ += size;
    return value;
  }
  size_t next_count(const Property& property) {
    const double count = next(*property.count);
    // A number takes a byte at least, in text two.
    if (!(count >= 0 && count <= double(end_ - p_)))
      fail(fmt::format("a list of {} numbers does not fit into the file", count));
    return size_t(count);
  }
  void skip(const Element& element) {
    if (element.count > 0) check_count(element);
    for (size_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties) {
        const size_t count = property.count ? next_count(property) : 1;
        for (size_t k = 0; k < count; ++k) (void)next(property.type);
      }
  }
  // No element takes less than a byte.
  void check_count(const Element& element) const {
    if (element.properties.empty() || element.count > size_t(end_ - p_))
      fail(fmt::format("the {} elements {} that the header names do not fit into the file",
                       element.count, raio::quoted(element.name)));
    if (element.count >= (size_t(1) << 29))
      fail(fmt::format("{} elements {} are too many", element.count, raio::quoted(element.name)));
  }

  // --- vertices
  void read_vertices(const Element& element) {
    if (element.count == 0) return;
    if (count_ > 0) fail("there are two lists of vertices");
    check_count(element);
    std::vector<size_t> offsets(element.properties.size());
    size_t row = 0;
    for (size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.count) fail("vertices with lists cannot be read");
      offsets[k] = row;
      row += kSizes[size_t(property.type)];
      for (size_t w = 0; w < kWanted; ++w)
        if (!property.name.empty() &&
            std::ranges::find(kNames[w], property.name) != kNames[w].end())
          at_[w] = k, is_whole_[w] = is_whole(property.type);
      if (!options_.color_by.empty() && property.name == options_.color_by) colored_by_ = k;
    }
    // Without the other two it is no colour.
    if (at_[kRed] && !at_[kGreen] && !at_[kBlue] && element.properties[*at_[kRed]].name == "r")
      at_[kRadius] = std::exchange(at_[kRed], std::nullopt);
    if (!options_.color_by.empty() && !colored_by_)
      fail(fmt::format("vertices have no property {}; there are {}",
                       raio::quoted(options_.color_by), names_of(element)));
    for (const size_t w : {kX, kY, kZ})
      if (!at_[w]) fail(fmt::format("vertices have no property {}", kNames[w][0]));
    allocate(element.count);
    if (encoding_ == Encoding::text) {
      std::vector<double> line(element.properties.size());
      for (size_t i = 0; i < element.count; ++i) {
        for (double& value : line) value = next(Type::f64);
        put(i, [&](size_t k) { return line[k]; });
      }
    } else {
      if (row > size_t(end_ - p_) / element.count) fail("the file ends within its vertices");
      for_each_index(element.count, [&](size_t i) {
        const char* const from = p_ + i * row;
        put(i, [&](size_t k) {
          return number_at(from + offsets[k], element.properties[k].type, swap_);
        });
      });
      p_ += row * element.count;
    }
  }
  static bool is_whole(Type type) { return type != Type::f32 && type != Type::f64; }
  static std::string names_of(const Element& element) {
    std::string names;
    for (const Property& property : element.properties)
      names += (names.empty() ? "" : ", ") + raio::quoted(property.name);
    return names;
  }
  bool has(Wanted w) const { return at_[w].has_value(); }
  void allocate(size_t count) {
    count_ = count;
    places_.resize(count);
    if (has(kRadius)) radii_.resize(count);
    if (colored_by_)
      values_.resize(count);
    else if (has(kRed) && has(kGreen) && has(kBlue))
      colors_.resize(count);
    if (has(kAlpha)) opacity_.resize(count);
    if (has(kNx) && has(kNy) && has(kNz)) normals_.resize(count);
    if (has(kU) && has(kV)) uv_.resize(count);
  }
  template <class Get>
  void put(size_t i, const Get& get) {
    const auto value = [&](Wanted w) { return float(get(*at_[w])); };
    // A text may have numbers that no byte has.
    const auto light = [&](Wanted w) {
      const double x = get(*at_[w]);
      return is_whole_[w] ? kLight[size_t(x > 0 ? std::min(x, 255.0) : 0)]
                          : linear_from_srgb(float(x));
    };
    places_[i] = {value(kX), value(kY), value(kZ)};
    if (!radii_.empty()) radii_[i] = value(kRadius);
    if (!colors_.empty()) colors_[i] = {light(kRed), light(kGreen), light(kBlue)};
    if (!values_.empty()) values_[i] = float(get(*colored_by_));
    if (!opacity_.empty()) {
      const float a = is_whole_[kAlpha] ? value(kAlpha) / 255 : value(kAlpha);
      opacity_[i] = a > 0 ? std::min(a, 1.0f) : 0;
    }
    if (!normals_.empty()) normals_[i] = {value(kNx), value(kNy), value(kNz)};
    if (!uv_.empty()) uv_[i] = {value(kU), value(kV)};
  }

  // --- faces, and strips of triangles that -1 parts
  void read_faces(const Element& element) {
    if (element.count == 0) return;
    if (count_ == 0) fail("the faces come before the vertices; write the vertices first");
    check_count(element);
    check_places();
    mesh_.positions = places_;
    const bool strips = element.name == "tristrips";
    std::array<std::optional<size_t>, 3> color;
    std::optional<size_t> corners;
    for (size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.count && property.name.starts_with("vertex_ind")) corners = k;
      for (size_t c = 0; c < 3; ++c)
        if (!property.count && std::ranges::count(kNames[kRed + c], property.name) > 0)
          color[c] = k;
    }
    if (!corners) fail(fmt::format("elements {} have no list vertex_indices", element.name));
    const bool colored = color[0] && color[1] && color[2];
    const MaterialId usual = mesh_.paint(colors_.empty() && !colored_by_ ? kPlainColor : Rgb(1));
    std::vector<int64_t> list;
    std::vector<double> row(element.properties.size());
    for (size_t i = 0; i < element.count; ++i) {
      for (size_t k = 0; k < row.size(); ++k) {
        const Property& property = element.properties[k];
        if (!property.count) {
          row[k] = next(property.type);
          continue;
        }
        const size_t count = next_count(property);
        if (k == *corners) list.clear();
        for (size_t n = 0; n < count; ++n)
          if (const double index = next(property.type); k == *corners)
            list.push_back(vertex(index, i, strips));
      }
      MaterialId material = usual;
      if (colored) {
        const auto light = [&](size_t c) {
          const double unit = is_whole(element.properties[*color[c]].type) ? 255 : 1;
          return linear_from_srgb(float(row[*color[c]] / unit));
        };
        const float red = light(0), green = light(1);
        material = mesh_.paint({red, green, light(2)});
      }
      add_face(list, strips, material);
    }
  }
  int64_t vertex(double index, size_t face, bool strips) const {
    if (strips && index == -1) return -1;
    if (!(index >= 0 && index < double(count_) && index == std::floor(index)))
      fail(fmt::format("face {} names vertex {}, of {}", face, index, count_));
    return int64_t(index);
  }
  void add_face(std::span<const int64_t> list, bool strips, MaterialId material) {
    corners_.clear();
    if (!strips) {
      if (list.size() > kMostCorners)
        fail(fmt::format("a face of {} corners is too large", list.size()));
      corners_.assign(list.begin(), list.end());
      if (corners_.size() >= 3) mesh_.add_face(corners_, material);
      return;
    }
    for (const int64_t index : list) {
      if (index < 0) {
        corners_.clear();
        continue;
      }
      corners_.push_back(uint32_t(index));
      const size_t n = corners_.size();
      if (n < 3) continue;
      // Each second one turns the other way.
      const auto [a, b] = n % 2 ? std::pair(n - 3, n - 2) : std::pair(n - 2, n - 3);
      mesh_.add_face(std::array{corners_[a], corners_[b], corners_[n - 1]}, material);
    }
  }

  // --- the scene
  void check_places() const {
    for (size_t i = 0; i < count_; ++i)
      if (!is_place(places_[i])) fail(fmt::format("vertex {} has no finite place", i));
  }
  ReadScene finish() {
    if (count_ == 0) fail("there are no vertices");
    check_places();
    for (size_t i = 0; i < radii_.size(); ++i)
      if (!(radii_[i] > 0 && radii_[i] <= kFarthestPlace))
        fail(fmt::format("vertex {} has a radius of {}; expected a positive number", i, radii_[i]));
    std::optional<ColorScale> scale;
    if (colored_by_) {
      auto mapped = map_colors(values_, options_.colormap, options_.color_range);
      if (!mapped) fail(mapped.error());
      colors_ = std::move(mapped->colors);
      scale = mapped->scale, scale->name = options_.color_by;
    } else if (!options_.colormap.empty() || options_.color_range) {
      fail("a colour map or range has no effect without `color-by`; leave it out");
    }
    ReadScene read;
    if (mesh_.has_faces()) {
      read = make_mesh();
    } else {
      read.scene.dialect = Dialect::data;
      make_spheres(read.scene);
      fit_camera(read.scene, FitView::three_quarter);
    }
    read.colors = scale;
    return read;
  }
  static Material paint(Rgb color) { return {.color = color, .kd = 1}; }

  void make_spheres(Scene& scene) {
    scene.spheres.resize(count_);
    const float radius = options_.radius > 0 ? options_.radius
                         : radii_.empty()    ? mean_spacing(places_) / 2
                                             : 0;
    Sphere* const spheres = scene.spheres.data();
    for_each_index(
        count_, [&](size_t i) { spheres[i] = {places_[i], radii_.empty() ? radius : radii_[i]}; });
    scene.sphere_materials.resize(count_, 0);
    const bool one = std::ranges::all_of(colors_, [&](const Rgb& c) { return c == colors_[0]; });
    scene.materials = std::vector<Material>{paint(colors_.empty() ? kPlainColor : colors_[0])};
    if (!one) scene.sphere_colors = std::move(colors_);
    if (std::ranges::any_of(opacity_, [](float a) { return a < 1; }))
      scene.sphere_opacity = std::move(opacity_);
  }
  ReadScene make_mesh() {
    if (options_.radius > 0) fail("`radius` has no effect on a mesh; leave it out");
    if (std::ranges::any_of(opacity_, [](float a) { return a < 1; }))
      mesh_.warn("the opacities of its vertices are left out");
    for (Vec3f& n : normals_) {
      const float size = length(n);
      n = size > 0 && std::isfinite(size) ? n / size : Vec3f(0, 0, 1);
    }
    mesh_.normals = std::move(normals_);
    mesh_.colors = std::move(colors_);
    if (std::ranges::all_of(
            uv_, [](const Uv& at) { return std::isfinite(at[0]) && std::isfinite(at[1]); }))
      mesh_.uv = std::move(uv_);
    return mesh_.finish({0, 0, 1});
  }

  static inline const std::array<float, 256> kLight = [] {
    std::array<float, 256> light{};
    for (size_t i = 0; i < light.size(); ++i) light[i] = linear_from_srgb(float(i) / 255);
    return light;
  }();

  const char* p_;
  const char* end_;
  const ReadOptions& options_;
  Encoding encoding_ = Encoding::text;
  bool swap_ = false, in_header_ = true;
  int line_ = 0;
  std::vector<Element> elements_;
  size_t count_ = 0;
  std::array<std::optional<size_t>, kWanted> at_;  // among the properties of vertices
  std::array<bool, kWanted> is_whole_{};
  std::optional<size_t> colored_by_;  // by the property of vertices
  std::vector<Vec3f> places_, normals_;
  std::vector<float> radii_, opacity_, values_;
  std::vector<Rgb> colors_;
  std::vector<Uv> uv_;
  std::vector<uint32_t> corners_;
  MeshBuilder mesh_;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_ply(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options) {
  return read_guarded(file, [&] { return PlyReader(bytes, options).read(); });
}

}  // namespace raio
