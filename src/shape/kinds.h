// The list of shape kinds, written once, and what all kinds share.
//
// To add a kind: its struct, bounds, overlap test and intersection in a header of this room; a line
// in ShapeKind and kShapeKindNames; a pool in scene/scene.h and, for tracing, in accel/geometry.h;
// a case in accel/intersect.h and integrate/surfaces-inl.h; a keyword in io/nff/keywords.cpp
// with its reader and writer. ARCHITECTURE.md says more.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/ray.h"

namespace raio {

enum class ShapeKind : uint8_t { plane, sphere, triangle, polygon, cone, cylinder };

inline constexpr std::array<std::string_view, 6> kShapeKindNames = {
    "plane", "sphere", "triangle", "polygon", "cone", "cylinder"};
inline constexpr int kShapeKinds = int(kShapeKindNames.size());

/// Which side of a surface can be seen. Of a polygon the outside is where its corners run
/// counter-clockwise; of a plane likewise by its three points.
enum class Sides : uint8_t { both, outside, inside };

/// Is a surface seen by a ray for which dot(outward normal, direction) has the sign of `cosine`?
inline bool visible(Sides sides, float cosine) {
  return sides == Sides::both || (sides == Sides::outside) == (cosine < 0);
}

}  // namespace raio
