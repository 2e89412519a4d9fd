// The layout of a .raio scene (docs/raio-scene.md). Internal to this room and the format's fuzzer.
//
// A header, a table of columns, the columns. Everything is little-endian and starts at a multiple
// of 64 bytes; gaps are zero. Columns are stored in the order of the table, which is that of
// for_each_file_column() without empty ones. So a scene has exactly one file, and every byte
// matters.
#pragma once

#include <bit>
#include <cstring>
#include <string_view>

#include "base/hash.h"
#include "scene/columns.h"

namespace raio::core::scene_file {

static_assert(std::endian::native == std::endian::little,
              "columns are read in place, little-endian");

inline constexpr std::string_view kMagic = "RAIOSCEN";
inline constexpr uint32_t kByteOrder = 0x01020304;
/// Files of another major version cannot be read. Those of a later minor version can, unless they
/// have columns added by it.
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

/// The type of a column's numbers.
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
  char name[32] = {};          // zero-terminated
  Number number = Number::u8;  // the type of numbers
  uint32_t numbers = 0;        // per element
  uint32_t mesh = kNoMesh;     // the column's mesh, or the prototype's index
  uint32_t zero = 0;
  uint64_t count = 0, offset = 0;
  Hash128 hash{};  // column_hash() of its bytes
};
static_assert(sizeof(Entry) == 80);

/// The stored form of an element type. A new type is a line; primitives consist of floats.
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
// A number and a matrix; the file declares them as 32-bit words of one type.
template <> struct Element<Instance> : Numbers<Number::u32, 13> {};
template <> struct Element<Texture> : Numbers<Number::u32, 5> {};
// Floats and whole numbers, declared as 32-bit words as well.
template <> struct Element<PhysicalLight> : Numbers<Number::u32, sizeof(PhysicalLight) / 4> {};
template <> struct Element<StandardSurface> : Numbers<Number::u32, sizeof(StandardSurface) / 4> {};
template <> struct Element<Environment> : Numbers<Number::u32, sizeof(Environment) / 4> {};
// clang-format on

constexpr size_t aligned(size_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

/// hash128 of a short column; for a long one, that of the hashes of its mebibytes, on all threads.
Hash128 column_hash(std::string_view bytes);
/// The hash of the header, except its `hash`, and the table.
Hash128 table_hash(Header header, std::string_view table);

/// The scene's members that are not columns, as columns.
struct Settings {
  Array<Vec3d> origin;                       // 1
  Array<float> camera;                       // 11: from, at, up, angle, hither
  Array<uint32_t> raster;                    // 3: width, height, samples per pixel
  Array<float> lens_radius, focus_distance;  // 1 or none
  Array<Rgb> background;                     // 1
  Array<Vec3f> light_positions;
  Array<uint32_t> light_colored;  // 1: the light has a colour
  Array<Rgb> light_colors;        // black if it has none
  Array<char> object_names;       // concatenated
  Array<uint32_t> object_name_ends;
  Array<uint32_t> dialect;     // 2 or none: Dialect and AccelHint, unless both are 0
  Array<Vec3f> light_extents;  // width, depth, points; zeros for lights without
  Array<char> sky_folder;
  Array<float> camera_movement;         // 8 or none: from, at, begin, end
  Array<float> camera_across;           // 1 or none: degrees
  Array<uint32_t> camera_projection;    // 1 or none: Projection, unless it is 0
  std::vector<Array<char>> prototypes;  // each a scene as the bytes of a file
};

Settings settings_of(const Scene& scene);
/// Applies the settings to the scene; returns the error, or nothing.
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

/// The name of columns that are prototypes; their `mesh` is the index.
inline constexpr std::string_view kPrototype = "prototype";

/// Calls f(name, mesh, array) for all columns of a file in order. `mesh` is kNoMesh, or the mesh
/// that the array belongs to.
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

}  // namespace raio::core::scene_file
