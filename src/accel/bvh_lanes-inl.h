// What the walks of the eight-wide tree test: one ray against eight boxes or primitives. Included
// by bvh_trace.cpp only, once for each instruction set. Lane by lane the arithmetic is that of the
// scalar tests in shape/, so that hits are those of brute force to the last bit, on every machine.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_ACCEL_BVH_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BVH_LANES_INL_H_
#undef RAIO_ACCEL_BVH_LANES_INL_H_
#else
#define RAIO_ACCEL_BVH_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/bvh.h"
#include "accel/intersect.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

const hn::CappedTag<float, kBvhWidth> kFloats;
using V = hn::Vec<decltype(kFloats)>;
using M = hn::Mask<decltype(kFloats)>;
// Where the machine has four lanes, everything below is done twice.
constexpr int kLanes = int(hn::MaxLanes(decltype(kFloats)()));
constexpr float kEpsilon = std::numeric_limits<float>::epsilon();

HWY_INLINE V set(float x) { return hn::Set(kFloats, x); }
HWY_INLINE V load(const float* p) { return hn::LoadU(kFloats, p); }
HWY_INLINE V dot(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}
HWY_INLINE unsigned bits(M mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(kFloats, mask, bytes);
  return bytes[0];
}

template <class F>
HWY_INLINE void for_bits(unsigned mask, F&& f) {
  for (; mask; mask &= mask - 1) f(int(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask)));
}

// Finite, so that no product is infinity times zero.
HWY_INLINE float finite_inverse(float d) {
  return std::abs(d) < 1e-30f ? std::copysign(1e30f, d) : 1 / d;
}

// Boxes are widened by what a float hit may be off by (shape/sphere.h, triangle.h: a few epsilons
// of the numbers at hand), in the place where it is free: the ray has one origin for near planes,
// one for far.
struct SlabRay {
  int near[3];  // which of planes[2] the ray meets first
  float near_origin[3], far_origin[3], inverse[3];

  SlabRay(const Ray& ray, float reach) {
    const float slack = 8 * kEpsilon * (reach + max_component(abs(ray.origin)));
    for (int a = 0; a < 3; ++a) {
      const float d = ray.dir[a];
      near[a] = std::signbit(d);
      const float towards = near[a] ? -slack : slack;
      near_origin[a] = ray.origin[a] + towards;
      far_origin[a] = ray.origin[a] - towards;
      inverse[a] = finite_inverse(d);
    }
  }
};

// Which of the boxes the ray meets before `tmax`, and where it enters them.
HWY_INLINE unsigned meet_boxes(const EightBoxes& boxes, const SlabRay& ray, float tmax,
                               float* enter) {
  unsigned mask = 0;
  for (int i = 0; i < kBvhWidth; i += kLanes) {
    V from = hn::Zero(kFloats), to = set(tmax);
    for (int a = 0; a < 3; ++a) {
      const V inverse = set(ray.inverse[a]);
      const V lo = load(&boxes.planes[ray.near[a]][a][i]);
      const V hi = load(&boxes.planes[1 - ray.near[a]][a][i]);
      from = hn::Max(from, hn::Mul(hn::Sub(lo, set(ray.near_origin[a])), inverse));
      to = hn::Min(to, hn::Mul(hn::Sub(hi, set(ray.far_origin[a])), inverse));
    }
    // Four roundings: Ize 2013, "Robust BVH Ray Traversal", JCGT 2(2).
    mask |= bits(hn::Le(from, hn::Mul(to, set(1 + 4 * kEpsilon)))) << i;
    hn::StoreU(from, kFloats, enter + i);
  }
  return mask;
}

// Offers every lane whose distance can be the nearest; true if one was taken.
HWY_INLINE bool offer_lanes(RayQuery& query, const ItemId* items, unsigned mask, const float* t,
                            const float* u = nullptr, const float* v = nullptr) {
  bool taken = false;
  for_bits(mask, [&](int i) { taken |= query.offer(t[i], items[i], u ? u[i] : 0, v ? v[i] : 0); });
  return taken;
}

// Distances to the spheres whose centres lie at (x, y, z) from the rays' origins, and which of them
// are hit in front of the ray. shape/sphere.h explains.
struct SphereLanes {
  M in;
  V t;
};
HWY_INLINE SphereLanes sphere_test(V x, V y, V z, V radius, V dx, V dy, V dz) {
  const V zero = hn::Zero(kFloats);
  const V middle = dot(x, y, z, dx, dy, dz);
  const V px = hn::Sub(x, hn::Mul(dx, middle));
  const V py = hn::Sub(y, hn::Mul(dy, middle));
  const V pz = hn::Sub(z, hn::Mul(dz, middle));
  const V d2 = hn::Sub(hn::Mul(radius, radius), dot(px, py, pz, px, py, pz));
  const M hit = hn::Ge(d2, zero);
  if (hn::AllFalse(kFloats, hit)) return {hit, zero};
  const V half = hn::Sqrt(hn::Max(d2, zero));
  const V entry = hn::Sub(middle, half);
  const V t = hn::IfThenElse(hn::Gt(entry, zero), entry, hn::Add(middle, half));
  return {hn::And(hit, hn::Gt(t, zero)), t};
}

