#include "io/image/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>

#include "io/image/codecs.h"

namespace raio {

namespace {

namespace fs = std::filesystem;

/// Enough for the largest picture in the most spacious format, P3 with four characters a value.
constexpr size_t kMaxFileBytes = size_t(1) << 32;

std::expected<std::string, std::string> encode(const Image& image, ImageFormat format,
                                               const Metadata& metadata) {
  switch (format) {
    case ImageFormat::png:
      return encode_png(image, metadata);
    case ImageFormat::exr:
      return encode_exr(image, metadata);
    case ImageFormat::pfm:
      return encode_pfm(image);
    case ImageFormat::ppm:
      return encode_ppm(image);
  }
  std::abort();
}

constexpr std::string_view kPngBegin = "\x89PNG\r\n\x1a\n", kExrBegin = "\x76\x2f\x31\x01";

/// Why the picture cannot be written in any format, or nothing.
std::string problem(const Image& image, const Metadata& metadata) {
  if (image.width < 1 || image.height < 1 ||
      image.pixels.size() != size_t(image.width) * size_t(image.height))
    return fmt::format("no picture has {} x {} pixels, {} of them there", image.width, image.height,
                       image.pixels.size());
  for (const auto& [key, value] : metadata) {
    // PNG's names have at most 79 characters.
    const bool plain = std::ranges::all_of(key, [](char c) { return c > ' ' && c <= '~'; });
    if (!plain || key.empty() || metadata_name(key).size() > 79)
      return fmt::format("\"{}\" cannot be the name of a setting", key);
  }
  return {};
}

std::array<int, 3> display_bytes(const Rgb& c) {
  return {to_byte(c.x), to_byte(c.y), to_byte(c.z)};
}

void require_same_size(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw std::invalid_argument(fmt::format("pictures of {} x {} and {} x {} do not compare",
                                            a.width, a.height, b.width, b.height));
}

}  // namespace

Decoded<Image> decode_image(std::string_view bytes) {
  if (bytes.starts_with(kPngBegin)) return decode_png(bytes);
  if (bytes.starts_with(kExrBegin)) return decode_exr(bytes);
  if (bytes.starts_with("PF") || bytes.starts_with("Pf")) return decode_pfm(bytes);
  for (const std::string_view magic : {"P2", "P3", "P5", "P6"})
    if (bytes.starts_with(magic)) return decode_ppm(bytes);
  return std::unexpected(bytes.empty() ? "the file is empty"
                                       : "it is no picture in PNG, EXR, PFM or PPM format");
}

Decoded<Metadata> decode_metadata(std::string_view bytes) {
  if (bytes.starts_with(kPngBegin)) return png_metadata(bytes);
  if (bytes.starts_with(kExrBegin)) return exr_metadata(bytes);
  return std::unexpected("only pictures in PNG and EXR format keep settings");
}

std::string size_problem(long long width, long long height) {
  if (width < 1 || height < 1) return fmt::format("a size of {} x {} pixels", width, height);
  if (width > kMaxPixels || height > kMaxPixels / width)
    return fmt::format("{} x {} are more than {} pixels", width, height, kMaxPixels);
  return {};
}

std::expected<ImageFormat, FileError> image_format(const fs::path& path) {
  const std::string suffix = lower_suffix(path);
  if (suffix == ".png") return ImageFormat::png;
  if (suffix == ".exr") return ImageFormat::exr;
  if (suffix == ".pfm") return ImageFormat::pfm;
  if (suffix == ".ppm") return ImageFormat::ppm;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (is_standard_output(path) || (fs::exists(status) && !fs::is_regular_file(status)))
    return ImageFormat::png;
  return std::unexpected(FileError{
      FileError::bad_input,
      write_error(path, "the name of a picture ends in .png, .exr, .pfm or .ppm").message});
}

std::expected<void, FileError> write_image(const Image& image, const fs::path& path,
                                           const Metadata& metadata) try {
  const auto format = image_format(path);
  if (!format) return std::unexpected(format.error());
  if (const std::string why = problem(image, metadata); !why.empty())
    return std::unexpected(FileError{FileError::bad_input, write_error(path, why).message});
  const auto bytes = encode(image, *format, metadata);
  if (!bytes) return std::unexpected(write_error(path, bytes.error()));
  return write_file(path, *bytes);
} catch (const std::bad_alloc&) {
  return std::unexpected(write_error(path, "not enough memory"));
}

std::expected<Image, FileError> read_image(const fs::path& path) try {
  const auto bytes = read_file(path, kMaxFileBytes);
  if (!bytes) return std::unexpected(bytes.error());
  auto image = decode_image(*bytes);
  if (!image) return std::unexpected(read_error(path, image.error()));
  return std::move(*image);
} catch (const std::bad_alloc&) {
  return std::unexpected(read_error(path, "not enough memory"));
}

std::expected<Metadata, FileError> read_metadata(const fs::path& path) try {
  const auto bytes = read_file(path, kMaxFileBytes);
  if (!bytes) return std::unexpected(bytes.error());
  auto metadata = decode_metadata(*bytes);
  if (!metadata) return std::unexpected(read_error(path, metadata.error()));
  return std::move(*metadata);
} catch (const std::bad_alloc&) {
  return std::unexpected(read_error(path, "not enough memory"));
}

ImageDifference compare(const Image& a, const Image& b) {
  require_same_size(a, b);
  ImageDifference difference;
  uint64_t squares = 0, above_8 = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const auto bytes_a = display_bytes(a.pixels[i]), bytes_b = display_bytes(b.pixels[i]);
    int largest = 0;
    for (int channel = 0; channel < 3; ++channel) {
      const int apart = std::abs(bytes_a[channel] - bytes_b[channel]);
      squares += uint64_t(apart * apart);
      largest = std::max(largest, apart);
    }
    above_8 += largest > 8;
    difference.largest = std::max(difference.largest, largest);
  }
  const double pixels = double(std::max<size_t>(a.pixels.size(), 1));
  difference.rmse = std::sqrt(double(squares) / (3 * pixels));
  difference.psnr_db = squares == 0 ? std::numeric_limits<double>::infinity()
                                    : 20 * std::log10(255 / difference.rmse);
  difference.above_8 = double(above_8) / pixels;
  return difference;
}

Image difference_image(const Image& a, const Image& b) {
  require_same_size(a, b);
  constexpr float kFaint = 0.2f;
  Image picture(a.width, a.height);
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const auto from = display_bytes(a.pixels[i]), to = display_bytes(b.pixels[i]);
    // Luma with the weights of ITU-R BT.709.
    const float grey =
        0.2126f * float(from[0]) + 0.7152f * float(from[1]) + 0.0722f * float(from[2]);
    for (int channel = 0; channel < 3; ++channel) {
      const int apart = std::abs(from[channel] - to[channel]);
      picture.pixels[i][channel] = (kFaint * grey + 8 * float(apart)) / 255;
    }
  }
  return picture;
}

}  // namespace raio
