// Skies for tests, in files.
#pragma once

#include <functional>
#include <stdexcept>

#include "io/cube_map.h"
#include "io/image/image.h"
#include "temporary_folder.h"

namespace raio::core::tests {

/// The value of a texel: of a face, column and row from the upper left.
using TexelColor = std::function<Rgb(CubeFace, int, int)>;

/// Bytes that differ for all texels of small faces.
inline Rgb distinct_texel(CubeFace face, int x, int y) {
  return Rgb(float(20 + 40 * int(face)), float(3 + 23 * x), float(5 + 29 * y)) / 255;
}

/// Writes the six faces as PNG.
inline void put_sky(const std::filesystem::path& folder, int side,
                    const TexelColor& color = distinct_texel) {
  std::filesystem::create_directories(folder);
  for (size_t face = 0; face < kCubeFaces; ++face) {
    Image image(side, side);
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) image.at(x, y) = color(CubeFace(face), x, y);
    const auto path = folder / (std::string(kCubeFaceNames[face]) + ".png");
    if (!write_image(image, path)) throw std::runtime_error("cannot write " + path.string());
  }
}

inline std::shared_ptr<const CubeMap> sky_of(const std::filesystem::path& folder) {
  auto sky = read_cube_map(folder);
  if (!sky) throw std::runtime_error(sky.error().text());
  return *sky;
}

}  // namespace raio::core::tests
