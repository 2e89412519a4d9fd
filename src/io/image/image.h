// Pictures in memory and in files: colours, alpha, and named layers of numbers beside them.
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

namespace raio {

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

/// One named array beside the colours: `components.size()` interleaved numbers a pixel, row by row.
struct Layer {
  /// "depth", "normal": the array's name in .npz, the layer's in EXR. Printable ASCII without
  /// blanks and slashes.
  std::string name;
  /// EXR channel names after the dot, {"Z"}, {"X", "Y", "Z"} or {"R", "G", "B"}; an empty one is a
  /// channel that has the layer's name alone.
  std::vector<std::string> components;
  std::variant<Column<float>, Column<uint32_t>> values;

  bool operator==(const Layer&) const = default;
};

/// The end of the name of a layer that has what the floats of another leave of its numbers, which
/// are the sums of both: "position_low" of "position".
inline constexpr std::string_view kLowLayer = "_low";

/// What a film resolves to. Colours are premultiplied where there is alpha: of a pixel half covered
/// by white they are 0.5.
struct Picture {
  Image color;
  Column<float> alpha;  // a number a pixel, 1 is opaque; empty: there is none
  std::vector<Layer> layers;
  float dpi = 0;  // pixels per inch, where it has a size in print
};

/// 0..1 to 0..255, clamped and rounded to nearest; NaN gives 0.
inline uint8_t to_byte(float value) {
  const float clamped = value > 0 ? std::min(value, 1.0f) : 0;
  return uint8_t(int(double(clamped) * 255 + 0.5));
}

enum class ImageFormat { png, exr, pfm, ppm, npz, npy };

/// By suffix, in any case; an error that lists the suffixes otherwise. "-" and targets that exist
/// and are no regular files (devices, pipes) are PNG when they have no suffix.
std::expected<ImageFormat, Error> image_format(const std::filesystem::path& path);

/// What a format cannot keep of a picture with these, and which formats can, as one line; empty
/// when it keeps all. write_image refuses such a picture; whoever computes long asks before.
std::string unkept(ImageFormat format, bool alpha, std::span<const std::string> layers);

/// Settings kept with the picture where the format can, key KEY under the name raio.KEY: string
/// attributes of EXR, texts of PNG (tEXt, iTXt if not ASCII). Keys are plain words of at most 74
/// characters.
using Metadata = std::vector<std::pair<std::string, std::string>>;

/// Writes a picture whole or not at all (see write_file), PNG and PPM as to_byte gives it, EXR and
/// PFM as it is. "-" is standard output. A picture without pixels and an unknown suffix are
/// bad_input.
std::expected<void, Error> write_image(const Image& image, const std::filesystem::path& path,
                                       const Metadata& metadata = {});

/// The same with alpha and layers; what the format cannot keep (`unkept`) is bad_input, too. PNG
/// gets straight alpha, and colours of 0 where nothing is covered. EXR gets premultiplied R, G, B
/// and A and a channel LAYER.COMPONENT, FLOAT or UINT, for each component of a layer. NPZ gets an
/// array "rgba" (height, width, 4), premultiplied, alpha 1 where there is none, and one of (height,
/// width) or (height, width, components) for each layer, float32 or uint32, or float64 for one
/// whose rest is a layer, too (kLowLayer); NPY is "rgba" alone.
std::expected<void, Error> write_image(const Picture& picture, const std::filesystem::path& path,
                                       const Metadata& metadata = {});

/// Reads PNG (alpha dropped, grey widened), JPEG, EXR (R, G, B or Y; the data window of the first
/// part; colours as they are stored, premultiplied where there is alpha), PFM (PF and Pf) and PPM
/// (P2, P3, P5, P6), up to 2^28 pixels. The format is told by the file's first bytes, not by its
/// suffix; 0 to the format's largest integer is read as 0 to 1. The file need not be trusted.
std::expected<Image, Error> read_image(const std::filesystem::path& path);

/// Reads what read_image reads with all there is: alpha of PNG, by which the colours are then
/// multiplied, alpha and layers of EXR. A layer has the channels of one kind of number whose names
/// are the same up to the last dot, in the order R, G, B, A, others by name; HALF becomes float. A
/// channel without a dot is a layer with one component, which is empty. Layers are in order of
/// their names, float before uint32. The file need not be trusted; at most 2^30 numbers are read.
std::expected<Picture, Error> read_picture(const std::filesystem::path& path);

/// The settings that write_image put into a PNG or EXR, in no particular order; none from other
/// pictures. The file need not be trusted.
std::expected<Metadata, Error> read_metadata(const std::filesystem::path& path);

/// A pixel as it is displayed: 0 to 255 each.
std::array<int, 3> display_bytes(const Rgb& color);

/// How far apart two pictures are, over all channels of all pixels as they would be displayed (8
/// bits).
struct ImageDifference {
  double rmse = 0;     // of 0..255 values
  double psnr_db = 0;  // infinity for equal pictures
  int largest = 0;     // 0..255
  double above_8 = 0;  // share of pixels with a channel more than 8 apart
};

/// The pictures must have the same size; std::invalid_argument is thrown otherwise, here and below.
ImageDifference compare(const Image& a, const Image& b);

/// A picture of where two pictures differ: |a - b| times eight over a faint grey of `a`.
Image difference_image(const Image& a, const Image& b);

}  // namespace raio
