// The surfaces that rays hit, as all shading sees them: points, normals and materials.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_INTEGRATE_SURFACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_SURFACES_INL_H_
#undef RAIO_INTEGRATE_SURFACES_INL_H_
#else
#define RAIO_INTEGRATE_SURFACES_INL_H_
#endif

#include <algorithm>
#include <cstddef>

#include "integrate/colors-inl.h"
#include "integrate/surface.h"
#include "integrate/tile-inl.h"
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
  // Of a triangle; the centre of a sphere; base, axis and (height, base radius, slope) of a cone.
  Floats3 corner[3];
  Floats extent;  // what the surface adds to `scale`
  // `outside`: off the surface. Normals towards the ray, when find_surfaces() is done; what
  // look_up() leaves in `normal` counts only in scenes with smooth triangles.
  Floats3 point, outside, normal, geometric;
  Floats scale;  // of shape/offset.h
  alignas(64) MaterialId material[kChunk + 16];
  Floats3 color;
  Floats kd, ks, shine, transmission, ior;
  Floats eta;        // for refraction
  Floats3 radiance;  // towards the ray, so far

  // A point that is known, as three corners of its own.
  void set(size_t i, const Surface& s) {
    for (Floats3& c : corner) c.set(i, s.point);
    extent.at[i] = s.extent;
    geometric.set(i, s.normal), normal.set(i, s.normal);
    material[i] = s.material;
  }
};

// What the surface that ray i hit is made of: looked up here, worked out many together by
// find_surfaces().
void look_up(const Accel& accel, const RayBatch& rays, const HitBatch& hits, size_t i,
             Vertices& v) {
  const Geometry& geometry = accel.geometry();
  const Scene& scene = accel.geometry().scene();
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
      for (size_t c = 0; c < 3; ++c) v.corner[c].set(i, geometry.positions()[at[c]]);
      v.extent.at[i] = 0;
      v.geometric.set(i, facet.normal);
      v.normal.set(i, facet.normal);
      if (const TriangleIndices* corners = geometry.corner_normals(index)) {
        const auto weighted = [&](size_t corner, float w) {
          return geometry.normals()[(*corners)[corner]] * w;
        };
        const float b1 = hits.u[i], b2 = hits.v[i];
        v.normal.set(i, weighted(0, 1 - b1 - b2) + weighted(1, b1) + weighted(2, b2));
      }
      v.material[i] = facet.material;
      return;
    }
    case ItemKind::cone: {
      const BakedCone& c = geometry.cone(index);
      v.corner[0].set(i, c.base), v.corner[1].set(i, c.axis);
      v.corner[2].set(i, {c.height, c.base_radius, c.slope});
      v.material[i] = scene.cone_materials[index];
      return;
    }
    case ItemKind::plane:
      v.set(i, plane_surface(geometry, index, rays[i].at(hits.t[i])));
      return;
  }
}

#if HWY_TARGET != HWY_SCALAR
const hn::CappedTag<float, 4> kRow;
using Row = hn::Vec<decltype(kRow)>;

// Three numbers, and not what follows them.
HWY_INLINE Row load_row(const Vec3f& a) {
#if HWY_MEM_OPS_MIGHT_FAULT
  const hn::CappedTag<float, 2> two;
  const hn::CappedTag<float, 1> one;
  return hn::Combine(kRow, hn::ZeroExtendVector(two, hn::LoadU(one, &a.z)), hn::LoadU(two, &a.x));
#else
  return hn::MaskedLoad(hn::FirstN(kRow, 3), kRow, &a.x);
#endif
}

// Rows as elements i .. i + 3 of three columns; the fourth is returned.
HWY_INLINE Row store_rows(const Row (&rows)[4], Floats3& to, size_t i) {
  const hn::Repartition<double, decltype(kRow)> pairs;
  const auto pair = [&](Row a) HWY_ATTR { return hn::BitCast(pairs, a); };
  const auto xy01 = pair(hn::InterleaveLower(kRow, rows[0], rows[1]));
  const auto xy23 = pair(hn::InterleaveLower(kRow, rows[2], rows[3]));
  const auto zw01 = pair(hn::InterleaveUpper(kRow, rows[0], rows[1]));
  const auto zw23 = pair(hn::InterleaveUpper(kRow, rows[2], rows[3]));
  hn::Store(hn::BitCast(kRow, hn::InterleaveLower(pairs, xy01, xy23)), kRow, to.x.at + i);
  hn::Store(hn::BitCast(kRow, hn::InterleaveUpper(pairs, xy01, xy23)), kRow, to.y.at + i);
  hn::Store(hn::BitCast(kRow, hn::InterleaveLower(pairs, zw01, zw23)), kRow, to.z.at + i);
  return hn::BitCast(kRow, hn::InterleaveUpper(pairs, zw01, zw23));
}

