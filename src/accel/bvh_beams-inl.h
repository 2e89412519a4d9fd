// Rays that keep together as a stream through the eight-wide tree, sixteen at a time: a beam, the
// intervals of their origins and directions, meets what any of them could meet, with one test for
// all; in the leaves one primitive is tested against the sixteen rays. Included by bvh_trace.cpp
// only, once for each instruction set.
//
// Wald, Boulos and Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume
// Hierarchies", ACM TOG 26(1).
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_ACCEL_BVH_BEAMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BVH_BEAMS_INL_H_
#undef RAIO_ACCEL_BVH_BEAMS_INL_H_
#else
#define RAIO_ACCEL_BVH_BEAMS_INL_H_
#endif

#include "accel/bvh_rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

struct alignas(64) Beam {
  float inverse[2][4], offset[2][4];  // see BoxLanes::meet
  // The cone around all rays: at a distance of s its radius is start + s * widening.
  float o[4], d[4], start, widening;
  float t;              // of the farthest ray; negative: all are done
  const uint8_t* axes;  // kShearAxes of all rays
  int tests_left;
  bool formed;
};

// Of four numbers of sixteen rays, the smallest and largest each.
constexpr int kParts16 = kPacket / kLanes16;
const hn::CappedTag<float, 4> kFour;
using V4 = hn::Vec<decltype(kFour)>;
constexpr int kLanes4 = int(hn::MaxLanes(decltype(kFour)()));
struct alignas(16) Extents {
  float lo[4], hi[4];

  HWY_INLINE explicit Extents(const V16 (*x)[kParts16]) {
    reduce(x, lo, [](auto a, auto b) HWY_ATTR { return hn::Min(a, b); });
    reduce(x, hi, [](auto a, auto b) HWY_ATTR { return hn::Max(a, b); });
  }

 private:
  template <class Op>
  static HWY_INLINE void reduce(const V16 (*x)[kParts16], float* out, Op&& op) {
    V16 y[4];
    for (int k = 0; k < 4; ++k) {
      y[k] = x[k][0];
      for (int p = 1; p < kParts16; ++p) y[k] = op(y[k], x[k][p]);
    }
#if HWY_TARGET == HWY_SCALAR
    for (int k = 0; k < 4; ++k) out[k] = hn::GetLane(y[k]);
#else
    const auto& f = kSixteen;
    const hn::Repartition<double, decltype(kSixteen)> pairs;
    // Per block of four lanes: 0 1 0 1, then 0 1 2 3.
    const V16 y01 = op(hn::InterleaveLower(f, y[0], y[1]), hn::InterleaveUpper(f, y[0], y[1]));
    const V16 y23 = op(hn::InterleaveLower(f, y[2], y[3]), hn::InterleaveUpper(f, y[2], y[3]));
    const auto u = hn::BitCast(pairs, y01), v = hn::BitCast(pairs, y23);
    const V16 all = op(hn::BitCast(f, hn::InterleaveLower(pairs, u, v)),
                       hn::BitCast(f, hn::InterleaveUpper(pairs, u, v)));
    alignas(64) float blocks[kLanes16];
    hn::Store(all, f, blocks);
    V4 block = hn::Load(kFour, blocks);
    for (int i = 4; i < kLanes16; i += 4) block = op(block, hn::Load(kFour, blocks + i));
    hn::Store(block, kFour, out);
#endif
  }
};

template <bool any>
class Beams {
 public:
  Beams(const Geometry& geometry, const Bvh& bvh, const Batch& batch, Beam* room,
        TraceContext& context)
      : g_(geometry), bvh_(bvh), batch_(batch), beams_(room), context_(context) {}

