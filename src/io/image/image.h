// Pictures in memory and in files: colours, alpha, and named layers of numbers.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/memory.h"
#include "base/vec.h"
#include "io/file.h"

namespace raio::core {

/// Rows from top to bottom, pixels from left to right, linear display values: 1 is white. Not
/// clamped.
struct Image {
  int width = 0, height = 0;
  Column<Rgb> pixels;  // width * height

  Image() = default;
  Image(int w, int h) : width(w), height(h), pixels(size_t(w) * h, Rgb()) {}
  Rgb& at(int x, int y) { return pixels[size_t(y) * width + x]; }
  const Rgb& at(int x, int y) const { return pixels[size_t(y) * width + x]; }
};

/// A named array in addition to the colours: `components.size()` interleaved numbers per pixel, row
/// by row.
struct Layer {
  /// "depth", "normal": the array's name in .npz, the layer's in EXR. Printable ASCII without
  /// blanks and slashes.
  std::string name;
  /// EXR channel names after the dot, {"Z"}, {"X", "Y", "Z"} or {"R", "G", "B"}; an empty one is a
  /// channel with the layer's name alone.
  std::vector<std::string> components;
  std::variant<Column<float>, Column<uint32_t>> values;

  bool operator==(const Layer&) const = default;
};

/// The suffix of a layer with the rounding errors of another one's floats; the numbers are the sums
/// of both: "position_low" of "position".
inline constexpr std::string_view kLowLayer = "_low";

/// A resolved film. With alpha, colours are premultiplied: a pixel half covered by white is 0.5.
struct Picture {
  Image color;
  Column<float> alpha;  // one number per pixel, 1 is opaque; empty: no alpha
  std::vector<Layer> layers;
  float dpi = 0;  // pixels per inch, if it has a print size
};

/// 0..1 to 0..255, clamped and rounded to nearest; NaN gives 0.
inline uint8_t to_byte(float value) {
  const float clamped = value > 0 ? std::min(value, 1.0f) : 0;
  return uint8_t(int(double(clamped) * 255 + 0.5));
}

enum class ImageFormat { png, exr, pfm, ppm, npz, npy };

/// By suffix, in any case; the error lists the suffixes. "-" and existing targets other than
/// regular files (devices, pipes) are PNG if they have no suffix.
std::expected<ImageFormat, Error> image_format(const std::filesystem::path& path);

/// What a format cannot store of such a picture, and which formats can, as one line; empty if it
/// can store everything. write_image refuses such a picture; check before long computations.
std::string unkept(ImageFormat format, bool alpha, std::span<const std::string> layers);

/// Settings stored with the picture if the format can, key KEY under the name raio.KEY: string
/// attributes of EXR, texts of PNG (tEXt, iTXt if not ASCII). Keys are plain words of at most 74
/// characters.
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Writes a picture whole or not at all (see write_file), PNG and PPM with to_byte, EXR and PFM
/// unchanged. "-" is standard output. A picture without pixels and an unknown suffix are bad_input.
std::expected<void, Error> write_image(const Image& image, const std::filesystem::path& path,
                                       const Metadata& metadata = {});

/// The same with alpha and layers; anything that the format cannot store (`unkept`) is bad_input,
/// too. PNG gets straight alpha, and colours of 0 where nothing is covered. EXR gets premultiplied
/// R, G, B and A and a channel LAYER.COMPONENT, FLOAT or UINT, for each component of a layer. NPZ
/// gets an array "rgba" (height, width, 4), premultiplied, alpha 1 by default, and one of (height,
/// width) or (height, width, components) for each layer, float32 or uint32, or float64 if its
/// rounding errors are a layer, too (kLowLayer); NPY is "rgba" alone.
std::expected<void, Error> write_image(const Picture& picture, const std::filesystem::path& path,
                                       const Metadata& metadata = {});

/// The bytes that write_image() would write to a file of this name.
std::expected<std::string, Error> encode_image(const Picture& picture,
                                               const std::filesystem::path& name,
                                               const Metadata& metadata = {});

/// Reads PNG (alpha dropped, grey expanded), JPEG, EXR (R, G, B or Y; the data window of the first
/// part; colours as stored, premultiplied if there is alpha), Radiance HDR (RGBE), PFM (PF and Pf)
/// and PPM (P2, P3, P5, P6), up to 2^28 pixels. The first bytes determine the format, not the
/// suffix; 0 to the format's largest integer becomes 0 to 1. The file is not trusted.
std::expected<Image, Error> read_image(const std::filesystem::path& path);

/// Reads the formats of read_image completely: alpha of PNG, with colours then premultiplied, alpha
/// and layers of EXR. A layer consists of the channels of one number type with the same name up to
/// the last dot, in the order R, G, B, A, others by name; HALF becomes float. A channel without a
/// dot is a layer with one component, which is empty. Layers are ordered by name, float before
/// uint32. The file is not trusted; at most 2^30 numbers are read.
std::expected<Picture, Error> read_picture(const std::filesystem::path& path);

/// The settings that write_image stored in a PNG or EXR, in no particular order; none from other
/// pictures. The file is not trusted.
std::expected<Metadata, Error> read_metadata(const std::filesystem::path& path);

/// A pixel as displayed: 0 to 255 each.
std::array<int, 3> display_bytes(const Rgb& color);

/// The difference of two pictures, over all channels of all pixels as displayed (8 bits).
struct ImageDifference {
  double rmse = 0;     // of 0..255 values
  double psnr_db = 0;  // infinity for equal pictures
  int largest = 0;     // 0..255
  double above_8 = 0;  // fraction of pixels with a channel that differs by more than 8
};

/// The pictures must have the same size; otherwise std::invalid_argument is thrown, here and below.
ImageDifference compare(const Image& a, const Image& b);

/// A picture of the differences: |a - b| times eight over a faint grey of `a`.
Image difference_image(const Image& a, const Image& b);

}  // namespace raio::core
