// A scene as what glTF can hold: triangles by their material, and unit shapes with places for those
// shapes that it has none of. Internal to its writer.
#pragma once

#include <compare>
#include <expected>
#include <string>
#include <vector>

#include "io/mesh/gltf_shapes.h"
#include "scene/scene.h"

namespace raio::gltf {

/// What decides a material of glTF: one of the scene's with a colour and an opacity in place of its
/// own.
struct GltfAppearance {
  MaterialId material = 0;
  Rgb color;
  float opacity = 1;
  uint32_t textured = 0;  // by the material's texture: 0 or 1

  friend bool operator==(const GltfAppearance&, const GltfAppearance&) = default;
};

/// A surface with the number of its look.
struct SurfacePart {
  uint32_t surface = 0, look = 0;

  friend auto operator<=>(const SurfacePart&, const SurfacePart&) = default;
};

/// What the scene has of its own, or one of its objects.
struct ObjectParts {
  std::vector<SurfacePart> fixed;  // where they are

  /// A unit shape where it is wanted.
  struct Shape {
    SurfacePart part;
    NodePlace place;
  };
  std::vector<Shape> shapes;

  /// A copy of an object.
  struct Copy {
    uint32_t object = 0;  // of SurfaceParts::objects
    NodePlace place;
  };
  std::vector<Copy> copies;
};

struct SurfaceParts {
  std::vector<GltfAppearance> looks;
  std::vector<Surface> surfaces;
  std::vector<ObjectParts> objects;  // the first is the scene
};

/// Of all but planes; what moves is where it begins. Spheres, cones, ellipsoids and discs are unit
/// shapes with places where they are few, else triangles, the more of them the coarser. No copy may
/// shear (gltf_keeps_copies). The error says that the shapes or the copies are too many.
std::expected<SurfaceParts, std::string> surface_parts(const Scene& scene);

/// How many spheres, cones and so on become triangles, with those of copies.
size_t count_curved(const Scene& scene);

}  // namespace raio::gltf
