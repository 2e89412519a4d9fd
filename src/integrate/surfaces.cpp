// The kernels of surfaces: gathers the data of hits, kind by kind, and evaluates many at once.
// Compiled once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/surfaces.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <algorithm>
#include <cstddef>

#include "base/placement.h"
#include "integrate/colors-inl.h"
#include "integrate/surface.h"
#include "integrate/surfaces-inl.h"
#include "shape/first_hits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// Copies lane i to all later lanes of the register.
HWY_INLINE void spread_lane(Floats& f, size_t i) { store(hn::Set(d, f.at[i]), f, i); }
HWY_INLINE void spread_lane(Floats3& f, size_t i) {
  spread_lane(f.x, i), spread_lane(f.y, i), spread_lane(f.z, i);
}

// The input of find_surfaces().
struct SurfaceInput {
  const Geometry& geometry;
  const RayBatch& rays;
  const HitBatch& hits;
};

// Surfaces in the lanes, normals outward.
struct WideSurfaces {
  V3 point, geometric, normal;
  V extent;  // added to the scale of shape/offset.h
};

// A surface kernel has two halves: gather() reads the data of ray i's hit, without computations
// that suit many at once; these are in evaluate(), for the lanes from i. Its results for lanes of
// other kinds are ignored. This is the kernel of kinds that rarely occur in large numbers.
// numbers.
template <PrimitiveKind kind>
struct SurfaceKernel {
  static constexpr bool kSameAtAllPoints = false;

  static void gather(const SurfaceInput& in, size_t i, SurfacePoints& v) {
    const uint32_t index = v.index[i];
    const Ray ray = in.rays[i];
    const SurfacePoint s =
        surface_point(at_time(in.geometry.get<kind>(index), ray.time), ray.at(in.hits.t[i]));
    v.gathered.other.point.set(i, s.point);
    v.gathered.other.extent.at[i] = s.extent;
    v.geometric.set(i, s.normal);
    v.material[i] = in.geometry.material_of(in.hits.primitive[i]);
  }
  static HWY_INLINE WideSurfaces evaluate(const SurfaceInput& in, size_t i, M,
                                          const SurfacePoints& v) {
    const V3 geometric = load(v.geometric, i);
    return {load(v.gathered.other.point, i), geometric,
            in.geometry.any_smooth() ? normalize(d, geometric) : geometric,
            load(v.gathered.other.extent, i)};
  }
};

template <>
struct SurfaceKernel<PrimitiveKind::sphere> {
  static constexpr bool kSameAtAllPoints = true;  // the gathered data

  static void gather(const SurfaceInput& in, size_t i, SurfacePoints& v) {
    const uint32_t index = v.index[i];
    const Sphere s = in.geometry.sphere(index);
    v.gathered.sphere.center.set(i, s.center);
    v.gathered.sphere.radius.at[i] = s.radius;
    v.material[i] = in.geometry.object().sphere_materials[index];
  }
  static HWY_INLINE void spread(size_t i, SurfacePoints& v) {
    spread_lane(v.gathered.sphere.center, i), spread_lane(v.gathered.sphere.radius, i);
  }
  // Moves the point back onto the surface along the radius.
  static HWY_INLINE WideSurfaces evaluate(const SurfaceInput& in, size_t i, M,
                                          const SurfacePoints& v) {
    const V3 center = load(v.gathered.sphere.center, i);
    const V radius = load(v.gathered.sphere.radius, i);
    const V3 at = origins(in.rays, i) + directions(in.rays, i) * load(in.hits.t, i);
    const V3 outward = normalize(d, at - center);
    return {center + outward * radius, outward, outward, radius};
  }
};

template <>
struct SurfaceKernel<PrimitiveKind::triangle> {
  static constexpr bool kSameAtAllPoints = true;  // for flat ones

