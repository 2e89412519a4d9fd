// In place of npz.cpp in builds with RAIO_NPZ=OFF.
#include "io/image/codecs.h"

namespace raio {

std::string npz_missing() { return "this build has no minizip for .npz; use one with RAIO_NPZ=ON"; }

Decoded<std::string> encode_npz(const PictureView&) { return std::unexpected(npz_missing()); }

}  // namespace raio
