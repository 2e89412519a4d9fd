// The list of kinds, written once, and what all kinds share.
//
// To add a kind:
// 1. shape/<kind>.h: the struct with its faults, whether only its inside is seen, its baked form
//    and the numbers of that, and of the baked form bounds, overlap with a box, the first hit of a
//    ray and the surface at a hit; at its end, once for each instruction set, the first hits of
//    many rays in SIMD lanes, with the bits of the scalar one;
// 2. here: at the end of PrimitiveKind, its name and its type; a ShapeKind, which users count; at
//    the end of the file, its header;
// 3. scene/scene.h: its pool, a PoolKind with its name, and a line in kScenePools;
// 4. io/nff/additions.cpp: its keyword, reader and writer;
// 5. io/pov_write.cpp: its writer.
// Everything else is driven by these lists, and does not compile or link where a part is missing.
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

namespace raio {

struct Plane;
struct Sphere;
struct Triangle;
struct Cone;
struct Ellipsoid;
struct Disc;
struct MovingSphere;
struct MovingTriangle;

/// The kinds that structures store and rays hit, in the order of their PrimitiveIds: a new kind
/// goes to the end.
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

/// Primitives of an infinite kind have no bounds and are in no structure: every ray tests them.
template <PrimitiveKind kind>
inline constexpr bool kIsBounded = kind != PrimitiveKind::plane;

/// Is a primitive of the kind elsewhere at another time?
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

/// The same for the kinds that have bounds.
template <class F>
constexpr void for_each_bounded_kind(F&& f) {
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kIsBounded<kind>) f.template operator()<kind>();
  });
}

/// What f.operator()<kind>() returns for a kind known at run time.
template <size_t first = 0, class F>
constexpr decltype(auto) with_kind(PrimitiveKind kind, F&& f) {
  if constexpr (first + 1 < kPrimitiveKinds)
    if (kind != PrimitiveKind(first)) return with_kind<first + 1>(kind, f);
  return f.template operator()<PrimitiveKind(first)>();
}

/// What users count: a polygon is stored as triangles, a cylinder is a cone.
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

/// Which side of a surface can be seen. Of a polygon the outside is where its corners run
/// counter-clockwise; of a plane likewise by its three points.
enum class Sides : uint8_t { both, outside, inside };

/// Is a surface seen by a ray for which dot(outward normal, direction) has the sign of `cosine`?
inline bool visible(Sides sides, float cosine) {
  return sides == Sides::both || (sides == Sides::outside) == (cosine < 0);
}

/// Is the length 1, but for a few of a float's last bits?
inline bool is_unit(Vec3f n) { return std::abs(length(Vec3d(n)) - 1) < 1e-4; }

/// Where a ray first meets the seen side of a shape, at t > 0; `u` and `v` as in Hit.
struct ShapeHit {
  float t = 0, u = 0, v = 0;
};

/// A shape as it is at a time, which those that do not move do not depend on.
template <class Shape>
constexpr Shape at_time(const Shape& shape, float) {
  return shape;
}

/// The surface at a hit.
struct SurfacePoint {
  Vec3f point;       // on the surface, nearer to it than origin + t * dir
  Vec3f normal;      // unit, outward
  float extent = 0;  // what the shape adds to the scale of shape/offset.h
};

}  // namespace raio

#endif  // RAIO_SHAPE_KINDS_H_

// All kinds in SIMD lanes, for accel/blocks/lanes-inl.h, once for each instruction set.
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