  static void gather(const SurfaceInput& in, size_t i, SurfacePoints& v) {
    const uint32_t index = v.index[i];
    const TriangleIndices& at = in.geometry.corners(index);
    const Facet& facet = in.geometry.facet(index);
    for (size_t c = 0; c < 3; ++c)
      v.gathered.triangle.corner[c].set(i, in.geometry.positions()[at[c]]);
    v.geometric.set(i, facet.normal);
    v.normal.set(i, facet.normal);
    if (const TriangleIndices* corners = in.geometry.corner_normals(index)) {
      const auto weighted = [&](size_t corner, float w) {
        return in.geometry.normals()[(*corners)[corner]] * w;
      };
      const float b1 = in.hits.u[i], b2 = in.hits.v[i];
      v.normal.set(i, weighted(0, 1 - b1 - b2) + weighted(1, b1) + weighted(2, b2));
    }
    v.material[i] = facet.material;
  }
  static HWY_INLINE void spread(size_t i, SurfacePoints& v) {
    for (Floats3& corner : v.gathered.triangle.corner) spread_lane(corner, i);
    spread_lane(v.geometric, i), spread_lane(v.normal, i);
  }
  // By barycentric weights.
  static HWY_INLINE WideSurfaces evaluate(const SurfaceInput& in, size_t i, M,
                                          const SurfacePoints& v) {
    const Floats3(&corner)[3] = v.gathered.triangle.corner;
    const V3 a = load(corner[0], i), ab = load(corner[1], i) - a, ac = load(corner[2], i) - a;
    const V longest = hn::Max(largest(ab), largest(ac));
    const V3 geometric = load(v.geometric, i);
    V3 normal = geometric;
    if (in.geometry.any_smooth()) {
      // In files, the winding of some patches contradicts their normals.
      const V3 smooth = load(v.normal, i), unit = normalize(d, smooth);
      const V side = dot(smooth, geometric);
      normal = select(hn::Gt(side, hn::Zero(d)), unit, -unit);
      normal = select(hn::Eq(side, hn::Zero(d)), geometric, normal);
    }
    return {a + ab * load(in.hits.u, i) + ac * load(in.hits.v, i), geometric, normal,
            hn::Add(longest, longest)};
  }
};

template <>
struct SurfaceKernel<PrimitiveKind::cone> {
  static constexpr bool kSameAtAllPoints = false;  // each point has its own normal

  static void gather(const SurfaceInput& in, size_t i, SurfacePoints& v) {
    const uint32_t index = v.index[i];
    const BakedCone& c = in.geometry.get<PrimitiveKind::cone>(index);
    ConeColumns& to = v.gathered.cone;
    to.base.set(i, c.base), to.axis.set(i, c.axis);
    to.height.at[i] = c.height, to.base_radius.at[i] = c.base_radius, to.slope.at[i] = c.slope;
    v.material[i] = in.geometry.object().cone_materials[index];
  }

  // surface_point(), in double.
  static HWY_INLINE WideSurfaces evaluate(const SurfaceInput& in, size_t i, M cones,
                                          const SurfacePoints& v) {
    using Doubles = hn::CappedTag<double, kWidth>;
    const Doubles wide;
    const hn::Rebind<float, Doubles> narrow;
    using W3 = Wide3<Doubles>;
    const ConeColumns& c = v.gathered.cone;
    const V3 at = origins(in.rays, i) + directions(in.rays, i) * load(in.hits.t, i);
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
      const auto radius = one(c.base_radius.at + i), slope = one(c.slope.at + i);
      const W3 axis = three(c.axis), point = {one(p[0]), one(p[1]), one(p[2])};
      const W3 x = point - three(c.base);
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
    if (any_on_axis) set_tips(in, i, cones, v, p, n);
    const V3 geometric = {hn::Load(d, n[0]), hn::Load(d, n[1]), hn::Load(d, n[2])};
    const V height = load(c.height, i), base = load(c.base_radius, i), slope = load(c.slope, i);
    return {{hn::Load(d, p[0]), hn::Load(d, p[1]), hn::Load(d, p[2])},
            geometric,
            in.geometry.any_smooth() ? normalize(d, geometric) : geometric,
            hn::Add(height, hn::Max(base, hn::Add(base, hn::Mul(slope, height))))};
  }

