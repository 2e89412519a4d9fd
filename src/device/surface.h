// Surfaces as primitives of a raio::Scene: geometries, materials, and the samplers and attributes
// between them.
#pragma once

#include <raio/raio.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "device/objects.h"

namespace raio::device {

/// Primitives of one kind that were added together.
struct Range {
  Kind kind;
  uint32_t first, count;             ///< as Hit::index counts
  uint32_t object_id;                ///< of the surface
  bool in_mesh = false;              ///< counts from the first mesh's triangle on
  std::vector<uint32_t> primitives;  ///< their numbers in the geometry; empty: 0, 1, ...
  uint32_t instance_id = 0xffffffffu;
};

/// The primitives that were added to a scene.
struct Part {
  std::vector<Range> ranges;

  /// The range of a primitive; null if there is none.
  const Range* find(Kind kind, uint32_t index) const;
};

/// Adds the surface. Uniform attributes of `instance`, if any, replace those of the geometry. What
/// cannot be shown is reported and left out. `round_ends`: also adds balls at the ends of cylinders
/// and cones, for boxes around scenes like those of other devices.
void add_surface(const Object& surface, const Object* instance, uint32_t id, Scene& scene,
                 Part& part, bool round_ends = false);

/// Numbers the triangles of meshes behind those of the scene's own.
void number_meshes(Part& part);

}  // namespace raio::device
