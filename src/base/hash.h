// A name of 128 bits for any bytes: MurmurHash3_x64_128 of Austin Appleby (2011, public domain).
// Different bytes have different names but by an accident that nobody will see; who wants to can
// make two that collide, so it proves nothing about who wrote them.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace raio {

struct Hash128 {
  uint64_t first = 0, second = 0;

  friend bool operator==(const Hash128&, const Hash128&) = default;
};

Hash128 hash128(std::string_view bytes);

/// 32 hexadecimal digits.
std::string hex(const Hash128& hash);

}  // namespace raio