 private:
  // Tips have no normal.
  static void set_tips(const SurfaceInput& in, size_t i, M cones, const SurfacePoints& v,
                       float (*p)[kWidth], float (*n)[kWidth]) {
    HWY_ALIGN float is_cone[kWidth];
    hn::Store(hn::IfThenElseZero(cones, hn::Set(d, 1)), d, is_cone);
    for (size_t k = 0; k < kWidth; ++k) {
      if (is_cone[k] == 0) continue;
      const SurfacePoint s = surface_point(in.geometry.get<PrimitiveKind::cone>(v.index[i + k]),
                                           in.rays[i + k].at(in.hits.t[i + k]));
      for (int a = 0; a < 3; ++a) p[a][k] = s.point[a], n[a][k] = s.normal[a];
    }
  }
};

#if HWY_TARGET != HWY_SCALAR
const hn::CappedTag<float, 4> kRow;
using Row = hn::Vec<decltype(kRow)>;

// Loads three numbers, without reading beyond them.
HWY_INLINE Row load_row(const Vec3f& a) {
#if HWY_MEM_OPS_MIGHT_FAULT
  const hn::CappedTag<float, 2> two;
  const hn::CappedTag<float, 1> one;
  return hn::Combine(kRow, hn::ZeroExtendVector(two, hn::LoadU(one, &a.z)), hn::LoadU(two, &a.x));
#else
  return hn::MaskedLoad(hn::FirstN(kRow, 3), kRow, &a.x);
#endif
}

// Stores rows as elements i .. i + 3 of three columns; returns the fourth.
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

// SurfaceKernel::gather() of rays i .. i + 3 if all hit triangles, else false: row by row, since
// storing number by number is the expensive part.
HWY_INLINE bool gather_triangles(const SurfaceInput& in, size_t i, SurfacePoints& v) {
  const HitBatch& hits = in.hits;
  const auto is_triangle = [](uint32_t kind) { return kind == uint32_t(PrimitiveKind::triangle); };
  if (!std::all_of(v.kind + i, v.kind + i + 4, is_triangle)) return false;
  const Geometry& geometry = in.geometry;
  Row corner[3][4], facet[4], normal[4];
  for (size_t k = 0; k < 4; ++k) {
    const uint32_t index = v.index[i + k];
    const TriangleIndices& at = geometry.corners(index);
    for (size_t c = 0; c < 3; ++c) corner[c][k] = load_row(geometry.positions()[at[c]]);
    // A facet is a row: its normal, and its material as the fourth number.
    static_assert(sizeof(Facet) == 4 * sizeof(float) && offsetof(Facet, normal) == 0 &&
                  offsetof(Facet, material) == 3 * sizeof(float));
    facet[k] = normal[k] = hn::LoadU(kRow, &geometry.facet(index).normal.x);
    if (const TriangleIndices* corners = geometry.corner_normals(index)) {
      const auto weighted = [&](size_t c, float w) HWY_ATTR {
        return hn::Mul(load_row(geometry.normals()[(*corners)[c]]), hn::Set(kRow, w));
      };
      const float b1 = hits.u[i + k], b2 = hits.v[i + k];
      normal[k] = hn::Add(hn::Add(weighted(0, 1 - b1 - b2), weighted(1, b1)), weighted(2, b2));
    }
  }
  for (size_t c = 0; c < 3; ++c) store_rows(corner[c], v.gathered.triangle.corner[c], i);
  if (geometry.any_smooth()) store_rows(normal, v.normal, i);
  const hn::RebindToUnsigned<decltype(kRow)> ids;
  const Row material = store_rows(facet, v.geometric, i);
  hn::Store(hn::BitCast(ids, material), ids, v.material + i);
  return true;
}
#else
bool gather_triangles(const SurfaceInput&, size_t, SurfacePoints&) { return false; }
#endif

