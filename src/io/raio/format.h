// How a .raio scene lies in its file (docs/raio-scene.md). Internal to this room; the fuzzer of the
// format uses it, too.
//
// A header, a table of columns, the columns. Everything is little endian and begins at a multiple
// of 64 bytes; what lies between is zero. Columns stand in the file in the order of the table, and
// in the table in that of for_each_file_column(), without those that are empty. So there is one
// file only for a scene, and no byte that does not matter.
#pragma once

#include <bit>
#include <cstring>
#include <string_view>

#include "base/hash.h"
#include "scene/columns.h"

namespace raio::scene_file {

static_assert(std::endian::native == std::endian::little,
              "columns are read where they lie, with the lowest byte first");

inline constexpr std::string_view kMagic = "RAIOSCEN";
inline constexpr uint32_t kByteOrder = 0x01020304;
/// A file of another major version cannot be read. One of a later minor version can, unless it has
/// columns that came with it.
inline constexpr uint32_t kMajor = 1, kMinor = 0;
inline constexpr size_t kAlignment = 64;
inline constexpr uint32_t kNoMesh = 0xffffffffu;

struct Header {
  char magic[8] = {};
  uint32_t byte_order = kByteOrder;
  uint32_t major = kMajor, minor = kMinor;
  uint32_t columns = 0;
  uint64_t file_size = 0;
  Hash128 hash{};  // of header and table, with zeros here
  char zeros[16] = {};
};
static_assert(sizeof(Header) == 64);

/// What the elements of a column are made of.
enum class Number : uint32_t { u8 = 1, u32 = 2, f32 = 3, f64 = 4 };

constexpr size_t bytes_of(Number number) {
  switch (number) {
    case Number::u8:
      return 1;
    case Number::u32:
    case Number::f32:
      return 4;
    case Number::f64:
      return 8;
  }
  return 0;
}

struct Entry {
  char name[32] = {};          // with zeros behind
  Number number = Number::u8;  // an element is
  uint32_t numbers = 0;        // so many of them
  uint32_t mesh = kNoMesh;     // to which the column belongs, or which prototype it is
  uint32_t zero = 0;
  uint64_t count = 0, offset = 0;
  Hash128 hash{};  // column_hash() of its bytes
};
static_assert(sizeof(Entry) == 80);

/// A type of elements as a file names it. A new one is a line; primitives are made of floats.
template <class T>
struct Element;
template <Number n, uint32_t count>
struct Numbers {
  static constexpr Number number = n;
  static constexpr uint32_t numbers = count;
};
// clang-format off
template <> struct Element<char> : Numbers<Number::u8, 1> {};
template <> struct Element<uint32_t> : Numbers<Number::u32, 1> {};
template <> struct Element<float> : Numbers<Number::f32, 1> {};
template <> struct Element<Vec3d> : Numbers<Number::f64, 3> {};
template <> struct Element<Vec3f> : Numbers<Number::f32, 3> {};
template <> struct Element<Uv> : Numbers<Number::f32, 2> {};
template <> struct Element<TriangleIndices> : Numbers<Number::u32, 3> {};
template <> struct Element<Material> : Numbers<Number::f32, 8> {};
template <Primitive T> struct Element<T> : Numbers<Number::f32, sizeof(T) / sizeof(float)> {};
template <> struct Element<Polygon> : Numbers<Number::u32, 2> {};
template <> struct Element<ObjectRange> : Numbers<Number::u32, 4> {};
// A number and a matrix, whose floats a file calls what takes as many bytes.
template <> struct Element<Instance> : Numbers<Number::u32, 13> {};
template <> struct Element<Texture> : Numbers<Number::u32, 5> {};
// clang-format on

constexpr size_t aligned(size_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

/// hash128 of a short column; of a long one, that of the hashes of its mebibytes, on all threads.
Hash128 column_hash(std::string_view bytes);
/// Of the header, whose `hash` does not count, and the table.
Hash128 table_hash(Header header, std::string_view table);

/// What a scene has besides its columns, as columns.
struct Settings {
  Array<Vec3d> origin;                       // 1
  Array<float> camera;                       // 11: from, at, up, angle, hither
  Array<uint32_t> raster;                    // 3: width, height, samples per pixel
  Array<float> lens_radius, focus_distance;  // 1 or none
  Array<Rgb> background;                     // 1
  Array<Vec3f> light_positions;
  Array<uint32_t> light_colored;  // 1: the light has a colour
  Array<Rgb> light_colors;        // black where it has none
  Array<char> object_names;       // one after another
  Array<uint32_t> object_name_ends;
  Array<uint32_t> dialect;     // 2 or none: Dialect and AccelHint, where not both are 0
  Array<Vec3f> light_extents;  // width, depth, points; zeros for lights that have none
  Array<char> sky_folder;
  Array<float> camera_movement;         // 8 or none: from, at, begin, end
  Array<float> camera_across;           // 1 or none: degrees
  Array<uint32_t> camera_projection;    // 1 or none: Projection, where it is not 0
  std::vector<Array<char>> prototypes;  // each a scene as the bytes of a file
};

Settings settings_of(const Scene& scene);
/// What is wrong with the settings, or nothing, and the scene has them.
std::string apply(const Settings& settings, Scene& scene);

template <class SettingsType, class F>
void for_each_settings_column(SettingsType& s, F&& f) {
  f(ColumnName{"origin"}, s.origin);
  f(ColumnName{"camera"}, s.camera);
  f(ColumnName{"raster"}, s.raster);
  f(ColumnName{"lens_radius"}, s.lens_radius);
  f(ColumnName{"focus_distance"}, s.focus_distance);
  f(ColumnName{"background"}, s.background);
  f(ColumnName{"light_positions"}, s.light_positions);
  f(ColumnName{"light_colored"}, s.light_colored);
  f(ColumnName{"light_colors"}, s.light_colors);
  f(ColumnName{"object_names"}, s.object_names);
  f(ColumnName{"object_name_ends"}, s.object_name_ends);
  f(ColumnName{"dialect"}, s.dialect);
  f(ColumnName{"light_extents"}, s.light_extents);
  f(ColumnName{"sky_folder"}, s.sky_folder);
  f(ColumnName{"camera_movement"}, s.camera_movement);
  f(ColumnName{"camera_across"}, s.camera_across);
  f(ColumnName{"camera_projection"}, s.camera_projection);
}

/// Of the columns that are prototypes; their `mesh` is the number of one.
inline constexpr std::string_view kPrototype = "prototype";

/// Calls f(name, mesh, array) for all columns of a file in their order. `mesh` is kNoMesh, or that
/// to which the array belongs.
template <class SettingsType, class SceneType, class F>
void for_each_file_column(SettingsType& settings, SceneType& scene, F&& f) {
  uint32_t mesh = kNoMesh;
  const auto with_mesh = [&](ColumnName column, auto& array) { f(column.name, mesh, array); };
  for_each_settings_column(settings, with_mesh);
  for_each_own_column(scene, with_mesh);
  for (auto& each : scene.meshes) {
    ++mesh;  // from kNoMesh to 0
    for_each_mesh_column(each, with_mesh);
  }
  for (size_t i = 0; i < settings.prototypes.size(); ++i)
    f(kPrototype, uint32_t(i), settings.prototypes[i]);
}

}  // namespace raio::scene_file
