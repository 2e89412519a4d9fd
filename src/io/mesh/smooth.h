// Normals for meshes whose files give none.
#pragma once

#include "scene/scene.h"

namespace raio {

/// Edges that bend by less than this look round, others sharp; degrees.
inline constexpr float kSmoothDegrees = 40;

/// Gives the scene's meshes without normals some: at each corner of a triangle the mean of the
/// triangles around the place whose normals are within `degrees` of its own, weighed by area
/// (Gouraud 1971, "Continuous Shading of Curved Surfaces"). SurfacePoints at one place count as
/// one. A mesh all of whose edges are sharp stays flat. Returns the number of meshes that are
/// smooth now.
size_t smooth_meshes(Scene& scene, float degrees);

}  // namespace raio
