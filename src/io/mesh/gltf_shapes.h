// Triangles for shapes that glTF does not have; internal to its writer. Each is a transformed unit
// shape: the sphere of radius 1 around 0; the frustum of radius 1 at y = 0 and `ratio` at y = 1,
// without caps; the ring in the plane y = 0 from radius `ratio` to 1.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <vector>

#include "io/mesh/gltf_place.h"
#include "scene/scene.h"

namespace raio::core::gltf {

/// Triangles with optional attributes; missing ones are empty.
struct Surface {
  std::vector<Vec3f> positions, normals;
  std::vector<Uv> uv;
  std::vector<Rgb> colors;  // multiplied by the material's colour
  std::vector<TriangleIndices> triangles;
};

struct UnitShape {
  enum class Kind : uint8_t { sphere, frustum, ring };
  Kind kind = Kind::sphere;
  double ratio = 0;

  friend auto operator<=>(const UnitShape&, const UnitShape&) = default;
};

/// The finest level. A sphere is an icosahedron subdivided `detail` times; other round shapes have
/// 8 << `detail` sides.
inline constexpr int kFinest = 3;
Surface surface_of(const UnitShape& shape, int detail);
size_t triangles_of(const UnitShape& shape, int detail);

struct PlacedShape {
  UnitShape shape;
  NodePlace place;
};
PlacedShape placed(const Sphere& s);
PlacedShape placed(const Cone& c);
PlacedShape placed(const Ellipsoid& e);
PlacedShape placed(const Disc& d);
PlacedShape placed(const MovingSphere& s);  // at its start

}  // namespace raio::core::gltf