// Kinds follow each other in the ids of primitives, so an id's kind is the last that begins at or
// before it.
HWY_INLINE void find_kinds(const SurfaceInput& in, size_t i, SurfacePoints& v) {
  const U ids = load(in.hits.primitive, i);
  U kind = hn::Zero(du), first = hn::Zero(du);
  for_each_kind([&]<PrimitiveKind k>() HWY_ATTR {
    if (in.geometry.count(k) == 0) return;
    const U begin = hn::Set(du, in.geometry.id_of(k, 0));
    const auto from_here = hn::Not(hn::Lt(ids, begin));
    kind = hn::IfThenElse(from_here, hn::Set(du, uint32_t(k)), kind);
    first = hn::IfThenElse(from_here, begin, first);
  });
  hn::Store(kind, du, v.kind + i), hn::Store(hn::Sub(ids, first), du, v.index + i);
}

void gather(const SurfaceInput& in, size_t i, SurfacePoints& v) {
  with_kind(PrimitiveKind(v.kind[i]),
            [&]<PrimitiveKind kind> { SurfaceKernel<kind>::gather(in, i, v); });
}

// Gathers for the hits of rays i, i + 1, ... in the lanes; often these are on the same primitive.
void gather_lanes(const SurfaceInput& in, size_t i, SurfacePoints& v) {
  const PrimitiveId first = in.hits.primitive[i];
  if (hn::AllTrue(du, hn::Eq(load(in.hits.primitive, i), hn::Set(du, first)))) {
    bool done = false;
    visit_kinds([&]<PrimitiveKind kind>() HWY_ATTR {
      using Kernel = SurfaceKernel<kind>;
      if constexpr (Kernel::kSameAtAllPoints) {
        if (PrimitiveKind(v.kind[i]) != kind) return;
        if (kind == PrimitiveKind::triangle && in.geometry.corner_normals(v.index[i])) return;
        Kernel::gather(in, i, v);
        Kernel::spread(i, v);
        hn::Store(hn::Set(du, v.material[i]), du, v.material + i);
        done = true;
      }
    });
    if (done) return;
  }
  for (size_t k = i; k < i + kWidth; k += 4) {
    if (gather_triangles(in, k, v)) continue;
    for (size_t j = k; j < std::min(k + 4, i + kWidth); ++j) gather(in, j, v);
  }
}

// Neighbours mostly have the same material.
void gather_materials(const Material* materials, size_t i, SurfacePoints& v) {
  constexpr size_t kNumbers = sizeof(Material) / sizeof(float);
  static_assert(kNumbers == 8, "gathered by a shift");
  const std::pair<Floats*, size_t> columns[] = {
      {&v.color.x, offsetof(Material, color.x)},
      {&v.color.y, offsetof(Material, color.y)},
      {&v.color.z, offsetof(Material, color.z)},
      {&v.kd, offsetof(Material, kd)},
      {&v.ks, offsetof(Material, ks)},
      {&v.shine, offsetof(Material, shine)},
      {&v.ior, offsetof(Material, ior)},
      {&v.transmission, offsetof(Material, transmission)}};
  const U material = hn::Load(du, v.material + i);
  const auto number = [](const Material* m, size_t offset) {
    return reinterpret_cast<const float*>(reinterpret_cast<const char*>(m) + offset);
  };
  if (hn::AllTrue(du, hn::Eq(material, hn::Set(du, v.material[i])))) {
    const Material* const one = materials + v.material[i];
    for (const auto& [column, offset] : columns)
      store(hn::Set(d, *number(one, offset)), *column, i);
  } else {
    const auto index = hn::BitCast(Signed<D>(), hn::ShiftLeft<3>(material));
    for (const auto& [column, offset] : columns)
      store(hn::GatherIndex(d, number(materials, offset), index), *column, i);
  }
}