  // Beam number `id`, of the rays from 16 * id; false if they do not keep together.
  HWY_INLINE bool form(uint32_t id) {
    const size_t first = size_t(id) * kPacket;
    const auto& f = kSixteen;
    Beam& beam = beams_[id];
    beam.formed = false;
    beam.t = -1;
    unsigned alive = 0;
    for (int i = 0; i < kPacket; i += kLanes16)
      alive |= bits(f, hn::Gt(hn::Load(f, batch_.t + first + i), hn::Zero(f))) << i;
    if (alive == 0) return true;  // nothing to do
    const int n_alive = int(hwy::PopCount(alive));
    if (n_alive < kFewest) return false;
    // Those that are done stand aside: in the place of one that is not.
    const size_t one = first + hwy::Num0BitsBelowLS1Bit_Nonzero32(alive);
    V16 origin_t[4][kParts16], dir_axes[4][kParts16];
    for (int p = 0; p < kParts16; ++p) {
      const size_t i = first + size_t(p * kLanes16);
      const M16 counts = hn::Gt(hn::Load(f, batch_.t + i), hn::Zero(f));
      const auto column = [&](const float* c) HWY_ATTR {
        return hn::IfThenElse(counts, hn::Load(f, c + i), hn::Set(f, c[one]));
      };
      for (int a = 0; a < 3; ++a) {
        origin_t[a][p] = column(batch_.o[a]);
        dir_axes[a][p] = column(batch_.d[a]);
      }
      origin_t[3][p] = column(batch_.t);
      dir_axes[3][p] = bvh_.triangles.empty() ? hn::Zero(f) : column(batch_.axes);
    }
    Extents dirs(dir_axes);
    const float spread = extent(dirs);
    if (!(spread < kMaxSpread)) return false;
    for (int a = 0; a < 3; ++a)
      if (std::signbit(dirs.lo[a]) != std::signbit(dirs.hi[a])) return false;
    if (dirs.lo[3] != dirs.hi[3]) return false;
    beam.axes = kShearAxes[int(dirs.lo[3])];
    Extents origins(origin_t);
    beam.t = origins.hi[3];
    float size = std::max(bvh_.reach, largest(origins));
    // Shadow rays that end in one point (a light) are taken from there: their origins lie apart,
    // and as an interval of origins they would meet much that none of them meets. (The order of
    // what they meet is then from the light, which is as good for any hit.)
    if (any && beam.t < kInfinity) {
      for (int p = 0; p < kParts16; ++p)
        for (int a = 0; a < 3; ++a)
          origin_t[a][p] = hn::MulAdd(dir_axes[a][p], origin_t[3][p], origin_t[a][p]);
      const Extents ends(origin_t);
      // Directions to a light that has a size differ by its own, which counts less.
      if (!(spread - extent(ends) / beam.t < kMaxSpreadToPoint)) return false;
      if (extent(ends) < extent(origins)) {
        size = std::max(size, largest(ends));
        origins = ends;
        for (int a = 0; a < 3; ++a) {
          const float lo = dirs.lo[a];
          dirs.lo[a] = -dirs.hi[a], dirs.hi[a] = -lo;
        }
      }
    }
    enclose(beam, origins, dirs, 2 * kSlack * size);
    beam.tests_left = kMostTests * n_alive;
    beam.formed = true;
    return true;
  }

  // The sixteen rays from 16 * id against everything, for trees that are but a few blocks.
  HWY_INLINE void meet_all(uint32_t id) {
    const auto all = [&](const auto& blocks, auto&& test) {
      for (const auto& block : blocks) {
        for_bits(BoxLanes::named(block.item), [&](int k) { test(block, k); });
        context_.tests += kBvhWidth * kPacket;
      }
    };
    all(bvh_.spheres, [&](const SphereBlock& b, int k) { meet_sphere(b, k, id); });
    all(bvh_.triangles, [&](const TriangleBlock& b, int k) { meet_triangle<false>(b, k, id); });
    all(bvh_.cones, [&](const ConeBlock& b, int k) { meet_cone(b, k, id); });
  }

  bool gave_up(uint32_t id) const { return beams_[id].formed && beams_[id].tests_left < 0; }
  bool alive(uint32_t id) const { return beams_[id].t > 0; }

  void visits(size_t n) { context_.steps += n; }

  HWY_INLINE unsigned meet(uint32_t id, const BoxLanes& boxes, V8* nearest) const {
    const Beam& b = beams_[id];
    return boxes.meet(b.inverse[0], b.inverse[1], b.offset[0], b.offset[1], b.t, nearest);
  }

