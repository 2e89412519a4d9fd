// Replaces exr.cpp in builds with RAIO_OPENEXR=OFF.
#include "io/image/codecs.h"

namespace raio::core {
namespace {

constexpr const char* kNoOpenExr =
    "this build has no OpenEXR; use .png, .pfm or .npz, or a build with RAIO_OPENEXR=ON";

}  // namespace

Decoded<void> check_exr() { return std::unexpected(kNoOpenExr); }

Decoded<std::string> encode_exr(const PictureView&, const Metadata&) {
  return std::unexpected(kNoOpenExr);
}

Decoded<Image> decode_exr(std::string_view) { return std::unexpected(kNoOpenExr); }

Decoded<Picture> decode_exr_picture(std::string_view) { return std::unexpected(kNoOpenExr); }

Decoded<Metadata> exr_metadata(std::string_view) { return std::unexpected(kNoOpenExr); }

}  // namespace raio::core