// look_up() of rays i .. i + 3 if all of them hit triangles, else false: row by row, since storing
// number by number is what takes the time.
HWY_INLINE bool look_up_triangles(const Accel& accel, const HitBatch& hits, size_t i, Vertices& v) {
  const auto is_triangle = [](ItemId id) { return item_kind(id) == ItemKind::triangle; };
  if (!std::all_of(&hits.item[i], &hits.item[i] + 4, is_triangle)) return false;
  const Geometry& geometry = accel.geometry();
  Row corner[3][4], geometric[4], normal[4];
  for (size_t k = 0; k < 4; ++k) {
    const uint32_t index = item_index(hits.item[i + k]);
    const TriangleIndices& at = geometry.corners(index);
    for (size_t c = 0; c < 3; ++c) corner[c][k] = load_row(geometry.positions()[at[c]]);
    static_assert(offsetof(Facet, material) == 3 * sizeof(float));
    geometric[k] = normal[k] = hn::LoadU(kRow, &geometry.facet(index).normal.x);
    if (const TriangleIndices* corners = geometry.corner_normals(index)) {
      const auto weighted = [&](size_t c, float w) HWY_ATTR {
        return hn::Mul(load_row(geometry.normals()[(*corners)[c]]), hn::Set(kRow, w));
      };
      const float b1 = hits.u[i + k], b2 = hits.v[i + k];
      normal[k] = hn::Add(hn::Add(weighted(0, 1 - b1 - b2), weighted(1, b1)), weighted(2, b2));
    }
  }
  for (size_t c = 0; c < 3; ++c) store_rows(corner[c], v.corner[c], i);
  if (geometry.any_smooth()) store_rows(normal, v.normal, i);
  const hn::RebindToUnsigned<decltype(kRow)> ids;
  hn::Store(hn::BitCast(ids, store_rows(geometric, v.geometric, i)), ids, v.material + i);
  hn::Store(hn::Zero(kRow), kRow, v.extent.at + i);
  return true;
}
#else
bool look_up_triangles(const Accel&, const HitBatch&, size_t, Vertices&) { return false; }
#endif

