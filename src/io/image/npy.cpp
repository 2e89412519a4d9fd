#include "io/image/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace raio {

std::string npy_header(const Image& image, size_t components, std::string_view type) {
  constexpr char kByteOrder = std::endian::native == std::endian::little ? '<' : '>';
  const std::string third = components > 0 ? fmt::format(", {}", components) : "";
  std::string text =
      fmt::format("{{'descr': '{}{}', 'fortran_order': False, 'shape': ({}, {}{}), }}", kByteOrder,
                  type, image.height, image.width, third);
  // The numbers begin at a multiple of 64 bytes. A size of 16 bits, little-endian, precedes the
  // text.
  constexpr size_t kBefore = 10, kAligned = 64;
  const size_t whole = (kBefore + text.size() + 1 + kAligned - 1) / kAligned * kAligned;
  text.resize(whole - kBefore - 1, ' ');
  text += '\n';
  return std::string("\x93NUMPY\x01\0", 8) + char(text.size() & 255) + char(text.size() >> 8) +
         text;
}

NpyArray rgba_array(const PictureView& picture) {
  constexpr size_t kComponents = 4;
  const Image& image = picture.color;
  const auto copy = [&image, alpha = picture.alpha](size_t first, size_t end, uint8_t* out) {
    for (size_t i = first / kComponents; i < end / kComponents; ++i) {
      const Rgb& c = image.pixels[i];
      const float rgba[] = {c.x, c.y, c.z, alpha.empty() ? 1 : alpha[i]};
      out = std::copy_n(reinterpret_cast<const uint8_t*>(rgba), sizeof rgba, out);
    }
  };
  return {"rgba", npy_header(image, kComponents, "f4"), kComponents * image.pixels.size(),
          sizeof(float), copy};
}

std::string encode_npy(const PictureView& picture) {
  const NpyArray array = rgba_array(picture);
  std::string bytes = array.header;
  bytes.resize(array.bytes());
  array.copy(0, array.numbers, reinterpret_cast<uint8_t*>(bytes.data() + array.header.size()));
  return bytes;
}

}  // namespace raio
