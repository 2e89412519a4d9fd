// Encoders and decoders of picture formats, in memory. For image.cpp, which handles files. Callers
// of encoders have checked that the picture has pixels. Bytes to decode are not trusted: sizes are
// compared with the number of bytes before memory is allocated. An error is only the reason.
#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/image/image.h"

namespace raio::core {

template <class T>
using Decoded = std::expected<T, std::string>;

/// The stored name of a setting, in all formats, prefixed to avoid collisions.
inline std::string metadata_name(const std::string& key) { return "raio." + key; }
/// Adds the setting, if the name is that of one.
inline void add_metadata(Metadata& metadata, std::string_view name, std::string_view value) {
  constexpr std::string_view kPrefix = "raio.";
  if (name.starts_with(kPrefix)) metadata.emplace_back(name.substr(kPrefix.size()), value);
}

/// Why a picture of that size is refused, or nothing. More than kMaxPixels indicates a broken file.
inline constexpr long long kMaxPixels = 1LL << 28;
std::string size_problem(long long width, long long height);
/// The maximum number of values, whatever the number of channels.
inline constexpr size_t kMaxNumbers = size_t(1) << 30;

/// A picture to be written, with or without alpha and layers. The caller has checked the sizes.
struct PictureView {
  const Image& color;
  std::span<const float> alpha;
  std::span<const Layer> layers;
  float dpi = 0;
  bool is_straight = false;  // colours are not multiplied by alpha; for PNG

  PictureView(const Image& image) : color(image) {}
  PictureView(const Picture& picture)
      : color(picture.color), alpha(picture.alpha), layers(picture.layers), dpi(picture.dpi) {}
};

/// Stored colours: interleaved 8-bit values, or 16-bit ones, big-endian.
struct PixelRows {
  int width = 0, height = 0;
  int channels = 3;  // or 4, with straight alpha
  int bits = 8;
  std::vector<uint8_t> bytes;
};
/// Maps 0 to the largest integer to 0 to 1; alpha remains straight.
Picture picture_of(const PixelRows& rows);

/// Row y as texels (Scene::texels); 16 bits become 8.
void put_texels(const PixelRows& rows, int y, uint32_t* to);

/// Whether these are the first bytes of a format with display values (sRGB), not light.
bool is_display_format(std::string_view bytes);

/// For PNG and JPEG.
Decoded<PixelRows> decode_rows(std::string_view bytes, bool with_alpha = false);

/// Detects the format by the first bytes.
Decoded<Image> decode_image(std::string_view bytes);
Decoded<Picture> decode_picture(std::string_view bytes);
Decoded<Metadata> decode_metadata(std::string_view bytes);

/// 8-bit RGB, or RGBA with straight alpha; fast, light compression.
Decoded<std::string> encode_png(const PictureView& picture, const Metadata& metadata);
Decoded<Image> decode_png(std::string_view bytes);
Decoded<Picture> decode_png_picture(std::string_view bytes);
Decoded<Metadata> png_metadata(std::string_view bytes);
Decoded<PixelRows> png_rows(std::string_view bytes, bool with_alpha);

/// Grey or colour, baseline or progressive. Damage is an error, not guessed around.
Decoded<PixelRows> jpeg_rows(std::string_view bytes);

/// Why this build has no EXR, or nothing: for checks before long computations.
Decoded<void> check_exr();
/// 32-bit floating-point R, G, B, A and layers, losslessly compressed.
Decoded<std::string> encode_exr(const PictureView& picture, const Metadata& metadata);
/// The data window of the first part.
Decoded<Image> decode_exr(std::string_view bytes);
Decoded<Picture> decode_exr_picture(std::string_view bytes);
Decoded<Metadata> exr_metadata(std::string_view bytes);

/// A zip archive of arrays, each an NPY; fast, light compression.
Decoded<std::string> encode_npz(const PictureView& picture);
/// Version 1.0.
std::string encode_npy(const PictureView& picture);

/// P6 with 8 bits per channel.
std::string encode_ppm(const Image& image);
/// P2, P3, P5 and P6, up to 16 bits per channel.
Decoded<Image> decode_ppm(std::string_view bytes);

/// Little-endian PF.
std::string encode_pfm(const Image& image);
/// PF and Pf of either byte order. The magnitude of the scale, a unit of light, is ignored.
Decoded<Image> decode_pfm(std::string_view bytes);

/// Radiance RGBE, flat or with runs of components, rows from top to bottom, divided by EXPOSURE.
Decoded<Image> decode_hdr(std::string_view bytes);

}  // namespace raio::core