  HWY_INLINE void leaf(uint32_t ref, const uint32_t* ids, size_t n) {
    const uint32_t block = bvh_index(ref);
    V8 unused[kParts];
    for (V8& x : unused) x = hn::Zero(kEight);
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
    switch (bvh_kind(ref)) {
      case BvhChild::spheres: {
        const SphereBlock& spheres = bvh_.spheres[block];
        return each([&](uint32_t id) { return near_spheres(spheres, beams_[id]); },
                    [&](int k, uint32_t id) { meet_sphere(spheres, k, id); });
      }
      case BvhChild::triangles: {
        const TriangleBlock& triangles = bvh_.triangles[block];
        const BoxLanes boxes(triangles);
        return each([&](uint32_t id) { return meet(id, boxes, unused); },
                    [&](int k, uint32_t id) { meet_triangle<true>(triangles, k, id); });
      }
      default: {
        const ConeBlock& cones = bvh_.cones[block];
        const BoxLanes boxes(cones.boxes, cones.item);
        return each([&](uint32_t id) { return meet(id, boxes, unused); },
                    [&](int k, uint32_t id) { meet_cone(cones, k, id); });
      }
    }
  }

 private:
  // Measured.
  static constexpr int kFewest = any ? 8 : 3;  // rays that count
  static constexpr float kMaxSpread = 0.15f;   // of the directions, over three axes; measured
  static constexpr float kMaxSpreadToPoint = 0.05f;
  // Primitives tested, per ray. Where they are smaller than the rays are apart, the beam meets most
  // that no ray does, and each ray on its own is faster.
  static constexpr int kMostTests = 4;

  static float largest(const Extents& x) {
    return max_component(
        max(abs(Vec3f(x.lo[0], x.lo[1], x.lo[2])), abs(Vec3f(x.hi[0], x.hi[1], x.hi[2]))));
  }
  static float extent(const Extents& x) {
    return x.hi[0] - x.lo[0] + x.hi[1] - x.lo[1] + x.hi[2] - x.lo[2];
  }

  static HWY_INLINE void enclose(Beam& beam, const Extents& origins, const Extents& dirs,
                                 float slack) {
    const auto& f = kFour;
    const V4 half = hn::Set(f, 0.5f), away = hn::Set(f, slack);
    alignas(16) float width[4], breadth[4];
    for (int i = 0; i < 4; i += kLanes4) {
      const V4 lo = hn::Load(f, dirs.lo + i), hi = hn::Load(f, dirs.hi + i);
      const V4 origin_lo = hn::Load(f, origins.lo + i), origin_hi = hn::Load(f, origins.hi + i);
      // The sign of a direction is that of all, so that these are the earliest and latest.
      const V4 lower = finite_inverse(f, hi), upper = finite_inverse(f, lo);
      hn::Store(lower, f, beam.inverse[0] + i);
      hn::Store(upper, f, beam.inverse[1] + i);
      hn::Store(hn::Mul(hn::Add(origin_hi, away), lower), f, beam.offset[0] + i);
      hn::Store(hn::Mul(hn::Sub(origin_lo, away), upper), f, beam.offset[1] + i);
      hn::Store(hn::Mul(hn::Add(lo, hi), half), f, beam.d + i);
      hn::Store(hn::Add(hn::Mul(origin_lo, half), hn::Mul(origin_hi, half)), f, beam.o + i);
      hn::Store(hn::Sub(hi, lo), f, width + i);
      hn::Store(hn::Sub(origin_hi, origin_lo), f, breadth + i);
    }
    // The middle is not far from unit length: one step of Newton's method, squared error.
    const float* const d = beam.d;
    const float error = 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    for (int a = 0; a < 3; ++a) beam.d[a] *= 1 + 0.5f * error;
    const auto diagonal = [](const float* x) { return length(Vec3f(x[0], x[1], x[2])); };
    const float spread = 0.5f * diagonal(width) + error + 8 * kEpsilon;
    // |o_i + s d_i - (o + s d)| <= start + s spread, and s <= (along + radius + start) / (1 -
    // spread) where a sphere is met whose centre lies `along` the axis.
    beam.widening = spread / (1 - spread);
    beam.start = 0.5f * diagonal(breadth) + slack;
  }

  // Which of the spheres reach into the cone around the beam.
  static HWY_INLINE unsigned near_spheres(const SphereBlock& block, const Beam& b) {
    const auto& f = kEight;
    unsigned mask = 0;
    for (int i = 0; i < kBvhWidth; i += kLanes8) {
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
          const uint8_t* const order = beams_[id].axes;
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
  const Bvh& bvh_;
  const Batch& batch_;
  Beam* beams_;
  TraceContext& context_;
};

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
