// Types and values of parameters, numbered as by ANARI (Khronos, ANARI 1.1, "Data Types").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace raio::device {

/// The types that the device names; vectors, matrices and boxes of other numbers exist, too. The
/// numbers are those of ANARIDataType.
enum class DataType : int32_t {
  unknown = 0,
  data_type = 100,
  string = 101,
  void_pointer = 102,
  boolean = 103,
  string_list = 150,
  data_type_list = 151,
  parameter_list = 152,
  status_callback = 202,
  frame_completion_callback = 203,
  device = 501,
  object = 502,
  array = 503,
  array1d = 504,
  array2d = 505,
  array3d = 506,
  camera = 507,
  frame = 508,
  geometry = 509,
  group = 510,
  instance = 511,
  light = 512,
  material = 513,
  renderer = 514,
  surface = 515,
  sampler = 516,
  spatial_field = 517,
  volume = 518,
  world = 519,
  uint8 = 1004,
  int32 = 1016,
  uint32 = 1020,
  uint32_vec2 = 1021,
  uint32_vec3 = 1022,
  uint32_vec4 = 1023,
  uint64 = 1028,
  uint64_vec2 = 1029,
  uint64_vec3 = 1030,
  uint64_vec4 = 1031,
  fixed16_vec3 = 1042,
  fixed16_vec4 = 1043,
  ufixed8 = 1036,
  ufixed8_vec2 = 1037,
  ufixed8_vec3 = 1038,
  ufixed8_vec4 = 1039,
  float32 = 1068,
  float32_vec2 = 1069,
  float32_vec3 = 1070,
  float32_vec4 = 1071,
  ufixed8_rgb_srgb = 2002,
  ufixed8_rgba_srgb = 2003,
  float32_box2 = 2009,
  float32_box3 = 2010,
  float32_mat4 = 2014,
  uint64_region1 = 2104,
};

/// How numbers are stored. Fixed-point numbers are from -1 to 1, unsigned ones from 0 to 1.
enum class Scalar : uint8_t {
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64,
  fixed8,
  ufixed8,
  fixed16,
  ufixed16,
  fixed32,
  ufixed32,
  fixed64,
  ufixed64,
  float16,
  float32,
  float64,
  srgb8,  ///< 8 bits; all but a fourth (or second of two) number, the opacity, are encoded for
          ///< displays
};

/// `count` numbers of one kind.
struct Layout {
  Scalar scalar;
  int count;
};

/// Nothing for types that are not numbers.
std::optional<Layout> layout_of(DataType type);
/// Bytes of a value, or of an element of an array; 0: no such type.
size_t size_of(DataType type);
bool is_object(DataType type);
bool is_array(DataType type);
/// Whether an object of type `found` serves where `expected` is asked for.
bool fits(DataType found, DataType expected);
/// "FLOAT32_VEC3", as in messages.
std::string name_of(DataType type);

/// Number `i` of the numbers at `data`, as a double; colours are decoded to light.
double number_at(const std::byte* data, const Layout& layout, int i);

/// The byte of display values (sRGB) for a light.
uint8_t display_byte(double light);
/// Between display values and light, to 1e-6; numbers outside of 0 to 1 continue the curve.
double light_of_display(double value);
double display_of_light(double light);

class Object;

/// The value of a parameter.
struct Value {
  DataType type = DataType::unknown;
  alignas(8) std::array<std::byte, 64> bytes{};
  std::string text;                // of strings
  std::shared_ptr<Object> object;  // of objects and arrays

  template <class T>
  T as() const {
    static_assert(sizeof(T) <= 64);
    T out;
    std::memcpy(static_cast<void*>(&out), bytes.data(), sizeof(T));
    return out;
  }
};

}  // namespace raio::device
