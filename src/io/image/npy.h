// Arrays of NPY, "A Simple File Format for NumPy Arrays" (NEP 1), version 1.0; NPZ is a zip archive
// of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "io/image/codecs.h"

namespace raio {

/// A file in the making: its first bytes, then what `copy` gives of the numbers from `first` to
/// `end`, which are counted as they lie in the file.
struct NpyArray {
  std::string name, header;
  size_t numbers, number_bytes;
  std::function<void(size_t first, size_t end, uint8_t* out)> copy;

  size_t bytes() const { return header.size() + numbers * number_bytes; }
};

/// `components`: 0 for an array with two dimensions. `type` is NumPy's letter for a kind of number
/// and its bytes.
std::string npy_header(const Image& image, size_t components, std::string_view type);

/// The array "rgba" of a picture.
NpyArray rgba_array(const PictureView& picture);

}  // namespace raio
