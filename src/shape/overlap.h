// The overlap of curved shapes and boxes by splitting the box.
#pragma once

#include "base/box.h"

namespace raio {

/// False if `apart(box)` is sure that the shape does not touch the box, or sure of all its parts. A
/// box is split in eight while it may touch: where `apart` goes by the distance from the box's
/// centre, two splits leave a "yes" at most an eighth of the box's diagonal too generous.
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

}  // namespace raio
