// One ray against items of the baked geometry: what every structure of Raio's own ends in, so that
// all of them find the same hits to the last bit.
#pragma once

#include "accel/geometry.h"

namespace raio {

/// A ray on its way: what is prepared once, and the nearest hit so far.
struct RayQuery {
  Ray ray;
  ShearedRay sheared;
  Hit best;

  explicit RayQuery(const Ray& r) : ray(r), sheared(r.dir) { best.t = r.tmax; }

  /// Keeps a hit if it is the nearest; of equally near ones, that of the lowest id.
  bool offer(float t, PrimitiveId item, float u = 0, float v = 0) {
    if (!(t > 0 && (t < best.t || (t == best.t && best.found() && item < best.item)))) return false;
    best = {t, item, u, v};
    return true;
  }
};

inline bool test_plane(const Geometry& g, uint32_t i, RayQuery& q) {
  const PrimitiveId id = primitive_id(PrimitiveKind::plane, i);
  const auto t = intersect(g.plane(i), q.ray);
  if (!t || !visible(g.sides_of(id), dot(g.plane(i).normal, q.ray.dir))) return false;
  return q.offer(*t, id);
}

inline bool test_sphere(const Geometry& g, uint32_t i, RayQuery& q) {
  const Sphere s = g.sphere(i);
  const SphereRoots roots = sphere_roots(s.center, s.radius, q.ray);
  if (!(roots.entry <= roots.exit)) return false;
  const PrimitiveId id = primitive_id(PrimitiveKind::sphere, i);
  const Sides sides = g.sides_of(id);
  if (roots.entry > 0 && visible(sides, -1)) return q.offer(roots.entry, id);
  return visible(sides, 1) && q.offer(roots.exit, id);
}

inline bool test_triangle(const Geometry& g, uint32_t i, RayQuery& q) {
  const Triangle t = g.triangle(i);
  const auto hit = intersect(t.a, t.b, t.c, q.ray, q.sheared);
  if (!hit) return false;
  const PrimitiveId id = primitive_id(PrimitiveKind::triangle, i);
  return visible(g.sides_of(id), hit->cosine) && q.offer(hit->t, id, hit->u, hit->v);
}

inline bool test_cone(const Geometry& g, uint32_t i, RayQuery& q) {
  const ConeRoots roots = cone_roots(g.cone(i), q.ray);
  const PrimitiveId id = primitive_id(PrimitiveKind::cone, i);
  for (int k = 0; k < roots.count; ++k)
    if (roots.t[k] > 0 && visible(g.sides_of(id), roots.cosine[k])) return q.offer(roots.t[k], id);
  return false;
}

inline bool test_primitive(const Geometry& g, PrimitiveId id, RayQuery& q) {
  const uint32_t i = primitive_index(id);
  switch (primitive_kind(id)) {
    case PrimitiveKind::plane:
      return test_plane(g, i, q);
    case PrimitiveKind::sphere:
      return test_sphere(g, i, q);
    case PrimitiveKind::triangle:
      return test_triangle(g, i, q);
    case PrimitiveKind::cone:
      return test_cone(g, i, q);
  }
  return false;
}

}  // namespace raio