// Stores the surfaces of one kind, those in `lanes`, into columns that are not filled yet. Out of
// line, so that a rare kind takes no registers from the others.
template <PrimitiveKind kind>
HWY_NOINLINE void place_surfaces(const SurfaceInput& in, size_t i, M lanes, SurfacePoints& v) {
  const WideSurfaces found = SurfaceKernel<kind>::evaluate(in, i, lanes, v);
  const auto put = [&](V from, Floats& to)
                       HWY_ATTR { hn::BlendedStore(from, lanes, d, to.at + i); };
  const auto put3 = [&](const V3& from, Floats3& to)
                        HWY_ATTR { put(from.x, to.x), put(from.y, to.y), put(from.z, to.z); };
  put3(found.point, v.point), put3(found.geometric, v.outside), put3(found.normal, v.radiance);
  put(found.extent, v.scale);
}

void find_own_surfaces(const Geometry& geometry, const Scene& scene, const RayBatch& rays,
                       const HitBatch& hits, size_t n, SurfacePoints& v) {
  const SurfaceInput in = {geometry, rays, hits};
  for (size_t i = 0; i < n; i += kWidth) find_kinds(in, i, v), gather_lanes(in, i, v);
  const bool colored = geometry.any_colors();
  const bool tinted = !geometry.vertex_colors().empty();
  const bool textured = !geometry.texture_coordinates().empty() && !scene.material_texture.empty();
  const V zero = hn::Zero(d);
  const M all = hn::FirstN(d, kWidth);
  for (size_t i = 0; i < n; i += kWidth) {
    gather_materials(scene.materials.data(), i, v);
    const HitColumns hit = {hits, v.kind, v.index};
    if (colored) gather_colors(geometry, hit, i, v.color);
    if (tinted) tint_by_vertices(geometry, hit, i, v.color);
    if (textured) tint_by_textures(geometry, scene, hit, i, v.material, v.color);
    const auto finish = [&](const WideSurfaces& s) RAIO_INLINE_LAMBDA {
      const M entering = hn::Lt(dot(s.geometric, directions(rays, i)), zero);
      const V3 normal = select(entering, s.normal, -s.normal);
      const V3 geometric = select(entering, s.geometric, -s.geometric);
      const V scale = hn::Add(largest(s.point), s.extent);
      store(s.point, v.point, i), store(scale, v.scale, i);
      store(normal, v.normal, i), store(geometric, v.geometric, i);
      store(offset_point(s.point, geometric, scale, true), v.outside, i);
      const V ior = load(v.ior, i);
      const V one = hn::Set(d, 1);
      store(hn::IfThenElse(entering, hn::Div(one, ior), ior), v.eta, i);
      store(hn::IfThenElse(entering, one, hn::Neg(one)), v.side, i);
    };
    const U kinds = hn::Load(du, v.kind + i);
    const auto all_are = [&](PrimitiveKind kind) RAIO_INLINE_LAMBDA {
      return hn::AllTrue(du, hn::Eq(kinds, hn::Set(du, uint32_t(kind))));
    };
    // Neighbours mostly are of one kind.
    if (all_are(PrimitiveKind::triangle)) {
      finish(SurfaceKernel<PrimitiveKind::triangle>::evaluate(in, i, all, v));
    } else if (all_are(PrimitiveKind::sphere)) {
      finish(SurfaceKernel<PrimitiveKind::sphere>::evaluate(in, i, all, v));
    } else {
      visit_kinds([&]<PrimitiveKind kind>() HWY_ATTR {
        const M in_lanes = hn::RebindMask(d, hn::Eq(kinds, hn::Set(du, uint32_t(kind))));
        if (!hn::AllFalse(d, in_lanes)) place_surfaces<kind>(in, i, in_lanes, v);
      });
      finish({load(v.point, i), load(v.outside, i), load(v.radiance, i), load(v.scale, i)});
    }
  }
}

