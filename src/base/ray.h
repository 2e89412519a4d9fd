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

/// The number of a primitive in its object, where those of each kind follow those of the kind
/// before (PrimitiveKind); accel/geometry.h gives its kind and its index in the kind's pool.
using PrimitiveId = uint32_t;
inline constexpr PrimitiveId kNoPrimitive = 0xffffffffu;
inline constexpr uint32_t kMaxPrimitives = 0xfffffffeu;  // of an object

/// The number of an instance, those within instances included: instance i of the scene has the
/// number i + 1, or a larger one where instances before it hold instances themselves. 0: none, for
/// the scene's own primitives.
using InstanceId = uint32_t;
inline constexpr uint32_t kMaxInstances = 0xfffffffeu;

/// `u`, `v` are the barycentric weights of a triangle's second and third corner.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  PrimitiveId primitive = kNoPrimitive;  // of the object that the instance shows
  float u = 0, v = 0;
  InstanceId instance = 0;

  bool found() const { return primitive != kNoPrimitive; }
};

/// The order of hits along a ray. Of equally near ones the lowest ids come first, so that every
/// structure finds the same.
inline bool comes_before(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  return a.instance != b.instance ? a.instance < b.instance : a.primitive < b.primitive;
}

}  // namespace raio
