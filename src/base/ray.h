// Rays and hits.
#pragma once

#include <cstdint>
#include <limits>

#include "base/vec.h"

namespace raio::core {

/// The points origin + t * dir for 0 < t < tmax. Rays start off the surface that they leave
/// (shape/offset.h), so no tmin is needed. `dir` has unit length.
struct Ray {
  Vec3f origin, dir;
  float tmax = std::numeric_limits<float>::infinity();
  float time = 0;  // when it reaches moving primitives

  Vec3f at(float t) const { return origin + dir * t; }
};

/// The index of a primitive in its object, where kinds follow each other in the order of
/// PrimitiveKind; accel/geometry.h gives its kind and its index in the pool.
using PrimitiveId = uint32_t;
inline constexpr PrimitiveId kNoPrimitive = 0xffffffffu;
inline constexpr uint32_t kMaxPrimitives = 0xfffffffeu;  // per object

/// The number of an instance. Instance i of the scene has the number i + 1, or a larger one if
/// earlier instances contain instances, which are counted, too. 0: none, for the scene's own
/// primitives.
using InstanceId = uint32_t;
inline constexpr uint32_t kMaxInstances = 0xfffffffeu;

/// `u`, `v` are the barycentric weights of a triangle's second and third vertex.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  PrimitiveId primitive = kNoPrimitive;  // in the instance's object
  float u = 0, v = 0;
  InstanceId instance = 0;

  bool found() const { return primitive != kNoPrimitive; }
};

/// The order of hits along a ray. Among equally near ones the lowest ids come first, so all
/// structures agree.
inline bool comes_before(const Hit& a, const Hit& b) {
  if (a.t != b.t) return a.t < b.t;
  return a.instance != b.instance ? a.instance < b.instance : a.primitive < b.primitive;
}

}  // namespace raio::core
