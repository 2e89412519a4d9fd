// The surfaces that rays hit, for the classic shading (classic_trace.cpp): points, normals and
// materials.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_RENDER_CLASSIC_SURFACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_RENDER_CLASSIC_SURFACES_INL_H_
#undef RAIO_RENDER_CLASSIC_SURFACES_INL_H_
#else
#define RAIO_RENDER_CLASSIC_SURFACES_INL_H_
#endif

#include "render/classic.h"
#include "render/classic_tile-inl.h"
#include "render/surface.h"
#include "shape/offset.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {
namespace {

// shape/offset.h.
HWY_INLINE V3 offset_point(const V3& point, const V3& geometric, V scale, bool along_normal) {
  const float k = offset_length(1);
  return point + geometric * hn::Mul(hn::Set(d, along_normal ? k : -k), scale);
}

// What was hit and is being shaded.
struct Vertices {
  Floats3 corner[3];                          // of a triangle; the first is the centre of a sphere
  Floats extent;                              // what the surface adds to `scale`
  Floats3 point, outside, normal, geometric;  // normals towards the ray; `outside`: off the surface
  Floats scale;                               // of shape/offset.h
  alignas(64) MaterialId material[kChunk + 16];
  Floats3 color;
  Floats kd, ks, shine, transmission, ior;
  Floats eta;        // for refraction
  Floats3 radiance;  // towards the ray, so far
};

// What the surface that ray i hit is made of: looked up here, worked out many together by
// find_surfaces().
void look_up(const ClassicScene& classic, const RayBatch& rays, const HitBatch& hits, size_t i,
             Vertices& v) {
  const Geometry& geometry = classic.accel.geometry();
  const Scene& scene = classic.scene;
  const ItemKind kind = item_kind(hits.item[i]);
  const uint32_t index = item_index(hits.item[i]);
  switch (kind) {
    case ItemKind::sphere: {
      const Sphere s = geometry.sphere(index);
      v.corner[0].set(i, s.center);
      v.extent.at[i] = s.radius;
      v.material[i] = scene.sphere_materials[index];
      return;
    }
    case ItemKind::triangle: {
      const TriangleIndices& at = geometry.corners(index);
      const Facet& facet = geometry.facet(index);
      for (size_t c = 0; c < 3; ++c) v.corner[c].set(i, scene.positions[at[c]]);
      v.extent.at[i] = 0;
      v.geometric.set(i, facet.normal);
      v.normal.set(i, facet.normal);
      if (const TriangleIndices* corners = geometry.corner_normals(index)) {
        const auto weighted = [&](size_t corner, float w) {
          return scene.normals[(*corners)[corner]] * w;
        };
        const float b1 = hits.u[i], b2 = hits.v[i];
        v.normal.set(i, weighted(0, 1 - b1 - b2) + weighted(1, b1) + weighted(2, b2));
      }
      v.material[i] = facet.material;
      return;
    }
    case ItemKind::plane:
    case ItemKind::cone: {
      const Vec3f p = rays[i].at(hits.t[i]);
      const Surface s = kind == ItemKind::plane ? plane_surface(geometry, index, p)
                                                : cone_surface(geometry, index, p);
      for (Floats3& corner : v.corner) corner.set(i, s.point);
      v.extent.at[i] = s.extent;
      v.geometric.set(i, s.normal), v.normal.set(i, s.normal);
      v.material[i] = s.material;
      return;
    }
  }
}

// Those of rays i, i + 1, ... in the lanes, which often hit the same thing.
void look_up_lanes(const ClassicScene& classic, const RayBatch& rays, const HitBatch& hits,
                   size_t i, Vertices& v) {
  look_up(classic, rays, hits, i, v);
  const ItemId first = hits.item[i];
  const bool triangle = item_kind(first) == ItemKind::triangle;
  // Of the others each point has a normal of its own.
  const bool flat = triangle ? !classic.accel.geometry().corner_normals(item_index(first))
                             : item_kind(first) == ItemKind::sphere;
  if (!flat || !hn::AllTrue(du, hn::Eq(load(hits.item, i), hn::Set(du, first)))) {
    for (size_t k = i + 1; k < i + kWidth; ++k) look_up(classic, rays, hits, k, v);
    return;
  }
  const auto spread = [&](Floats& f) HWY_ATTR { store(hn::Set(d, f.at[i]), f, i); };
  const auto spread3 = [&](Floats3& f) HWY_ATTR { spread(f.x), spread(f.y), spread(f.z); };
  hn::Store(hn::Set(du, v.material[i]), du, v.material + i);
  spread(v.extent);
  spread3(v.corner[0]);
  if (!triangle) return;
  spread3(v.corner[1]), spread3(v.corner[2]);
  spread3(v.geometric), spread3(v.normal);
}

// Neighbours are mostly of one material.
void look_up_materials(const Material* materials, size_t i, Vertices& v) {
  static_assert(sizeof(Material) == 8 * sizeof(float));
  Floats* const columns[] = {&v.color.x, &v.color.y, &v.color.z,      &v.kd,
                             &v.ks,      &v.shine,   &v.transmission, &v.ior};
  const U material = hn::Load(du, v.material + i);
  if (hn::AllTrue(du, hn::Eq(material, hn::Set(du, v.material[i])))) {
    const float* first = &materials[v.material[i]].color.x;
    for (size_t c = 0; c < 8; ++c) store(hn::Set(d, first[c]), *columns[c], i);
  } else {
    const auto index = hn::BitCast(Signed<D>(), hn::ShiftLeft<3>(material));
    const float* base = &materials->color.x;
    for (size_t c = 0; c < 8; ++c) store(hn::GatherIndex(d, base + c, index), *columns[c], i);
  }
}

// Where n rays hit: points, normals towards the ray, and all that is the same for every light.
void find_surfaces(const ClassicScene& classic, const RayBatch& rays, const HitBatch& hits,
                   size_t n, Vertices& v) {
  for (size_t i = 0; i < n; i += kWidth) look_up_lanes(classic, rays, hits, i, v);
  const bool smooth = classic.accel.geometry().any_smooth();
  const V zero = hn::Zero(d);
  const V3 ambient = set3(d, classic.ambient);
  for (size_t i = 0; i < n; i += kWidth) {
    look_up_materials(classic.scene.materials.data(), i, v);
    const V3 dir = directions(rays, i);
    // Triangles, by their corners' weights; points of other kinds are three corners of their own.
    const V3 a = load(v.corner[0], i);
    const V3 ab = load(v.corner[1], i) - a, ac = load(v.corner[2], i) - a;
    V3 point = a + ab * load(hits.u, i) + ac * load(hits.v, i);
    V extent = load(v.extent, i);
    V3 geometric = load(v.geometric, i), normal = load(v.normal, i);
    const V longest = hn::Max(largest(ab), largest(ac));
    if (smooth) {
      // Files wind some patches the other way round than their normals point.
      const V side = dot(normal, geometric);
      const V3 unit = normalize(d, normal);
      normal = select(hn::Gt(side, zero), unit, -unit);
      normal = select(hn::Eq(side, zero), geometric, normal);
    }
    const auto kind = hn::ShiftRight<kItemIndexBits>(load(hits.item, i));
    const M sphere = hn::RebindMask(d, hn::Eq(kind, hn::Set(du, uint32_t(ItemKind::sphere))));
    // Spheres: the point is put back on the surface along the radius, for which it must be `a`.
    const V3 at = origins(rays, i) + dir * load(hits.t, i);
    const V3 outward = normalize(d, at - a);
    point = select(sphere, a + outward * extent, point);
    geometric = select(sphere, outward, geometric);
    normal = select(sphere, outward, normal);
    extent = hn::IfThenElse(sphere, extent, hn::Add(extent, hn::Add(longest, longest)));

    const M entering = hn::Lt(dot(geometric, dir), zero);
    normal = select(entering, normal, -normal);
    geometric = select(entering, geometric, -geometric);
    const V scale = hn::Add(largest(point), extent);
    store(point, v.point, i), store(scale, v.scale, i);
    store(normal, v.normal, i), store(geometric, v.geometric, i);
    store(offset_point(point, geometric, scale, true), v.outside, i);
    const V ior = load(v.ior, i);
    store(hn::IfThenElse(entering, hn::Div(hn::Set(d, 1), ior), ior), v.eta, i);
    store(ambient * load(v.color, i), v.radiance, i);
  }
}

}  // namespace
}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
