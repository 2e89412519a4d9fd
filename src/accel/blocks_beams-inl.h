// Rays that keep together, as a crowd that walks tree or grid, sixteen at a time: a beam, the
// intervals of their origins and directions, meets what any of them could meet, with one test for
// all; in the leaves one primitive is tested against the sixteen rays. Included by
// blocks_tracer-inl.h only, once for each instruction set.
//
// Wald, Boulos and Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume
// Hierarchies", ACM TOG 26(1).
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_ACCEL_BLOCKS_BEAMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BLOCKS_BEAMS_INL_H_
#undef RAIO_ACCEL_BLOCKS_BEAMS_INL_H_
#else
#define RAIO_ACCEL_BLOCKS_BEAMS_INL_H_
#endif

#include "accel/blocks_form-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

template <bool any>
class Beams {
 public:
  static constexpr bool kAny = any;

  Beams(const Geometry& geometry, const Blocks& blocks, const Batch& batch, BeamRoom& room,
        TraceContext& context)
      : g_(geometry), blocks_(blocks), batch_(batch), beams_(room.beams), context_(context) {}

  // The sixteen rays from 16 * id against everything, for trees that are but a few blocks.
  HWY_INLINE void meet_all(uint32_t id) {
    const auto all = [&](const auto& blocks, auto&& test) {
      for (const auto& block : blocks) {
        for_bits(BoxLanes::named(block.item), [&](int k) { test(block, k); });
        context_.tests += kBlockWidth * kPacket;
      }
    };
    all(blocks_.spheres, [&](const SphereBlock& b, int k) { meet_sphere(b, k, id); });
    all(blocks_.triangles, [&](const TriangleBlock& b, int k) { meet_triangle<false>(b, k, id); });
    all(blocks_.cones, [&](const ConeBlock& b, int k) { meet_cone(b, k, id); });
  }

  // The sixteen rays against all primitives of a block.
  HWY_INLINE void meet_block(uint32_t ref, uint32_t id) {
    const ItemId* const items = blocks_.items(ref);
    const uint32_t i = ref_index(ref);
    for (int k = 0; k < kBlockWidth && items[k] != kNoItem; ++k) {
      context_.tests += kPacket;
      if (ref_pool(ref) == Pool::spheres)
        meet_sphere(blocks_.spheres[i], k, id);
      else if (ref_pool(ref) == Pool::triangles)
        meet_triangle<false>(blocks_.triangles[i], k, id);
      else
        meet_cone(blocks_.cones[i], k, id);
    }
  }

  bool gave_up(uint32_t id) const { return beams_[id].tests_left < 0; }
  bool alive(uint32_t id) const { return beams_[id].t > 0; }

  void visits(size_t n) { context_.steps += n; }
  float end(uint32_t id) const { return beams_[id].t; }
  Sweep sweep(uint32_t id) const {
    const Beam& b = beams_[id];
    return {b.o, b.d, b.start, b.widening};
  }

  HWY_INLINE unsigned meet(uint32_t id, const BoxLanes& boxes, V8* nearest = nullptr) const {
    const Beam& b = beams_[id];
    return boxes.meet(b.inverse[0], b.inverse[1], b.offset[0], b.offset[1], b.t, nearest);
  }

  HWY_INLINE void leaf(uint32_t ref, const uint32_t* ids, size_t n) {
    const uint32_t block = ref_index(ref);
    const auto each = [&](auto&& which, auto&& test) {
      for (size_t i = 0; i < n; ++i) {
        Beam& b = beams_[ids[i]];
        if (!(b.t > 0)) continue;
        const unsigned mask = which(ids[i]);
        if (mask == 0) continue;
        const int tests = int(hwy::PopCount(mask));
        for_bits(mask, [&](int k) { test(k, ids[i]); });
        context_.tests += uint64_t(tests) * kPacket;
        V16 farthest = hn::Zero(kSixteen);
        for (int k = 0; k < kPacket; k += kLanes16)
          farthest = hn::Max(farthest, hn::Load(kSixteen, batch_.t + ids[i] * kPacket + k));
        b.t = hn::GetLane(hn::MaxOfLanes(kSixteen, farthest));
        if (b.t == 0) b.t = -1;
        b.tests_left -= tests;
        if (b.tests_left < 0) b.t = -1;
      }
    };
    switch (ref_pool(ref)) {
      case Pool::spheres: {
        const SphereBlock& spheres = blocks_.spheres[block];
        return each([&](uint32_t id) { return near_spheres(spheres, beams_[id]); },
                    [&](int k, uint32_t id) { meet_sphere(spheres, k, id); });
      }
      case Pool::triangles: {
        const TriangleBlock& triangles = blocks_.triangles[block];
        const BoxLanes boxes(triangles);
        return each([&](uint32_t id) { return meet(id, boxes); },
                    [&](int k, uint32_t id) { meet_triangle<true>(triangles, k, id); });
      }
      default: {
        const ConeBlock& cones = blocks_.cones[block];
        const BoxLanes boxes(cones.boxes, cones.item);
        return each([&](uint32_t id) { return meet(id, boxes); },
                    [&](int k, uint32_t id) { meet_cone(cones, k, id); });
      }
    }
  }

