// What fuzz targets hold against a reader besides that it lives.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace raio::fuzz {

/// Ends the program when `holds` does not, so that libFuzzer keeps the input.
inline void require(bool holds, std::string_view what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %.*s\n", int(what.size()), what.data());
  std::abort();
}

}  // namespace raio::fuzz
