// The list of primitive kinds, and what all kinds share.
//
// To add a kind:
// 1. shape/<kind>.h: the struct with its faults, whether only its inside is visible, its baked
//    form and the plain numbers of that. For the baked form: bounds, overlap with a box, first hit
//    of a ray, surface at a hit. At the end, once per instruction set, the first hits of many rays
//    in SIMD lanes, with the bits of the scalar version;
// 2. here: its name and type at the end of PrimitiveKind; a ShapeKind, for users' counts; its
//    header at the end of the file;
// 3. scene/scene.h: its pool, a PoolKind with its name, and a line in kScenePools;
// 4. io/nff/additions.cpp: its keyword, reader and writer;
// 5. io/pov_write.cpp: its writer.
// These lists drive everything else, which does not compile or link if a part is missing.
#ifndef RAIO_SHAPE_KINDS_H_
#define RAIO_SHAPE_KINDS_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "base/ray.h"

namespace raio::core {

struct Plane;
struct Sphere;
struct Triangle;
struct Cone;
struct Ellipsoid;
struct Disc;
struct MovingSphere;
struct MovingTriangle;

/// Kinds that structures store and rays hit, in the order of PrimitiveIds: append new kinds.
enum class PrimitiveKind : uint32_t {
  plane,
  sphere,
  triangle,
  cone,
  ellipsoid,
  disc,
  moving_sphere,
  moving_triangle
};
using PrimitiveTypes =
    std::tuple<Plane, Sphere, Triangle, Cone, Ellipsoid, Disc, MovingSphere, MovingTriangle>;
inline constexpr auto kPrimitiveKindNames =
    std::to_array<std::string_view>({"plane", "sphere", "triangle", "cone", "ellipsoid", "disc",
                                     "moving sphere", "moving triangle"});

inline constexpr size_t kPrimitiveKinds = std::tuple_size_v<PrimitiveTypes>;
static_assert(kPrimitiveKindNames.size() == kPrimitiveKinds);
template <PrimitiveKind kind>
using PrimitiveType = std::tuple_element_t<size_t(kind), PrimitiveTypes>;

template <class T, class List>
inline constexpr bool kIsOneOf = false;
template <class T, class... Types>
inline constexpr bool kIsOneOf<T, std::tuple<Types...>> = (std::is_same_v<T, Types> || ...);
template <class T>
concept Primitive = kIsOneOf<T, PrimitiveTypes>;

/// Primitives of an infinite kind have no bounds and are in no structure: every ray is tested with
/// each of them.
template <PrimitiveKind kind>
inline constexpr bool kIsBounded = kind != PrimitiveKind::plane;

/// Whether a primitive of the kind moves.
template <PrimitiveKind kind>
inline constexpr bool kMoves =
    kind == PrimitiveKind::moving_sphere || kind == PrimitiveKind::moving_triangle;

/// Calls f.operator()<kind>() for each kind.
template <class F>
constexpr void for_each_kind(F&& f) {
  [&]<size_t... k>(std::index_sequence<k...>) {
    (f.template operator()<PrimitiveKind(k)>(), ...);
  }(std::make_index_sequence<kPrimitiveKinds>());
}

/// The same for kinds with bounds.
template <class F>
constexpr void for_each_bounded_kind(F&& f) {
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kIsBounded<kind>) f.template operator()<kind>();
  });
}

/// The result of f.operator()<kind>() for a kind known at run time.
template <size_t first = 0, class F>
constexpr decltype(auto) with_kind(PrimitiveKind kind, F&& f) {
  if constexpr (first + 1 < kPrimitiveKinds)
    if (kind != PrimitiveKind(first)) return with_kind<first + 1>(kind, f);
  return f.template operator()<PrimitiveKind(first)>();
}

/// Shapes as users count them: a polygon is stored as triangles, a cylinder is a cone.
enum class ShapeKind : uint8_t {
  plane,
  sphere,
  triangle,
  polygon,
  cone,
  cylinder,
  ellipsoid,
  disc
};

inline constexpr auto kShapeKindNames = std::to_array<std::string_view>(
    {"plane", "sphere", "triangle", "polygon", "cone", "cylinder", "ellipsoid", "disc"});
inline constexpr int kShapeKinds = int(kShapeKindNames.size());

/// The visible sides of a surface. The outside of a polygon is where its vertices appear
/// counter-clockwise; likewise for the three points of a plane.
enum class Sides : uint8_t { both, outside, inside };

/// Whether a ray sees the surface if dot(outward normal, direction) has the sign of `cosine`.
inline bool visible(Sides sides, float cosine) {
  return sides == Sides::both || (sides == Sides::outside) == (cosine < 0);
}

/// Whether the length is 1 except for a few of a float's last bits.
inline bool is_unit(Vec3f n) { return std::abs(length(Vec3d(n)) - 1) < 1e-4; }

/// The first hit on a visible side of a shape, at t > 0; `u` and `v` as in Hit.
struct ShapeHit {
  float t = 0, u = 0, v = 0;
};

/// A shape at a given time; only moving shapes depend on it.
template <class Shape>
constexpr Shape at_time(const Shape& shape, float) {
  return shape;
}

/// The surface at a hit.
struct SurfacePoint {
  Vec3f point;       // on the surface: more exact than origin + t * dir
  Vec3f normal;      // unit, outward
  float extent = 0;  // added to the scale of shape/offset.h
};

}  // namespace raio::core

#endif  // RAIO_SHAPE_KINDS_H_

// The SIMD code of all kinds, for accel/blocks/lanes-inl.h, once per instruction set.
#ifdef RAIO_KINDS_IN_LANES
#include "shape/cone.h"
#include "shape/disc.h"
#include "shape/ellipsoid.h"
#include "shape/movement.h"
#include "shape/moving_sphere.h"
#include "shape/moving_triangle.h"
#include "shape/sphere.h"
#include "shape/triangle.h"
#endif
