// In place of jpeg.cpp in builds with RAIO_JPEG=OFF.
#include "io/image/codecs.h"

namespace raio {

Decoded<PixelRows> jpeg_rows(std::string_view) {
  return std::unexpected("this build has no libjpeg; use one with RAIO_JPEG=ON, or save it as PNG");
}

}  // namespace raio
