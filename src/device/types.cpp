#include "device/types.h"

#include <fmt/format.h>
#include <raio/raio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/exact_math.h"

namespace raio::device {

namespace {

constexpr int kFirstVector = 1000, kLastVector = 1075, kFirstSrgb = 2000, kLastSrgb = 2003;
constexpr std::array<std::string_view, 19> kScalarNames = {
    "INT8",    "UINT8",    "INT16",   "UINT16",  "INT32",    "UINT32",  "INT64",
    "UINT64",  "FIXED8",   "UFIXED8", "FIXED16", "UFIXED16", "FIXED32", "UFIXED32",
    "FIXED64", "UFIXED64", "FLOAT16", "FLOAT32", "FLOAT64"};
constexpr std::array<size_t, 20> kScalarSizes = {1, 1, 2, 2, 4, 4, 8, 8, 1, 1,
                                                 2, 2, 4, 4, 8, 8, 2, 4, 8, 1};

template <class T>
T read(const std::byte* data) {
  T out;
  std::memcpy(&out, data, sizeof(T));
  return out;
}

template <class T>
double normalized(const std::byte* data) {
  return std::max(double(read<T>(data)) / double(std::numeric_limits<T>::max()), -1.0);
}

// IEEE 754 binary16.
double half_at(const std::byte* data) {
  const auto bits = read<uint16_t>(data);
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double sign = bits & 0x8000 ? -1 : 1;
  if (exponent == 31) return fraction ? std::nan("") : sign * HUGE_VAL;
  return sign * (exponent ? std::ldexp(1024 + fraction, exponent - 25) : std::ldexp(fraction, -24));
}

// The light of the display values (0 + shift) / 255, (1 + shift) / 255, ...
std::array<float, 256> light_of_bytes(float shift) {
  std::array<float, 256> table;
  for (size_t k = 0; k < 256; ++k) table[k] = std::max(float(k) + shift, 0.0f) / 255;
  to_linear(table.data(), table.size());
  return table;
}

}  // namespace

std::optional<Layout> layout_of(DataType type) {
  const int n = int(type);
  if (n >= kFirstVector && n <= kLastVector)
    return Layout{Scalar((n - kFirstVector) / 4), (n - kFirstVector) % 4 + 1};
  if (n >= kFirstSrgb && n <= kLastSrgb) return Layout{Scalar::srgb8, n - kFirstSrgb + 1};
  switch (n) {
    case 2004:
    case 2005:
    case 2006:
    case 2007:
      return Layout{Scalar::int32, 2 * (n - 2003)};
    case 2008:
    case 2009:
    case 2010:
    case 2011:
      return Layout{Scalar::float32, 2 * (n - 2007)};
    case 2012:
      return Layout{Scalar::float32, 4};
    case 2013:
      return Layout{Scalar::float32, 9};
    case 2014:
      return Layout{Scalar::float32, 16};
    case 2015:
      return Layout{Scalar::float32, 6};
    case 2016:
      return Layout{Scalar::float32, 12};
    case 2017:
      return Layout{Scalar::float32, 4};
    case 2104:
    case 2105:
    case 2106:
    case 2107:
      return Layout{Scalar::uint64, 2 * (n - 2103)};
    case 2208:
    case 2209:
    case 2210:
    case 2211:
      return Layout{Scalar::float64, 2 * (n - 2207)};
    default:
      return std::nullopt;
  }
}

bool is_array(DataType type) { return type >= DataType::array && type <= DataType::array3d; }

bool is_object(DataType type) { return type >= DataType::device && type <= DataType::world; }

bool fits(DataType found, DataType expected) {
  return found == expected || expected == DataType::object ||
         (expected == DataType::array && is_array(found));
}

size_t size_of(DataType type) {
  if (const auto layout = layout_of(type))
    return kScalarSizes[size_t(layout->scalar)] * size_t(layout->count);
  if (is_object(type)) return sizeof(void*);
  switch (type) {
    case DataType::data_type:
      return sizeof(int32_t);
    case DataType::boolean:
      return 1;
    case DataType::string:
    case DataType::void_pointer:
    case DataType::status_callback:
    case DataType::frame_completion_callback:
    case DataType::string_list:
    case DataType::data_type_list:
    case DataType::parameter_list:
      return sizeof(void*);
    default:
      return 0;
  }
}

std::string name_of(DataType type) {
  const int n = int(type);
  if (n >= kFirstVector && n <= kLastVector) {
    const auto layout = *layout_of(type);
    const auto scalar = kScalarNames[size_t(layout.scalar)];
    return layout.count == 1 ? std::string(scalar) : fmt::format("{}_VEC{}", scalar, layout.count);
  }
  static constexpr std::string_view kObjects[] = {
      "LIBRARY",  "DEVICE",  "OBJECT",   "ARRAY",         "ARRAY1D",  "ARRAY2D", "ARRAY3D",
      "CAMERA",   "FRAME",   "GEOMETRY", "GROUP",         "INSTANCE", "LIGHT",   "MATERIAL",
      "RENDERER", "SURFACE", "SAMPLER",  "SPATIAL_FIELD", "VOLUME",   "WORLD"};
  if (n >= 500 && n <= 519) return std::string(kObjects[n - 500]);
  switch (n) {
    case 100:
      return "DATA_TYPE";
    case 101:
      return "STRING";
    case 102:
      return "VOID_POINTER";
    case 103:
      return "BOOL";
    case 202:
      return "STATUS_CALLBACK";
    case 203:
      return "FRAME_COMPLETION_CALLBACK";
    case 2000:
      return "UFIXED8_R_SRGB";
    case 2001:
      return "UFIXED8_RA_SRGB";
    case 2002:
      return "UFIXED8_RGB_SRGB";
    case 2003:
      return "UFIXED8_RGBA_SRGB";
    case 2009:
      return "FLOAT32_BOX2";
    case 2010:
      return "FLOAT32_BOX3";
    case 2014:
      return "FLOAT32_MAT4";
    case 2104:
      return "UINT64_REGION1";
    default:
      return fmt::format("type {}", n);
  }
}

double number_at(const std::byte* data, const Layout& layout, int i) {
  data += kScalarSizes[size_t(layout.scalar)] * size_t(i);
  switch (layout.scalar) {
    case Scalar::int8:
      return read<int8_t>(data);
    case Scalar::uint8:
      return read<uint8_t>(data);
    case Scalar::int16:
      return read<int16_t>(data);
    case Scalar::uint16:
      return read<uint16_t>(data);
    case Scalar::int32:
      return read<int32_t>(data);
    case Scalar::uint32:
      return read<uint32_t>(data);
    case Scalar::int64:
      return double(read<int64_t>(data));
    case Scalar::uint64:
      return double(read<uint64_t>(data));
    case Scalar::fixed8:
      return normalized<int8_t>(data);
    case Scalar::ufixed8:
      return normalized<uint8_t>(data);
    case Scalar::fixed16:
      return normalized<int16_t>(data);
    case Scalar::ufixed16:
      return normalized<uint16_t>(data);
    case Scalar::fixed32:
      return normalized<int32_t>(data);
    case Scalar::ufixed32:
      return normalized<uint32_t>(data);
    case Scalar::fixed64:
      return normalized<int64_t>(data);
    case Scalar::ufixed64:
      return normalized<uint64_t>(data);
    case Scalar::float16:
      return half_at(data);
    case Scalar::float32:
      return double(read<float>(data));
    case Scalar::float64:
      return read<double>(data);
    case Scalar::srgb8:
      break;
  }
  const double x = normalized<uint8_t>(data);
  const bool opacity = (layout.count == 2 || layout.count == 4) && i == layout.count - 1;
  if (opacity) return x;
  static const auto kLight = light_of_bytes(0);
  return double(kLight[size_t(read<uint8_t>(data))]);
}

uint8_t display_byte(double light) {
  static const auto kFirst = light_of_bytes(-0.5f);  // the least light of each byte
  return uint8_t(std::ranges::upper_bound(kFirst.begin() + 1, kFirst.end(), light) -
                 kFirst.begin() - 1);
}

namespace {

// A function on 0 to 1 by its values at equal steps: exact_pow() would take longer than the rest of
// a frame of a million colours.
class Table {
 public:
  explicit Table(double (*function)(double)) {
    for (size_t k = 0; k < values_.size(); ++k) values_[k] = function(double(k) / kSteps);
  }
  double operator()(double x) const {
    const auto step = size_t(x * kSteps);
    return values_[step] + (values_[step + 1] - values_[step]) * (x * kSteps - double(step));
  }

 private:
  static constexpr size_t kSteps = 4096;
  std::array<double, kSteps + 2> values_;
};

// IEC 61966-2-1.
double exact_light(double display) {
  return display > 0.04045 ? core::exact_pow((display + 0.055) / 1.055, 2.4) : display / 12.92;
}
double exact_display(double light) {
  return light > 0.0031308 ? 1.055 * core::exact_pow(light, 1 / 2.4) - 0.055 : light * 12.92;
}

}  // namespace

double light_of_display(double value) {
  static const Table kTable(exact_light);
  return value >= 0 && value <= 1 ? kTable(value) : exact_light(std::max(value, 0.0));
}

double display_of_light(double light) {
  // Of the square root, whose curve is flatter.
  static const Table kTable([](double root) { return exact_display(root * root); });
  return light >= 0 && light <= 1 ? kTable(std::sqrt(light)) : exact_display(std::max(light, 0.0));
}

}  // namespace raio::device
