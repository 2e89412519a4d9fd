// What shading wants to know of a hit. Looked up for the nearest hit only.
#pragma once

#include "accel/geometry.h"
#include "base/ray.h"

namespace raio {

struct Surface {
  Vec3f point;      // on the surface, nearer than origin + t * dir
  Vec3f normal;     // unit, outward, for shading: interpolated on smooth triangles
  Vec3f geometric;  // unit, outward, of the surface itself
  float scale = 0;  // magnitude of the numbers the hit came from (shape/offset.h)
  MaterialId material = 0;
};

Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit);

}  // namespace raio
