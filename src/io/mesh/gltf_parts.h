// Converts a scene to what glTF can store: triangles grouped by material, and unit shapes with
// transformations for other shapes. Internal to its writer.
#pragma once

#include <compare>
#include <expected>
#include <string>
#include <vector>

#include "io/mesh/gltf_shapes.h"
#include "scene/scene.h"

namespace raio::core::gltf {

/// Identifies a glTF material: a material of the scene with its own colour and opacity.
struct GltfAppearance {
  MaterialId material = 0;
  Rgb color;
  float opacity = 1;
  uint32_t textured = 0;  // whether the material's textures apply: 0 or 1

  friend bool operator==(const GltfAppearance&, const GltfAppearance&) = default;
};

/// A surface with its appearance's index.
struct SurfacePart {
  uint32_t surface = 0, look = 0;

  friend auto operator<=>(const SurfacePart&, const SurfacePart&) = default;
};

/// The contents of the scene or of one of its objects.
struct ObjectParts {
  std::vector<SurfacePart> fixed;  // with positions in place

  /// A unit shape with its transformation.
  struct Shape {
    SurfacePart part;
    NodePlace place;
  };
  std::vector<Shape> shapes;

  /// An instance of an object.
  struct Copy {
    uint32_t object = 0;  // index into SurfaceParts::objects
    NodePlace place;
  };
  std::vector<Copy> copies;
};

struct SurfaceParts {
  std::vector<GltfAppearance> looks;
  std::vector<Surface> surfaces;
  std::vector<ObjectParts> objects;  // the first one is the scene
};

/// Converts everything but planes; moving shapes at their start. Few spheres, cones, ellipsoids and
/// discs become unit shapes with transformations, many become triangles, coarser the more there
/// are. No instance may shear (gltf_keeps_copies). The error says that there are too many shapes or
/// instances.
std::expected<SurfaceParts, std::string> surface_parts(const Scene& scene);

/// The number of spheres, cones and so on that become triangles, including instances.
size_t count_curved(const Scene& scene);

}  // namespace raio::core::gltf
