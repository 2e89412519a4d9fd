// Overlap of curved shapes and boxes, by subdividing the box.
#pragma once

#include "base/box.h"

namespace raio::core {

/// False if `apart(box)` is sure that the shape does not touch the box, or is sure for all its
/// parts. A box that may touch is split in eight. If `apart` uses the distance from the box's
/// centre, then after two splits a "yes" is wrong by at most an eighth of the box's diagonal.
template <class Apart>
bool may_touch(const Box3d& box, Apart&& apart, int splits = 2) {
  if (apart(box)) return false;
  if (splits == 0) return true;
  const Vec3d center = box.center();
  for (int octant = 0; octant < 8; ++octant) {
    Box3d part;
    for (int a = 0; a < 3; ++a) {
      const bool upper = octant >> a & 1;
      part.lo[a] = upper ? center[a] : box.lo[a];
      part.hi[a] = upper ? box.hi[a] : center[a];
    }
    if (may_touch(part, apart, splits - 1)) return true;
  }
  return false;
}

}  // namespace raio::core
