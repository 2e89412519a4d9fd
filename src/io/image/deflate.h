// Compression on all threads, which neither libpng nor zip libraries have: bytes are made and
// compressed in bands, whose streams in a row are one. For the formats that contain deflate
// streams.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raio {

/// One of zlib's check sums, of which those of parts can be combined.
struct CheckSum {
  uLong (*of)(uLong start, const Bytef* bytes, z_size_t size);
  uLong (*combine)(uLong first, uLong second, z_off_t second_size);
};
inline constexpr CheckSum kAdler32{adler32_z, adler32_combine}, kCrc32{crc32_z, crc32_combine};

/// A raw deflate stream (RFC 1951).
struct Deflated {
  std::vector<std::string> bands;  // of the stream, in a row
  uint64_t bytes = 0;              // before compression
  uint32_t check_sum = 0;          // of these
};

/// The bytes of bands 0, 1 and so on, one after the other, at least one band. `make` is called on
/// all threads. Which bands there are must not depend on the number of threads, since it shows.
/// Throws std::bad_alloc.
Deflated deflate_bands(size_t bands, const CheckSum& check_sum,
                       const std::function<std::vector<uint8_t>(size_t band)>& make);

}  // namespace raio