// Those of rays i, i + 1, ... in the lanes, which often hit the same thing.
void look_up_lanes(const Accel& accel, const RayBatch& rays, const HitBatch& hits, size_t i,
                   Vertices& v) {
  const ItemId first = hits.item[i];
  const bool triangle = item_kind(first) == ItemKind::triangle;
  // Of the others each point has a normal of its own.
  const bool flat = triangle ? !accel.geometry().corner_normals(item_index(first))
                             : item_kind(first) == ItemKind::sphere;
  if (!flat || !hn::AllTrue(du, hn::Eq(load(hits.item, i), hn::Set(du, first)))) {
    for (size_t k = i; k < i + kWidth; k += 4) {
      if (look_up_triangles(accel, hits, k, v)) continue;
      for (size_t j = k; j < std::min(k + 4, i + kWidth); ++j) look_up(accel, rays, hits, j, v);
    }
    return;
  }
  look_up(accel, rays, hits, i, v);
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

// Puts the points that rays hit on cones in the place of what look_up() has told of the cones:
// cone_surface(), in the lanes i, i + 1, ... of `cones`.
void find_cones(const Geometry& geometry, const RayBatch& rays, const HitBatch& hits, size_t i,
                M cones, Vertices& v) {
  using Doubles = hn::CappedTag<double, kWidth>;
  const Doubles wide;
  const hn::Rebind<float, Doubles> narrow;
  using W3 = Wide3<Doubles>;
  const V3 shape = load(v.corner[2], i),
           at = origins(rays, i) + directions(rays, i) * load(hits.t, i);
  HWY_ALIGN float p[3][kWidth], n[3][kWidth];
  hn::Store(at.x, d, p[0]), hn::Store(at.y, d, p[1]), hn::Store(at.z, d, p[2]);
  bool any_on_axis = false;
  for (size_t k = 0; k < kWidth; k += hn::MaxLanes(wide)) {
    const auto one = [&](const float* x)
                         HWY_ATTR { return hn::PromoteTo(wide, hn::Load(narrow, x + k)); };
    const auto three = [&](const Floats3& f) HWY_ATTR {
      return W3{one(f.x.at + i), one(f.y.at + i), one(f.z.at + i)};
    };
    const auto put = [&](const W3& from, float(*to)[kWidth]) HWY_ATTR {
      hn::Store(hn::DemoteTo(narrow, from.x), narrow, to[0] + k);
      hn::Store(hn::DemoteTo(narrow, from.y), narrow, to[1] + k);
      hn::Store(hn::DemoteTo(narrow, from.z), narrow, to[2] + k);
    };
    const auto divided = [](const W3& a, hn::Vec<Doubles> by) HWY_ATTR {
      return W3{hn::Div(a.x, by), hn::Div(a.y, by), hn::Div(a.z, by)};
    };
    const auto radius = one(v.corner[2].y.at + i), slope = one(v.corner[2].z.at + i);
    const W3 axis = three(v.corner[1]), point = {one(p[0]), one(p[1]), one(p[2])};
    const W3 x = point - three(v.corner[0]);
    const auto z = dot(x, axis);
    const W3 across = x - axis * z;
    const auto rho = length(across);
    any_on_axis |= !hn::AllTrue(wide, hn::Gt(rho, hn::Zero(wide)));
    const W3 out = divided(across, rho) - axis * slope;
    put(divided(out, length(out)), n);
    const W3 normal = {one(n[0]), one(n[1]), one(n[2])};
    const auto error = hn::Sub(rho, hn::Add(radius, hn::Mul(slope, z)));
    const auto secant = hn::Sqrt(hn::Add(hn::Set(wide, 1.0), hn::Mul(slope, slope)));
    put(point - normal * hn::Div(error, secant), p);
  }
  const auto put = [&](const V3& from, Floats3& to)
                       HWY_ATTR { store(select(cones, from, load(to, i)), to, i); };
  const V3 point = {hn::Load(d, p[0]), hn::Load(d, p[1]), hn::Load(d, p[2])};
  const V3 normal = {hn::Load(d, n[0]), hn::Load(d, n[1]), hn::Load(d, n[2])};
  for (Floats3& corner : v.corner) put(point, corner);
  put(normal, v.geometric), put(normal, v.normal);
  const V extent = hn::Add(shape.x, hn::Max(shape.y, hn::Add(shape.y, hn::Mul(shape.z, shape.x))));
  store(hn::IfThenElse(cones, extent, load(v.extent, i)), v.extent, i);
  if (!any_on_axis) return;
  // Tips have no normal of their own.
  for (size_t k = i; k < i + kWidth; ++k)
    if (item_kind(hits.item[k]) == ItemKind::cone)
      v.set(k, cone_surface(geometry, item_index(hits.item[k]), rays[k].at(hits.t[k])));
}

// Where n rays hit: points, normals towards the ray, and all that is the same for every light.
void find_surfaces(const Accel& accel, const RayBatch& rays, const HitBatch& hits, size_t n,
                   Vertices& v) {
  for (size_t i = 0; i < n; i += kWidth) look_up_lanes(accel, rays, hits, i, v);
  const bool smooth = accel.geometry().any_smooth();
  const bool colored = accel.geometry().any_colors();
  const V zero = hn::Zero(d);
  for (size_t i = 0; i < n; i += kWidth) {
    look_up_materials(accel.geometry().scene().materials.data(), i, v);
    if (colored) look_up_colors(accel.geometry(), hits, i, v.color);
    const V3 dir = directions(rays, i);
    const auto kind = hn::ShiftRight<kItemIndexBits>(load(hits.item, i));
    const auto is = [&](ItemKind k) HWY_ATTR {
      return hn::RebindMask(d, hn::Eq(kind, hn::Set(du, uint32_t(k))));
    };
    if (const M cones = is(ItemKind::cone); !hn::AllFalse(d, cones))
      find_cones(accel.geometry(), rays, hits, i, cones, v);
    // Triangles, by their corners' weights; points of other kinds are three corners of their own.
    const V3 a = load(v.corner[0], i);
    const V3 ab = load(v.corner[1], i) - a, ac = load(v.corner[2], i) - a;
    V3 point = a + ab * load(hits.u, i) + ac * load(hits.v, i);
    V extent = load(v.extent, i);
    V3 geometric = load(v.geometric, i), normal = smooth ? load(v.normal, i) : geometric;
    const V longest = hn::Max(largest(ab), largest(ac));
    if (smooth) {
      // Files wind some patches the other way round than their normals point.
      const V side = dot(normal, geometric);
      const V3 unit = normalize(d, normal);
      normal = select(hn::Gt(side, zero), unit, -unit);
      normal = select(hn::Eq(side, zero), geometric, normal);
    }
    const M sphere = is(ItemKind::sphere);
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
  }
}

}  // namespace
}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
