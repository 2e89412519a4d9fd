// One ray against primitives of the baked geometry. Every structure of Raio's own ends here, so all
// of them find the same hits to the last bit.
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
  bool offer(float t, PrimitiveId id, float u = 0, float v = 0) {
    if (!(t > 0 && (t < best.t || (t == best.t && best.found() && id < best.primitive))))
      return false;
    best = {t, id, u, v};
    return true;
  }
};

/// Ray and primitive i of a kind; true where the hit is kept.
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

}  // namespace raio