// Copies the results of find_surfaces() in v.
void copy_surface_point(const SurfacePoints& from, size_t k, SurfacePoints& v, size_t i) {
  for (Floats3 SurfacePoints::* c :
       {&SurfacePoints::point, &SurfacePoints::outside, &SurfacePoints::normal,
        &SurfacePoints::geometric, &SurfacePoints::color})
    (v.*c).x.at[i] = (from.*c).x.at[k], (v.*c).y.at[i] = (from.*c).y.at[k],
    (v.*c).z.at[i] = (from.*c).z.at[k];
  for (Floats SurfacePoints::* c : {&SurfacePoints::scale, &SurfacePoints::kd, &SurfacePoints::ks,
                                    &SurfacePoints::shine, &SurfacePoints::transmission,
                                    &SurfacePoints::ior, &SurfacePoints::eta, &SurfacePoints::side})
    (v.*c).at[i] = (from.*c).at[k];
  v.material[i] = from.material[k], v.kind[i] = from.kind[k], v.index[i] = from.index[k];
}

// Surfaces of instances are evaluated in the space of their object, one object after another, and
// transformed to the scene.
HWY_NOINLINE void find_instanced_surfaces(const Geometry& geometry, const Scene& scene,
                                          const RayBatch& rays, const HitBatch& hits, size_t n,
                                          SurfacePoints& v) {
  if (!v.instanced) v.instanced = std::make_unique<SurfacePoints::Instanced>();
  SurfacePoints::Instanced& there = *v.instanced;
  there.objects.assign(n, nullptr), there.indices.resize(n);
  if (rays.has_time() && !there.rays.has_time()) there.rays.add_time();
  there.rays.resize(n), there.hits.reset(n);
  std::vector<const Geometry*> objects;
  for (size_t i = 0; i < n; ++i) {
    if (hits.instance[i]) {
      const Geometry::Placed at = geometry.placed(hits.instance[i]);
      there.objects[i] = &at.object, there.indices[i] = at.index;
    }
    if (std::ranges::find(objects, there.objects[i]) == objects.end())
      objects.push_back(there.objects[i]);
  }
  for (const Geometry* object : objects) {
    there.lanes.clear();
    for (uint32_t i = 0; i < n; ++i)
      if (there.objects[i] == object) there.lanes.push_back(i);
    const size_t count = there.lanes.size();
    // The last is repeated, so that the remaining lanes hold valid values.
    for (size_t k = 0; k < count || k % kWidth != 0; ++k) {
      const size_t i = there.lanes[std::min(k, count - 1)];
      Ray ray = rays[i];
      Hit hit = hits[i];
      if (object) {
        double stretch = 0;
        ray = geometry.placement(there.indices[i]).to_object(ray, stretch);
        hit.t = float(double(hit.t) * stretch);
        hit.instance -= geometry.instance_id(there.indices[i]);
      }
      there.rays.set(k, ray), there.hits.set(k, hit);
    }
    if (object)
      find_surfaces(*object, scene, there.rays, there.hits, count, there.points);
    else
      find_own_surfaces(geometry, scene, there.rays, there.hits, count, there.points);
    for (size_t k = 0; k < count; ++k) {
      const size_t i = there.lanes[k];
      copy_surface_point(there.points, k, v, i);
      if (!object) continue;
      const Placement place = geometry.placement(there.indices[i]);
      const auto at = [&](const Floats3& f) { return Vec3d(f.x.at[i], f.y.at[i], f.z.at[i]); };
      const Vec3f point(place.point(at(v.point))), normal(place.normal(at(v.normal)));
      const Vec3f geometric(place.normal(at(v.geometric)));
      const float scale = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)}) +
                          float(place.longest()) * v.scale.at[i];
      v.point.set(i, point), v.normal.set(i, normal), v.geometric.set(i, geometric);
      v.outside.set(i, offset_origin(point, geometric, scale, true));
      v.scale.at[i] = scale;
    }
  }
  for (size_t i = n; i % kWidth != 0; ++i) copy_surface_point(v, n - 1, v, i);
}

}  // namespace

void find_surfaces(const Geometry& geometry, const Scene& scene, const RayBatch& rays,
                   const HitBatch& hits, size_t n, SurfacePoints& v) {
  if (geometry.has_instances() && n > 0)
    find_instanced_surfaces(geometry, scene, rays, hits, n, v);
  else
    find_own_surfaces(geometry, scene, rays, hits, n, v);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
