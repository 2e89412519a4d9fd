// A 128-bit hash of bytes: MurmurHash3_x64_128 of Austin Appleby (2011, public domain). Accidental
// collisions are negligible; deliberate ones are easy, so it proves nothing about authorship.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace raio::core {

struct Hash128 {
  uint64_t first = 0, second = 0;

  friend bool operator==(const Hash128&, const Hash128&) = default;
};

Hash128 hash128(std::string_view bytes);

/// The hash as 32 hexadecimal digits.
std::string hex(const Hash128& hash);

}  // namespace raio::core
