// Eight rays together against eight boxes or one primitive: what the walks of the eight-wide tree
// do for rays that keep together. Included by bvh_trace.cpp only, once for each instruction set.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_ACCEL_BVH_PACKET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BVH_PACKET_INL_H_
#undef RAIO_ACCEL_BVH_PACKET_INL_H_
#else
#define RAIO_ACCEL_BVH_PACKET_INL_H_
#endif

#include "accel/bvh_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

// All rays of a packet at once, as intervals of origin and direction: what a box must meet to be
// met by any of them. One test for eight rays and eight boxes. Wald, Boulos and Shirley 2007, "Ray
// Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 26(1).
struct RayInterval {
  int near[3];
  float near_origin[3], far_origin[3], inverse_lo[3], inverse_hi[3];

  // Directions have one sign on each axis.
  RayInterval(const Box3f& origins, const Box3f& dirs, float slack) {
    for (int a = 0; a < 3; ++a) {
      near[a] = std::signbit(dirs.lo[a]);
      const float lo = origins.lo[a] - slack, hi = origins.hi[a] + slack;
      near_origin[a] = near[a] ? lo : hi;
      far_origin[a] = near[a] ? hi : lo;
      inverse_lo[a] = finite_inverse(dirs.hi[a]);
      inverse_hi[a] = finite_inverse(dirs.lo[a]);
    }
  }

  // `plane(side, axis, i)`: the lower or upper planes of boxes i, i + 1, ...
  template <class F>
  HWY_INLINE unsigned meet(F&& plane, float tmax, float* enter) const {
    unsigned mask = 0;
    for (int i = 0; i < kBvhWidth; i += kLanes) {
      V from = hn::Zero(kFloats), to = set(tmax);
      for (int a = 0; a < 3; ++a) {
        const V lo = set(inverse_lo[a]), hi = set(inverse_hi[a]);
        const V x = hn::Sub(plane(near[a], a, i), set(near_origin[a]));
        const V y = hn::Sub(plane(1 - near[a], a, i), set(far_origin[a]));
        from = hn::Max(from, hn::Min(hn::Mul(x, lo), hn::Mul(x, hi)));
        to = hn::Min(to, hn::Max(hn::Mul(y, lo), hn::Mul(y, hi)));
      }
      mask |= bits(hn::Le(from, hn::Mul(to, set(1 + 8 * kEpsilon)))) << i;
      hn::StoreU(from, kFloats, enter + i);
    }
    return mask;
  }
};

// Eight rays and their nearest hits so far, one array per number. A lane whose distance is negative
// is done with: nothing is nearer.
struct alignas(32) Packet {
  float o[3][kBvhWidth], d[3][kBvhWidth];
  float t[kBvhWidth], u[kBvhWidth] = {}, v[kBvhWidth] = {};
  ItemId item[kBvhWidth];
  float shear[3][kBvhWidth];  // as ShearedRay, whose axes are those of all lanes
  int kx, ky, kz;
  float inverse[3][kBvhWidth];
  float slack;

  float farthest() const { return *std::max_element(t, t + kBvhWidth); }

  // Takes hits that are nearer, in lanes of `valid` among i, i + 1, ...; at equal distance the
  // lower id.
  HWY_INLINE void offer(int i, M valid, V distance, ItemId id, V b1, V b2) {
    const V best = load(t + i);
    const unsigned not_farther = bits(hn::And(valid, hn::Le(distance, best)));
    if (not_farther == 0) return;
    float at[kBvhWidth], at_u[kBvhWidth], at_v[kBvhWidth];
    hn::StoreU(distance, kFloats, at);
    hn::StoreU(b1, kFloats, at_u);
    hn::StoreU(b2, kFloats, at_v);
    for_bits(not_farther, [&](int k) {
      const int lane = i + k;
      if (at[k] == t[lane] && (item[lane] == kNoItem || id >= item[lane])) return;
      t[lane] = at[k], u[lane] = at_u[k], v[lane] = at_v[k], item[lane] = id;
    });
  }
};

HWY_INLINE void meet_sphere(const SphereBlock& block, int lane, Packet& p) {
  const V x = set(block.x[lane]), y = set(block.y[lane]), z = set(block.z[lane]);
  for (int i = 0; i < kBvhWidth; i += kLanes) {
    const SphereLanes hit = sphere_test(hn::Sub(x, load(p.o[0] + i)), hn::Sub(y, load(p.o[1] + i)),
                                        hn::Sub(z, load(p.o[2] + i)), set(block.radius[lane]),
                                        load(p.d[0] + i), load(p.d[1] + i), load(p.d[2] + i));
    if (hn::AllFalse(kFloats, hit.in)) continue;
    p.offer(i, hit.in, hit.t, block.item[lane], hn::Zero(kFloats), hn::Zero(kFloats));
  }
}

HWY_INLINE void meet_triangle(const TriangleBlock& block, int lane, Packet& p) {
  for (int i = 0; i < kBvhWidth; i += kLanes) {
    V x[3], y[3], z[3];
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](int axis) {
        return hn::Sub(set(block.corner[k][axis][lane]), load(p.o[axis] + i));
      };
      const V depth = corner(p.kz);
      x[k] = hn::Sub(corner(p.kx), hn::Mul(load(p.shear[0] + i), depth));
      y[k] = hn::Sub(corner(p.ky), hn::Mul(load(p.shear[1] + i), depth));
      z[k] = hn::Mul(load(p.shear[2] + i), depth);
    }
    const TriangleLanes hit = edge_test(x, y, z);
    if (hn::AllFalse(kFloats, hit.in)) continue;
    p.offer(i, hit.in, hit.t, block.item[lane], hit.u, hit.v);
  }
}

// Lane by lane, where the box of the cone is met.
HWY_INLINE void meet_cone(const Geometry& g, const ConeBlock& block, int lane, Packet& p) {
  unsigned mask = 0;
  for (int i = 0; i < kBvhWidth; i += kLanes) {
    V from = hn::Zero(kFloats), to = load(p.t + i);
    for (int a = 0; a < 3; ++a) {
      const V inverse = load(p.inverse[a] + i), o = load(p.o[a] + i);
      const V x = hn::Mul(hn::Sub(set(block.boxes.planes[0][a][lane] - p.slack), o), inverse);
      const V y = hn::Mul(hn::Sub(set(block.boxes.planes[1][a][lane] + p.slack), o), inverse);
      from = hn::Max(from, hn::Min(x, y));
      to = hn::Min(to, hn::Max(x, y));
    }
    mask |= bits(hn::Le(from, hn::Mul(to, set(1 + 4 * kEpsilon)))) << i;
  }
  for_bits(mask, [&](int i) {
    RayQuery query({{p.o[0][i], p.o[1][i], p.o[2][i]}, {p.d[0][i], p.d[1][i], p.d[2][i]}, p.t[i]});
    query.best.item = p.item[i];
    if (test_cone(g, item_index(block.item[lane]), query))
      p.t[i] = query.best.t, p.item[i] = query.best.item, p.u[i] = p.v[i] = 0;
  });
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