 private:
  // Which of the spheres reach into the cone around the beam.
  static HWY_INLINE unsigned near_spheres(const SphereBlock& block, const Beam& b) {
    const auto& f = kEight;
    unsigned mask = 0;
    for (int i = 0; i < kBlockWidth; i += kLanes8) {
      const V8 dx = hn::Set(f, b.d[0]), dy = hn::Set(f, b.d[1]), dz = hn::Set(f, b.d[2]);
      const V8 x = hn::Sub(hn::Load(f, block.x + i), hn::Set(f, b.o[0]));
      const V8 y = hn::Sub(hn::Load(f, block.y + i), hn::Set(f, b.o[1]));
      const V8 z = hn::Sub(hn::Load(f, block.z + i), hn::Set(f, b.o[2]));
      const V8 along = dot(f, x, y, z, dx, dy, dz);
      const V8 px = hn::NegMulAdd(dx, along, x), py = hn::NegMulAdd(dy, along, y);
      const V8 pz = hn::NegMulAdd(dz, along, z);
      const V8 off2 = dot(f, px, py, pz, px, py, pz);
      const V8 thick = hn::Add(hn::Load(f, block.radius + i), hn::Set(f, b.start));
      const V8 reach = hn::MulAdd(hn::Add(along, thick), hn::Set(f, b.widening), thick);
      const M8 beside = hn::Le(off2, hn::Mul(reach, reach));
      const M8 in_front = hn::Ge(hn::Min(reach, hn::Add(along, reach)), hn::Zero(f));
      const M8 in_time = hn::Le(hn::Sub(along, reach), hn::Set(f, b.t));
      mask |= bits(f, hn::And(hn::And(beside, in_front), in_time)) << i;
    }
    return mask;
  }

  // Takes hits that are nearer, in lanes of `valid` among rays i, i + 1, ...; at equal distance the
  // lower id.
  HWY_INLINE void offer(size_t i, M16 valid, V16 t, ItemId item, V16 u, V16 v) {
    const auto& f = kSixteen;
    const V16 best = hn::Load(f, batch_.t + i);
    M16 taken = hn::And(valid, nearer<any>(f, t, best));
    if (hn::AllFalse(f, taken)) return;
    if constexpr (any) {
      hn::Store(hn::IfThenElse(taken, hn::Set(f, kHidden), best), f, batch_.t + i);
    } else {
      const hn::RebindToUnsigned<decltype(kSixteen)> id;
      const auto old = hn::Load(id, batch_.item + i);
      // No item is the highest id of all, but what ends there is not met.
      const auto lower = hn::And(hn::Lt(hn::Set(id, item), old), hn::Ne(old, hn::Set(id, kNoItem)));
      taken = hn::And(taken, hn::Or(hn::Lt(t, best), hn::RebindMask(f, lower)));
      hn::BlendedStore(t, taken, f, batch_.t + i);
      hn::BlendedStore(u, taken, f, batch_.u + i);
      hn::BlendedStore(v, taken, f, batch_.v + i);
      hn::BlendedStore(hn::Set(id, item), hn::RebindMask(id, taken), id, batch_.item + i);
    }
  }

  HWY_INLINE void meet_sphere(const SphereBlock& block, int k, uint32_t id) {
    const auto& f = kSixteen;
    const V16 x = hn::Set(f, block.x[k]), y = hn::Set(f, block.y[k]), z = hn::Set(f, block.z[k]);
    const V16 radius = hn::Set(f, block.radius[k]);
    for (size_t i = id * kPacket; i < (id + 1) * kPacket; i += kLanes16) {
      const auto hit = chord_test(
          f, hn::Sub(x, hn::Load(f, batch_.o[0] + i)), hn::Sub(y, hn::Load(f, batch_.o[1] + i)),
          hn::Sub(z, hn::Load(f, batch_.o[2] + i)), radius, hn::Load(f, batch_.d[0] + i),
          hn::Load(f, batch_.d[1] + i), hn::Load(f, batch_.d[2] + i));
      if (hn::AllFalse(f, hit.in)) continue;
      const V16 t = chord_distance(f, hit.middle, hit.d2);
      offer(i, hn::And(hit.in, hn::Gt(t, hn::Zero(f))), t, block.item[k], hn::Zero(f), hn::Zero(f));
    }
  }

