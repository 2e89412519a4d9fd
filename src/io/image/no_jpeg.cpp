// Replaces jpeg.cpp in builds with RAIO_JPEG=OFF.
#include "io/image/codecs.h"

namespace raio::core {

Decoded<PixelRows> jpeg_rows(std::string_view) {
  return std::unexpected(
      "this build has no libjpeg; convert the picture to PNG, or use a build with RAIO_JPEG=ON");
}

}  // namespace raio::core
