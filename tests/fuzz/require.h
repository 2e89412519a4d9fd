// Conditions that fuzz targets check, besides not crashing.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace raio::core::fuzz {

/// Ends the program unless `holds`, so that libFuzzer keeps the input.
inline void require(bool holds, std::string_view what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %.*s\n", int(what.size()), what.data());
  std::abort();
}

}  // namespace raio::core::fuzz
