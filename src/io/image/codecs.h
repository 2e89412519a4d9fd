// Pictures to bytes and back, one pair of functions per format, all in memory. For image.cpp, which
// knows the files. Whoever writes has checked that the picture has pixels; bytes to read are not
// trusted: sizes are held against the number of bytes there are before memory is asked for. An
// error is the reason alone.
#pragma once

#include <expected>
#include <string>
#include <string_view>

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

/// Whatever format the first bytes tell.
Decoded<Image> decode_image(std::string_view bytes);
Decoded<Metadata> decode_metadata(std::string_view bytes);

/// 8 bit RGB, little compressed but quickly.
Decoded<std::string> encode_png(const Image& image, const Metadata& metadata);
Decoded<Image> decode_png(std::string_view bytes);
Decoded<Metadata> png_metadata(std::string_view bytes);

/// 32 bit floating point R, G, B, losslessly compressed.
Decoded<std::string> encode_exr(const Image& image, const Metadata& metadata);
/// The data window of the first part.
Decoded<Image> decode_exr(std::string_view bytes);
Decoded<Metadata> exr_metadata(std::string_view bytes);

/// P6 with 8 bits a channel.
std::string encode_ppm(const Image& image);
/// P2, P3, P5 and P6, up to 16 bits a channel.
Decoded<Image> decode_ppm(std::string_view bytes);

/// Little-endian PF.
std::string encode_pfm(const Image& image);
/// PF and Pf of either byte order. The magnitude of the scale, a unit of light, is not applied.
Decoded<Image> decode_pfm(std::string_view bytes);

}  // namespace raio