  // Components along the axes of kShearAxes, lane by lane.
  static HWY_INLINE void permute(V16 axes, V16 x, V16 y, V16 z, V16& across, V16& along,
                                 V16& depth) {
    const auto& f = kSixteen;
    const M16 down = hn::Ge(axes, hn::Set(f, 3));
    const V16 axis = hn::IfThenElse(down, hn::Sub(axes, hn::Set(f, 3)), axes);
    const M16 first = hn::Lt(axis, hn::Set(f, 1)), last = hn::Gt(axis, hn::Set(f, 1));
    depth = hn::IfThenElse(first, x, hn::IfThenElse(last, z, y));
    const V16 next = hn::IfThenElse(first, y, hn::IfThenElse(last, x, z));
    const V16 after = hn::IfThenElse(first, z, hn::IfThenElse(last, y, x));
    across = hn::IfThenElse(down, after, next), along = hn::IfThenElse(down, next, after);
  }

  // `alike`: the rays are those of a beam, whose axes are the same.
  template <bool alike>
  HWY_INLINE void meet_triangle(const TriangleBlock& block, int k, uint32_t id) {
    const auto& f = kSixteen;
    for (size_t i = id * kPacket; i < (id + 1) * kPacket; i += kLanes16) {
      const V16 axes = hn::Load(f, batch_.axes + i);
      V16 x[3], y[3], z[3];
      for (int c = 0; c < 3; ++c) {
        const auto corner = [&](int a) HWY_ATTR {
          return hn::Sub(hn::Set(f, block.corner[c][a][k]), hn::Load(f, batch_.o[a] + i));
        };
        V16 across, along, depth;
        if (alike) {
          const uint8_t* const order = kShearAxes[beams_[id].axes];
          across = corner(order[0]), along = corner(order[1]), depth = corner(order[2]);
        } else {
          permute(axes, corner(0), corner(1), corner(2), across, along, depth);
        }
        x[c] = hn::Sub(across, hn::Mul(hn::Load(f, batch_.shear[0] + i), depth));
        y[c] = hn::Sub(along, hn::Mul(hn::Load(f, batch_.shear[1] + i), depth));
        z[c] = hn::Mul(hn::Load(f, batch_.shear[2] + i), depth);
      }
      const auto hit = edge_test(f, x, y, z);
      if (hn::AllFalse(f, hit.in)) continue;
      const V16 t = hn::Div(hit.t, hit.det);
      offer(i, hn::And(hit.in, hn::Gt(t, hn::Zero(f))), t, block.item[k], hn::Div(hit.u, hit.det),
            hn::Div(hit.v, hit.det));
    }
  }

  HWY_INLINE void meet_cone(const ConeBlock& block, int k, uint32_t id) {
    const DemotedTag narrow;
    const auto one = [&](const float* x) { return hn::Set(kDoubles, double(x[k])); };
    ConeInput c;
    for (int a = 0; a < 3; ++a) c.base[a] = one(block.base[a]), c.axis[a] = one(block.axis[a]);
    c.height = one(block.height), c.radius = one(block.radius), c.slope = one(block.slope);
    const auto& f = kSixteen;
    alignas(64) float t[kPacket];
    unsigned mask = 0;
    const size_t first = id * kPacket;
    for (size_t i = 0; i < kPacket; i += kLanesD) {
      for (int a = 0; a < 3; ++a) {
        c.origin[a] = hn::PromoteTo(kDoubles, hn::Load(narrow, batch_.o[a] + first + i));
        c.dir[a] = hn::PromoteTo(kDoubles, hn::Load(narrow, batch_.d[a] + first + i));
      }
      const ConeLanes hit = cone_test(c);
      mask |= bits(narrow, hit.in) << i;
      hn::Store(hit.t, narrow, t + i);
    }
    if (mask == 0) return;
    for (size_t i = 0; i < kPacket; i += kLanes16) {
      const uint8_t lanes[8] = {uint8_t(mask >> i), uint8_t(mask >> i >> 8)};
      offer(first + i, hn::LoadMaskBits(f, lanes), hn::Load(f, t + i), block.item[k], hn::Zero(f),
            hn::Zero(f));
    }
  }

  const Geometry& g_;
  const Blocks& blocks_;
  const Batch& batch_;
  Beam* beams_;
  TraceContext& context_;
};

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
