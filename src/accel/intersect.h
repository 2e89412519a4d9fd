// Tests one ray with primitives of the baked geometry. All of Raio's structures end here, so they
// find exactly the same hits.
#pragma once

#include "accel/geometry.h"

namespace raio::core {

/// A ray with its precomputed values and the nearest hit so far.
struct RayQuery {
  Ray ray;
  ShearedRay sheared;
  Hit best;

  explicit RayQuery(const Ray& r) : ray(r), sheared(r.dir) { best.t = r.tmax; }

  /// Takes a hit if it is the nearest; among equally near ones, the lowest id.
  bool offer(float t, PrimitiveId id, float u = 0, float v = 0) {
    if (!(t > 0 && (t < best.t || (t == best.t && best.found() && id < best.primitive))))
      return false;
    best = {t, id, u, v};
    return true;
  }
};

/// Tests the ray with primitive i of a kind; true if the hit is taken.
template <PrimitiveKind kind>
bool test(const Geometry& g, uint32_t i, RayQuery& q) {
  const auto& primitive = g.get<kind>(i);
  std::optional<ShapeHit> hit;
  if constexpr (kind == PrimitiveKind::triangle)
    hit = first_hit(primitive, q.ray, q.sheared, g.sides_of(kind, i));
  else
    hit = first_hit(primitive, q.ray, g.sides_of(kind, i));
  return hit && q.offer(hit->t, g.id_of(kind, i), hit->u, hit->v);
}

inline bool test_primitive(const Geometry& g, PrimitiveId id, RayQuery& q) {
  return with_kind(g.kind_of(id),
                   [&]<PrimitiveKind kind> { return test<kind>(g, g.index_of(kind, id), q); });
}

}  // namespace raio::core
