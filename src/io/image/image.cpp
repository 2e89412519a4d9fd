#include "io/image/image.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>

#include "base/exact_math.h"
#include "base/executor.h"
#include "io/image/codecs.h"

namespace raio::core {

namespace {

namespace fs = std::filesystem;

/// Enough for the largest picture in the largest format, P3 with four characters per value.
constexpr uint64_t kMaxFileBytes = uint64_t(1) << 32;

Decoded<std::string> encode(const PictureView& picture, ImageFormat format,
                            const Metadata& metadata) {
  switch (format) {
    case ImageFormat::png:
      return encode_png(picture, metadata);
    case ImageFormat::exr:
      return encode_exr(picture, metadata);
    case ImageFormat::pfm:
      return encode_pfm(picture.color);
    case ImageFormat::ppm:
      return encode_ppm(picture.color);
    case ImageFormat::npz:
      return encode_npz(picture);
    case ImageFormat::npy:
      return encode_npy(picture);
  }
  std::abort();
}

constexpr std::string_view kPngBegin = "\x89PNG\r\n\x1a\n", kExrBegin = "\x76\x2f\x31\x01",
                           kJpegBegin = "\xff\xd8\xff";

bool is_ppm(std::string_view bytes) {
  return std::ranges::any_of(std::array{"P2", "P3", "P5", "P6"},
                             [&](std::string_view magic) { return bytes.starts_with(magic); });
}

bool is_plain(std::string_view word) {
  return std::ranges::all_of(word, [](char c) { return c > ' ' && c <= '~'; });
}

/// A name that occurs twice.
std::optional<std::string> doubled(std::vector<std::string> names) {
  std::ranges::sort(names);
  const auto found = std::ranges::adjacent_find(names);
  return found == names.end() ? std::nullopt : std::optional(*found);
}

/// Whether an EXR channel can have the layer's name alone, without a dot and a component.
bool can_stand_alone(std::string_view name) {
  return !name.contains('.') && name != "R" && name != "G" && name != "B" && name != "A";
}

/// Why the layer cannot be written with a picture of `pixels` pixels, or nothing.
std::string layer_problem(const Layer& layer, size_t pixels) {
  constexpr size_t kLongest = 200;  // EXR's names of channels have at most 255 characters
  if (layer.name.empty() || layer.name.size() > kLongest || !is_plain(layer.name) ||
      layer.name.find_first_of("/\\") != std::string::npos)
    return fmt::format("\"{}\" cannot be the name of a layer", layer.name);
  for (const std::string& component : layer.components)
    if (component.size() > 50 || !is_plain(component) || component.contains('.') ||
        (component.empty() && !can_stand_alone(layer.name)))
      return fmt::format("\"{}\" cannot be a component of the layer {}", component, layer.name);
  if (const auto component = doubled(layer.components))
    return fmt::format("the layer {} has two components \"{}\"", layer.name, *component);
  const size_t numbers = std::visit([](const auto& v) { return v.size(); }, layer.values);
  if (layer.components.empty() || numbers != pixels * layer.components.size())
    return fmt::format("the layer {} has {} numbers, not {} components of {} pixels", layer.name,
                       numbers, layer.components.size(), pixels);
  return {};
}

std::vector<std::string> names_of(std::span<const Layer> layers) {
  std::vector<std::string> names;
  for (const Layer& layer : layers) names.push_back(layer.name);
  return names;
}

/// Why the picture cannot be written in any format, or nothing.
std::string problem(const PictureView& picture, const Metadata& metadata) {
  const Image& image = picture.color;
  const size_t pixels = image.pixels.size();
  if (image.width < 1 || image.height < 1 || pixels != size_t(image.width) * size_t(image.height))
    return fmt::format("a picture of {} x {} pixels with {} pixels of data is invalid", image.width,
                       image.height, pixels);
  if (!picture.alpha.empty() && picture.alpha.size() != pixels)
    return fmt::format("alpha of {} pixels does not fit {} pixels", picture.alpha.size(), pixels);
  for (const Layer& layer : picture.layers)
    if (std::string wrong = layer_problem(layer, pixels); !wrong.empty()) return wrong;
  if (const auto name = doubled(names_of(picture.layers)))
    return fmt::format("two layers are called {}", *name);
  for (const auto& [key, value] : metadata)
    // PNG's names have at most 79 characters.
    if (key.empty() || !is_plain(key) || metadata_name(key).size() > 79)
      return fmt::format("\"{}\" cannot be the name of a setting", key);
  return {};
}

std::expected<std::string, Error> checked_bytes(const PictureView& picture, const fs::path& path,
                                                const Metadata& metadata) try {
  const auto refused = [&](std::string_view why) {
    return std::unexpected(Error{ErrorKind::bad_input, path.string(), std::string(why)});
  };
  const auto format = image_format(path);
  if (!format) return std::unexpected(format.error());
  if (const std::string why = problem(picture, metadata); !why.empty()) return refused(why);
  const std::string lost = unkept(*format, !picture.alpha.empty(), names_of(picture.layers));
  if (!lost.empty()) return refused(lost);
  auto bytes = encode(picture, *format, metadata);
  if (!bytes) return std::unexpected(write_error(path, bytes.error()));
  return *std::move(bytes);
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

std::expected<void, Error> write(const PictureView& picture, const fs::path& path,
                                 const Metadata& metadata) {
  const auto bytes = checked_bytes(picture, path, metadata);
  if (!bytes) return std::unexpected(bytes.error());
  return write_file(path, *bytes);
}

/// Decodes the bytes of a file.
template <class T>
std::expected<T, Error> read(const fs::path& path, Decoded<T> (*decode)(std::string_view)) try {
  const auto bytes = read_file(path, kMaxFileBytes);
  if (!bytes) return std::unexpected(bytes.error());
  auto decoded = decode(*bytes);
  if (!decoded) return std::unexpected(read_error(path, decoded.error()));
  return std::move(*decoded);
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

void require_same_size(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height)
    throw std::invalid_argument(
        fmt::format("pictures of {} x {} and {} x {} pixels cannot be compared", a.width, a.height,
                    b.width, b.height));
}

}  // namespace

Picture picture_of(const PixelRows& rows) {
  Picture picture;
  picture.color = Image(rows.width, rows.height);
  if (rows.channels == 4) picture.alpha.resize(picture.color.pixels.size());
  const uint8_t* p = rows.bytes.data();
  const auto next = [&] {
    if (rows.bits != 16) return float(*p++) / 255;
    p += 2;
    return float(p[-2] << 8 | p[-1]) / 65535;
  };
  for (size_t i = 0; i < picture.color.pixels.size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) picture.color.pixels[i][channel] = next();
    if (rows.channels == 4) picture.alpha[i] = next();
  }
  return picture;
}

void put_texels(const PixelRows& rows, int y, uint32_t* to) {
  const size_t step = size_t(rows.bits) / 8, pixel = step * size_t(rows.channels);
  const uint8_t* from = rows.bytes.data() + size_t(y) * size_t(rows.width) * pixel;
  const auto value = [&](size_t channel) {
    const uint8_t* const at = from + channel * step;
    return step == 1 ? *at : (uint32_t(at[0] << 8 | at[1]) + 128) / 257;
  };
  const bool has_alpha = rows.channels == 4;
  for (int x = 0; x < rows.width; ++x, from += pixel)
    to[x] = value(0) | value(1) << 8 | value(2) << 16 | (has_alpha ? 255 - value(3) : 0u) << 24;
}

bool is_display_format(std::string_view bytes) {
  return bytes.starts_with(kPngBegin) || bytes.starts_with(kJpegBegin) || is_ppm(bytes);
}

Decoded<PixelRows> decode_rows(std::string_view bytes, bool with_alpha) {
  if (bytes.starts_with(kPngBegin)) return png_rows(bytes, with_alpha);
  if (bytes.starts_with(kJpegBegin)) return jpeg_rows(bytes);
  return std::unexpected(bytes.empty() ? "the file is empty" : "expected a PNG or JPEG picture");
}

Decoded<Image> decode_image(std::string_view bytes) {
  if (bytes.starts_with(kPngBegin)) return decode_png(bytes);
  if (bytes.starts_with(kJpegBegin)) {
    const auto rows = jpeg_rows(bytes);
    if (!rows) return std::unexpected(rows.error());
    return picture_of(*rows).color;
  }
  if (bytes.starts_with(kExrBegin)) return decode_exr(bytes);
  if (bytes.starts_with("PF") || bytes.starts_with("Pf")) return decode_pfm(bytes);
  if (bytes.starts_with("#?")) return decode_hdr(bytes);
  if (is_ppm(bytes)) return decode_ppm(bytes);
  return std::unexpected(bytes.empty() ? "the file is empty"
                                       : "expected a PNG, JPEG, EXR, HDR, PFM or PPM picture");
}

Decoded<Picture> decode_picture(std::string_view bytes) {
  if (bytes.starts_with(kPngBegin)) return decode_png_picture(bytes);
  if (bytes.starts_with(kExrBegin)) return decode_exr_picture(bytes);
  auto image = decode_image(bytes);
  if (!image) return std::unexpected(image.error());
  return Picture{std::move(*image), {}, {}};
}

Decoded<Metadata> decode_metadata(std::string_view bytes) {
  if (bytes.starts_with(kPngBegin)) return png_metadata(bytes);
  if (bytes.starts_with(kExrBegin)) return exr_metadata(bytes);
  return std::unexpected("only PNG and EXR pictures store settings");
}

std::string size_problem(long long width, long long height) {
  if (width < 1 || height < 1)
    return fmt::format("an invalid size of {} x {} pixels", width, height);
  if (width > kMaxPixels || height > kMaxPixels / width)
    return fmt::format("{} x {} are more than {} pixels", width, height, kMaxPixels);
  return {};
}

std::expected<ImageFormat, Error> image_format(const fs::path& path) {
  const std::string suffix = lower_suffix(path);
  if (suffix == ".png") return ImageFormat::png;
  if (suffix == ".exr") {
    if (const auto possible = check_exr(); !possible)
      return std::unexpected(Error{ErrorKind::no_resource, path.string(), possible.error()});
    return ImageFormat::exr;
  }
  if (suffix == ".pfm") return ImageFormat::pfm;
  if (suffix == ".ppm") return ImageFormat::ppm;
  if (suffix == ".npz") return ImageFormat::npz;
  if (suffix == ".npy") return ImageFormat::npy;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (is_standard_output(path) || (fs::exists(status) && !fs::is_regular_file(status)))
    return ImageFormat::png;
  return std::unexpected(
      Error{ErrorKind::bad_input, path.string(),
            "expected a name that ends in .png, .exr, .pfm, .ppm, .npz or .npy"});
}

std::string unkept(ImageFormat format, bool alpha, std::span<const std::string> layers) {
  std::vector<std::string> lost(layers.begin(), layers.end());
  if (format == ImageFormat::exr) return {};
  if (format == ImageFormat::npz) {
    if (std::ranges::find(lost, "rgba") == lost.end()) return {};
    return "NPZ uses the name rgba for colours; rename the layer";
  }
  const bool keeps_alpha = format == ImageFormat::png || format == ImageFormat::npy;
  const bool layered = !lost.empty();
  if (alpha && !keeps_alpha) lost.insert(lost.begin(), "alpha");
  if (lost.empty()) return {};
  constexpr std::array kNames = {"PNG", "EXR", "PFM", "PPM", "NPZ", "NPY"};
  return fmt::format("{} stores only {}, not {}; choose a name that ends in {}",
                     kNames[int(format)], keeps_alpha ? "colours and alpha" : "colours",
                     fmt::join(lost, ", "), layered ? ".exr or .npz" : ".png, .exr, .npz or .npy");
}

std::expected<void, Error> write_image(const Image& image, const fs::path& path,
                                       const Metadata& metadata) {
  return write(image, path, metadata);
}

std::expected<void, Error> write_image(const Picture& picture, const fs::path& path,
                                       const Metadata& metadata) {
  return write(picture, path, metadata);
}

std::expected<std::string, Error> encode_image(const Picture& picture, const fs::path& name,
                                               const Metadata& metadata) {
  return checked_bytes(picture, name, metadata);
}

std::expected<Image, Error> read_image(const fs::path& path) { return read(path, decode_image); }

std::expected<Picture, Error> read_picture(const fs::path& path) {
  return read(path, decode_picture);
}

std::expected<Metadata, Error> read_metadata(const fs::path& path) {
  return read(path, decode_metadata);
}

std::array<int, 3> display_bytes(const Rgb& color) {
  return {to_byte(color.x), to_byte(color.y), to_byte(color.z)};
}

ImageDifference compare(const Image& a, const Image& b) {
  require_same_size(a, b);
  ImageDifference difference;
  uint64_t squares = 0, above_8 = 0;
  StopCheck look;
  for (size_t i = 0; i < a.pixels.size(); ++i, look()) {
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
                                    : 20 * exact_log10(255 / difference.rmse);
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

}  // namespace raio::core
