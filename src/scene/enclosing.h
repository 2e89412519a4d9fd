// Sums over spheres that enclose all of a scene except infinite planes.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "base/parallel.h"
#include "base/placement.h"
#include "scene/scene.h"

namespace raio::core {

/// Calls f(centre, radius) for spheres that enclose primitive i of a kind.
template <PrimitiveKind kind, class F>
void enclose(const Object& scene, size_t i, F&& f) {
  const auto& shape = (scene.*kPoolOf<PrimitiveType<kind>>.shapes)[i];
  if constexpr (kind == PrimitiveKind::sphere) {
    f(shape.center, std::abs(shape.radius));
  } else {
    const Box3f box = bounds(bake(shape));
    for (int corner = 0; corner < 8; ++corner)
      f(Vec3f(corner & 1 ? box.hi.x : box.lo.x, corner & 2 ? box.hi.y : box.lo.y,
              corner & 4 ? box.hi.z : box.lo.z),
        0.0f);
  }
}

/// Calls add(sum, centre, radius) for every `every`-th primitive of each pool. Adds the sums in an
/// order that does not depend on threads.
template <class Sum, class Add>
Sum sum_up(const Object& scene, const Add& add, size_t every = 1) {
  Sum total;
  for (const Instance& copy : scene.instances) {
    const Placement place(copy.matrix);
    const double scale = place.scale() > 0 ? place.scale() : place.longest();
    const auto moved = [&](Sum& sum, Vec3f center, float radius) {
      add(sum, Vec3f(place.point(Vec3d(center))), float(scale * double(radius)));
    };
    using Moved = std::function<void(Sum&, Vec3f, float)>;
    total.join(sum_up<Sum>(scene.prototypes[copy.prototype], Moved(moved), every));
  }
  const auto sum_each = [&](size_t all, const auto& one) {
    const size_t count = (all + every - 1) / every;
    std::vector<Sum> sums(chunks_of(count));
    for_chunks(count, [&](size_t c, size_t first, size_t end) {
      for (size_t i = first; i < end; ++i)
        one(i * every, [&](Vec3f center, float radius) { add(sums[c], center, radius); });
    });
    for (const Sum& s : sums) total.join(s);
  };
  for_each_bounded_kind([&]<PrimitiveKind kind> {
    if constexpr (kind != PrimitiveKind::triangle)
      sum_each((scene.*kPoolOf<PrimitiveType<kind>>.shapes).size(),
               [&](size_t i, const auto& f) { enclose<kind>(scene, i, f); });
  });
  const auto sum_corners = [&](const auto& triangles, const auto& positions) {
    sum_each(triangles.size(), [&](size_t i, const auto& f) {
      for (const uint32_t corner : triangles[i]) f(positions[corner], 0.0f);
    });
  };
  sum_corners(scene.triangles, scene.positions);
  sum_each(scene.polygons.size(), [&](size_t i, const auto& f) {
    const Polygon& polygon = scene.polygons[i];
    for (uint32_t k = 0; k < polygon.count; ++k)
      f(scene.positions[size_t(polygon.first) + k], 0.0f);
  });
  for (const Mesh& mesh : scene.meshes) sum_corners(mesh.triangles, mesh.positions);
  return total;
}

}  // namespace raio::core
