// Deflate compression with all threads, which libpng and zip libraries do not support: bytes are
// produced and compressed in bands; their concatenated streams form one. For formats with deflate
// streams.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace raio::core {

/// One of zlib's checksums; those of parts can be combined.
struct CheckSum {
  uLong (*of)(uLong start, const Bytef* bytes, z_size_t size);
  uLong (*combine)(uLong first, uLong second, z_off_t second_size);
};
inline constexpr CheckSum kAdler32{adler32_z, adler32_combine}, kCrc32{crc32_z, crc32_combine};

/// A raw deflate stream (RFC 1951).
struct Deflated {
  std::vector<std::string> bands;  // of the stream, in order
  uint64_t bytes = 0;              // before compression
  uint32_t check_sum = 0;          // of the uncompressed bytes
};

/// Compresses the bytes of bands 0, 1 and so on, at least one band. Calls `make` on all threads.
/// The division into bands affects the result, so it must not depend on the number of threads.
/// Throws std::bad_alloc.
Deflated deflate_bands(size_t bands, const CheckSum& check_sum,
                       const std::function<std::vector<uint8_t>(size_t band)>& make);

}  // namespace raio::core
