// Pictures to bytes and back, one pair of functions per format, all in memory. For image.cpp, which
// knows the files. Whoever writes has checked that the picture has pixels; bytes to read are not
// trusted: sizes are held against the number of bytes there are before memory is asked for. An
// error is the reason alone.
#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/image/image.h"

namespace raio {

template <class T>
using Decoded = std::expected<T, std::string>;

/// Under which name a setting is kept, in all formats, so that none collides with the format's own.
inline std::string metadata_name(const std::string& key) { return "raio." + key; }
/// The setting of that name, if the name is one of a setting.
inline void add_metadata(Metadata& metadata, std::string_view name, std::string_view value) {
  constexpr std::string_view kPrefix = "raio.";
  if (name.starts_with(kPrefix)) metadata.emplace_back(name.substr(kPrefix.size()), value);
}

/// Why a picture of that size is not read, or nothing. Larger than kMaxPixels is taken for a broken
/// file.
inline constexpr long long kMaxPixels = 1LL << 28;
std::string size_problem(long long width, long long height);
/// Nor are more numbers, whatever the number of channels.
inline constexpr size_t kMaxNumbers = size_t(1) << 30;

/// What is to be written, of a picture with or without alpha and layers. Whoever writes has checked
/// that their sizes are right.
struct PictureView {
  const Image& color;
  std::span<const float> alpha;
  std::span<const Layer> layers;
  float dpi = 0;

  PictureView(const Image& image) : color(image) {}
  PictureView(const Picture& picture)
      : color(picture.color), alpha(picture.alpha), layers(picture.layers), dpi(picture.dpi) {}
};

/// Colours as they are stored: interleaved values of 8 bits, or of 16 with the higher byte first.
struct PixelRows {
  int width = 0, height = 0;
  int channels = 3;  // or 4, with straight alpha
  int bits = 8;
  std::vector<uint8_t> bytes;
};
/// 0 to the largest integer becomes 0 to 1; alpha remains straight.
Picture picture_of(const PixelRows& rows);

/// Row y as texels 0xBBGGRR, without alpha; 16 bits become 8.
void put_texels(const PixelRows& rows, int y, uint32_t* to);

/// Of PNG and JPEG, without alpha.
Decoded<PixelRows> decode_rows(std::string_view bytes);

/// Whatever format the first bytes tell.
Decoded<Image> decode_image(std::string_view bytes);
Decoded<Picture> decode_picture(std::string_view bytes);
Decoded<Metadata> decode_metadata(std::string_view bytes);

/// 8 bit RGB, or RGBA with straight alpha, little compressed but quickly.
Decoded<std::string> encode_png(const PictureView& picture, const Metadata& metadata);
Decoded<Image> decode_png(std::string_view bytes);
Decoded<Picture> decode_png_picture(std::string_view bytes);
Decoded<Metadata> png_metadata(std::string_view bytes);
Decoded<PixelRows> png_rows(std::string_view bytes, bool with_alpha);

/// Grey or colour, baseline or progressive. What is damaged is an error, not a guess.
Decoded<PixelRows> jpeg_rows(std::string_view bytes);

/// 32 bit floating point R, G, B, A and layers, losslessly compressed.
Decoded<std::string> encode_exr(const PictureView& picture, const Metadata& metadata);
/// The data window of the first part.
Decoded<Image> decode_exr(std::string_view bytes);
Decoded<Picture> decode_exr_picture(std::string_view bytes);
Decoded<Metadata> exr_metadata(std::string_view bytes);

/// A zip archive of arrays, each an NPY, little compressed but quickly.
Decoded<std::string> encode_npz(const PictureView& picture);
/// Version 1.0.
std::string encode_npy(const PictureView& picture);

/// P6 with 8 bits a channel.
std::string encode_ppm(const Image& image);
/// P2, P3, P5 and P6, up to 16 bits a channel.
Decoded<Image> decode_ppm(std::string_view bytes);

/// Little-endian PF.
std::string encode_pfm(const Image& image);
/// PF and Pf of either byte order. The magnitude of the scale, a unit of light, is not applied.
Decoded<Image> decode_pfm(std::string_view bytes);

}  // namespace raio
