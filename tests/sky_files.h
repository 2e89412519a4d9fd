// Skies for tests, in files.
#pragma once

#include <cstdio>
// Which needs FILE.
#include <jpeglib.h>

#include <cstdlib>
#include <functional>
#include <stdexcept>

#include "io/cube_map.h"
#include "io/image/image.h"
#include "temporary_folder.h"

namespace raio::testing {

/// A JPEG of `rows` of 3 bytes a pixel, or of 1 where it is grey, as exact as JPEG allows.
inline std::string jpeg_of(int width, int height, const std::string& rows, bool progressive = false,
                           bool grey = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = JDIMENSION(width), jpeg.image_height = JDIMENSION(height);
  jpeg.input_components = grey ? 1 : 3, jpeg.in_color_space = grey ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 1;
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  std::string copy = rows;
  const size_t row_bytes = rows.size() / size_t(height);
  while (jpeg.next_scanline < jpeg.image_height) {
    auto* row = reinterpret_cast<JSAMPROW>(&copy[row_bytes * jpeg.next_scanline]);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string out(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return out;
}

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

}  // namespace raio::testing
