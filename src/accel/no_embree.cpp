// Replaces embree.cpp in builds with RAIO_EMBREE=OFF.
#include "accel/structures.h"

namespace raio::core {

AccelResult make_embree(Geometry, const AccelOptions&) {
  return std::unexpected(
      "this build has no Embree; choose another structure, or a build with RAIO_EMBREE=ON");
}

}  // namespace raio::core
