// Computes normals for meshes that have none.
#pragma once

#include "scene/scene.h"

namespace raio::core {

/// Edges with a smaller angle look round, others sharp; degrees.
inline constexpr float kSmoothDegrees = 40;

/// Computes normals for meshes of the scene that have none: at each corner of a triangle, the
/// area-weighted mean over the triangles around its position with normals within `degrees` of its
/// own (Gouraud 1971, "Continuous Shading of Curved Surfaces"). Vertices at one position count as
/// one. A mesh with sharp edges only stays flat. Returns the number of smoothed meshes.
size_t smooth_meshes(Scene& scene, float degrees);

}  // namespace raio::core
