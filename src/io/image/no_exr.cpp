// In place of exr.cpp in builds with RAIO_EXR=OFF.
#include "io/image/codecs.h"

namespace raio {

std::string exr_missing() { return "this build has no OpenEXR; use one with RAIO_EXR=ON"; }

Decoded<std::string> encode_exr(const PictureView&, const Metadata&) {
  return std::unexpected(exr_missing());
}

Decoded<Image> decode_exr(std::string_view) { return std::unexpected(exr_missing()); }

Decoded<Picture> decode_exr_picture(std::string_view) { return std::unexpected(exr_missing()); }

Decoded<Metadata> exr_metadata(std::string_view) { return std::unexpected(exr_missing()); }

}  // namespace raio
