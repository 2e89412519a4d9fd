// What shading wants to know of a hit on the kinds of surface that are rare in large numbers; those
// on spheres and triangles it works out many at a time (surfaces-inl.h).
#pragma once

#include "accel/geometry.h"
#include "base/ray.h"

namespace raio {

struct Surface {
  Vec3f point;       // on the surface, nearer than origin + t * dir
  Vec3f normal;      // unit, outward
  float extent = 0;  // what the surface adds to the scale of shape/offset.h
  MaterialId material = 0;
};

/// Of plane or cone number `index`; `p`: origin + t * dir of the ray that hit.
Surface plane_surface(const Geometry& geometry, uint32_t index, Vec3f p);
Surface cone_surface(const Geometry& geometry, uint32_t index, Vec3f p);

/// Of any kind, one at a time: for views of a scene's parts and for what was clicked.
Surface surface_at(const Geometry& geometry, const Ray& ray, const Hit& hit);

}  // namespace raio
