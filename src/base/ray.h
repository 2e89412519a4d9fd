// Rays, and what they hit. Everyone may use it.
#pragma once

#include <cstdint>
#include <limits>

#include "base/vec.h"

namespace raio {

/// The half-open stretch 0 < t < tmax of origin + t * dir. Rays start off the surface that they
/// leave (shape/offset.h), so no ray needs a positive tmin. `dir` has unit length.
struct Ray {
  Vec3f origin, dir;
  float tmax = std::numeric_limits<float>::infinity();
  float time = 0;  // at which it meets what moves

  Vec3f at(float t) const { return origin + dir * t; }
};

/// What a structure stores and a ray finds: 3 bits of shape kind, 29 bits of index in that kind's
/// pool. Ids order by kind, then by index; where several hits are equally near, the lowest id is
/// the hit, so that every structure gives the same answer.
using PrimitiveId = uint32_t;
inline constexpr PrimitiveId kNoPrimitive = 0xffffffffu;
inline constexpr int kPrimitiveIndexBits = 29;
inline constexpr uint32_t kMaxPrimitivesPerKind = 1u << kPrimitiveIndexBits;

/// 16 bytes. `u`, `v` are the barycentric weights of a triangle's second and third corner.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  PrimitiveId item = kNoPrimitive;
  float u = 0, v = 0;

  bool found() const { return item != kNoPrimitive; }
};
static_assert(sizeof(Hit) == 16);

/// The order of hits along a ray.
inline bool comes_before(const Hit& a, const Hit& b) {
  return a.t < b.t || (a.t == b.t && a.item < b.item);
}

}  // namespace raio