HWY_INLINE bool meet_spheres(const SphereBlock& block, RayQuery& query) {
  const Ray& ray = query.ray;
  alignas(32) float t[kBvhWidth];
  unsigned mask = 0;
  for (int i = 0; i < kBvhWidth; i += kLanes) {
    const SphereLanes hit =
        sphere_test(hn::Sub(load(block.x + i), set(ray.origin.x)),
                    hn::Sub(load(block.y + i), set(ray.origin.y)),
                    hn::Sub(load(block.z + i), set(ray.origin.z)), load(block.radius + i),
                    set(ray.dir.x), set(ray.dir.y), set(ray.dir.z));
    if (hn::AllFalse(kFloats, hit.in)) continue;
    hn::StoreU(hit.t, kFloats, t + i);
    mask |= bits(hn::And(hit.in, hn::Le(hit.t, set(query.best.t)))) << i;
  }
  return mask && offer_lanes(query, block.item, mask, t);
}

// Distances and weights of the triangles with sheared corners (x, y, z), and which of them are hit
// in front of the ray. shape/triangle.h explains.
struct TriangleLanes {
  M in;
  V t, u, v;
};
HWY_INLINE TriangleLanes edge_test(const V* x, const V* y, const V* z) {
  const V zero = hn::Zero(kFloats);
  const V u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
  const V v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
  const V w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
  const M minus = hn::Or(hn::Or(hn::Lt(u, zero), hn::Lt(v, zero)), hn::Lt(w, zero));
  const M plus = hn::Or(hn::Or(hn::Gt(u, zero), hn::Gt(v, zero)), hn::Gt(w, zero));
  const M out = hn::And(minus, plus);
  if (hn::AllTrue(kFloats, out)) return {hn::Not(out), zero, zero, zero};
  const V det = hn::Add(hn::Add(u, v), w);
  const V t = hn::Div(hn::Add(hn::Add(hn::Mul(u, z[0]), hn::Mul(v, z[1])), hn::Mul(w, z[2])), det);
  return {hn::AndNot(out, hn::And(hn::Ne(det, zero), hn::Gt(t, zero))), t, hn::Div(v, det),
          hn::Div(w, det)};
}

HWY_INLINE bool meet_triangles(const TriangleBlock& block, RayQuery& query) {
  const ShearedRay& s = query.sheared;
  const Vec3f o = query.ray.origin;
  const V ox = set(o[s.kx]), oy = set(o[s.ky]), oz = set(o[s.kz]);
  const V sx = set(s.sx), sy = set(s.sy), sz = set(s.sz);
  alignas(32) float t[kBvhWidth], b1[kBvhWidth], b2[kBvhWidth];
  unsigned mask = 0;
  for (int i = 0; i < kBvhWidth; i += kLanes) {
    V x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
      const V depth = hn::Sub(load(&block.corner[k][s.kz][i]), oz);
      x[k] = hn::Sub(hn::Sub(load(&block.corner[k][s.kx][i]), ox), hn::Mul(sx, depth));
      y[k] = hn::Sub(hn::Sub(load(&block.corner[k][s.ky][i]), oy), hn::Mul(sy, depth));
      z[k] = hn::Mul(sz, depth);
    }
    const TriangleLanes hit = edge_test(x, y, z);
    hn::StoreU(hit.t, kFloats, t + i);
    hn::StoreU(hit.u, kFloats, b1 + i);
    hn::StoreU(hit.v, kFloats, b2 + i);
    mask |= bits(hn::And(hit.in, hn::Le(hit.t, set(query.best.t)))) << i;
  }
  return mask && offer_lanes(query, block.item, mask, t, b1, b2);
}

// Cones need double, and so go one after another; but most are missed by their box already.
HWY_INLINE bool meet_cones(const Geometry& g, const ConeBlock& block, const SlabRay& slabs,
                           RayQuery& query) {
  float enter[kBvhWidth];
  bool taken = false;
  for_bits(meet_boxes(block.boxes, slabs, query.best.t, enter), [&](int i) {
    if (enter[i] <= query.best.t) taken |= test_cone(g, item_index(block.item[i]), query);
  });
  return taken;
}

// One after another, for the rare surfaces that are seen from one side only.
HWY_INLINE bool meet_items(const Geometry& g, const ItemId* items, RayQuery& query) {
  bool taken = false;
  for (int i = 0; i < kBvhWidth && items[i] != kNoItem; ++i) taken |= test_item(g, items[i], query);
  return taken;
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
