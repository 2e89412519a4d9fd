// What shading wants to know of one hit. Those of spheres, triangles and cones it works out many at
// a time (surfaces-inl.h).
#pragma once

#include "accel/geometry.h"
#include "base/ray.h"

namespace raio {

struct Surface : SurfacePoint {
  MaterialId material = 0;
};

/// Of any kind, one at a time: for views of a scene's parts and for what was clicked.
Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit);

}  // namespace raio
