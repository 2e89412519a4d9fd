#include "base/hash.h"

#include <bit>
#include <cstring>

namespace raio::core {
namespace {

constexpr uint64_t kFactor1 = 0x87c37b91114253d5, kFactor2 = 0x4cf5ad432745937f;

uint64_t mix1(uint64_t k) { return std::rotl(k * kFactor1, 31) * kFactor2; }
uint64_t mix2(uint64_t k) { return std::rotl(k * kFactor2, 33) * kFactor1; }

uint64_t finish(uint64_t h) {
  h = (h ^ h >> 33) * 0xff51afd7ed558ccd;
  h = (h ^ h >> 33) * 0xc4ceb9fe1a85ec53;
  return h ^ h >> 33;
}

// Reads up to eight bytes as a little-endian number.
uint64_t little_endian(const char* bytes, size_t count) {
  uint64_t value = 0;
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(&value, bytes, count);
  } else {
    for (size_t i = count; i-- > 0;) value = value << 8 | uint8_t(bytes[i]);
  }
  return value;
}

}  // namespace

Hash128 hash128(std::string_view bytes) {
  uint64_t h1 = 0, h2 = 0;
  const char* p = bytes.data();
  const char* const end = p + bytes.size();
  for (; end - p >= 16; p += 16) {
    h1 = std::rotl(h1 ^ mix1(little_endian(p, 8)), 27) + h2;
    h1 = h1 * 5 + 0x52dce729;
    h2 = std::rotl(h2 ^ mix2(little_endian(p + 8, 8)), 31) + h1;
    h2 = h2 * 5 + 0x38495ab5;
  }
  const size_t left = size_t(end - p);
  if (left > 8) h2 ^= mix2(little_endian(p + 8, left - 8));
  if (left > 0) h1 ^= mix1(little_endian(p, left > 8 ? 8 : left));
  h1 ^= bytes.size(), h2 ^= bytes.size();
  h1 += h2, h2 += h1;
  h1 = finish(h1), h2 = finish(h2);
  h1 += h2, h2 += h1;
  return {h1, h2};
}

std::string hex(const Hash128& hash) {
  std::string out;
  for (const uint64_t half : {hash.first, hash.second})
    for (int shift = 60; shift >= 0; shift -= 4) out += "0123456789abcdef"[half >> shift & 15];
  return out;
}

}  // namespace raio::core
