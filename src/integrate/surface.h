// The surface at one hit. surfaces.cpp computes many at a time.
#pragma once

#include "accel/geometry.h"
#include "base/ray.h"

namespace raio::core {

struct Surface : SurfacePoint {
  MaterialId material = 0;
};

/// For any kind, one at a time: for views of a scene's parts and for mouse picks.
Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit);

}  // namespace raio::core
