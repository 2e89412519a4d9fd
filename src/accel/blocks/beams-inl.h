// The ray group of beams, for traversing tree or grid. A beam is sixteen coherent rays, bounded by
// intervals of their origins and directions: one test finds everything that any of them might hit.
// In leaves, one primitive is tested against the sixteen rays. Included by blocks/tracer-inl.h
// only, once per instruction set (foreach_target.h).
//
// Wald, Boulos and Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume
// Hierarchies", ACM TOG 26(1).
#if defined(RAIO_ACCEL_BLOCKS_BEAMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BLOCKS_BEAMS_INL_H_
#undef RAIO_ACCEL_BLOCKS_BEAMS_INL_H_
#else
#define RAIO_ACCEL_BLOCKS_BEAMS_INL_H_
#endif

#include "accel/blocks/form-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <bool any>
class Beams {
 public:
  static constexpr bool kAny = any;

  Beams(const Blocks& blocks, const Batch& batch, BeamScratch& scratch, TraceContext& context)
      : blocks_(blocks), batch_(batch), scratch_(scratch), context_(context) {}

  // Tests the sixteen rays from 16 * id with everything, for trees of a few blocks.
  HWY_INLINE void intersect_all(uint32_t id) {
    visit_bounded_kinds([&]<PrimitiveKind kind>() HWY_ATTR {
      for (const auto& block : blocks_.of<kind>()) intersect_block(block, id);
    });
  }

  // Tests the sixteen rays with all primitives of a block.
  HWY_INLINE void intersect_block(uint32_t ref, uint32_t id) {
    visit_pool(blocks_, ref_pool(ref), [&](const auto& blocks) RAIO_INLINE_LAMBDA {
      intersect_block(blocks[ref_index(ref)], id);
    });
  }

  bool gave_up(uint32_t id) const { return scratch_.beams[id].tests_left < 0; }
  bool alive(uint32_t id) const { return scratch_.beams[id].t > 0; }

  void visits(uint32_t, size_t n) { context_.steps += n; }
  float end(uint32_t id) const { return scratch_.beams[id].t; }
  Sweep sweep(uint32_t id) const {
    const Beam& b = scratch_.beams[id];
    return {b.o, b.d, b.start, b.widening};
  }

  HWY_INLINE unsigned intersect(uint32_t id, const BoxLanes& boxes, V8* nearest = nullptr) const {
    const Beam& b = scratch_.beams[id];
    return boxes.intersect(b.inverse[0], b.inverse[1], b.offset[0], b.offset[1], b.t, nearest);
  }

  HWY_INLINE void leaf(uint32_t ref, const uint32_t* ids, size_t n) {
    visit_pool(blocks_, ref_pool(ref), [&](const auto& blocks) RAIO_INLINE_LAMBDA {
      leaf(blocks[ref_index(ref)], ids, n);
    });
  }

 private:
  HWY_INLINE void leaf(const SphereBlock& spheres, const uint32_t* ids, size_t n) {
    leaf(spheres, ids, n, [&](uint32_t id) HWY_ATTR { return near_spheres(spheres, id); });
  }
  HWY_INLINE void leaf(const TriangleBlock& triangles, const uint32_t* ids, size_t n) {
    const BoxLanes boxes(triangles);
    const EdgeLanes edges(triangles);
    leaf(triangles, ids, n, [&](uint32_t id) HWY_ATTR {
      const unsigned mask = intersect(id, boxes);
      return hwy::PopCount(mask) > 1 ? mask & near_triangles(triangles, edges, id) : mask;
    });
  }
  template <PrimitiveKind kind>
  HWY_INLINE void leaf(const Block<kind>& block, const uint32_t* ids, size_t n) {
    const BoxLanes boxes(block.boxes, block.primitive);
    leaf(block, ids, n, [&](uint32_t id) HWY_ATTR { return intersect(id, boxes); });
  }

  // First, `near` culls primitives for all beams; then each remaining primitive is tested with the
  // beam's sixteen rays; then the primitives that a ray may hit. No step branches on results, since
  // half of those branches would be mispredicted.
  template <class Block, class Near>
  HWY_INLINE void leaf(const Block& block, const uint32_t* ids, size_t n, Near&& near) {
    const hn::RebindToUnsigned<decltype(kEight)> lanes;
    for (size_t begin = 0, end; begin < n; begin = end) {
      size_t pairs = 0;
      for (end = begin; end < n && pairs + kBlockWidth <= BeamScratch::kPairs; ++end) {
        const uint32_t id = ids[end];
        if (!alive(id)) continue;
        const unsigned mask = near(id);
        scratch_.beams[id].tests_left -= int(hwy::PopCount(mask));
        for (int i = 0; i < kBlockWidth; i += kLanes8) {
          const uint8_t part[8] = {uint8_t(mask >> i)};
          const auto in = hn::LoadMaskBits(lanes, part);
          const auto pair = hn::Iota(lanes, id * kBlockWidth + uint32_t(i));
          hn::StoreU(hn::Compress(pair, in), lanes, scratch_.pairs + pairs);
          pairs += hn::CountTrue(lanes, in);
        }
      }
      context_.tests += pairs * kPacket;
      BeamCandidate* found = scratch_.candidates;
      for (size_t p = 0; p < pairs; ++p) {
        const uint32_t id = scratch_.pairs[p] / kBlockWidth;
        found = intersect<true>(block, int(scratch_.pairs[p] % kBlockWidth), id, found);
      }
      offer(block, found);
      for (size_t i = begin; i < end; ++i)
        if (alive(ids[i])) see_end(ids[i]);
    }
  }

  template <class Block>
  HWY_INLINE void intersect_block(const Block& block, uint32_t id) {
    BeamCandidate* found = scratch_.candidates;
    for (int k = 0; k < kBlockWidth && block.primitive[k] != kNoPrimitive; ++k)
      context_.tests += kPacket, found = intersect<false>(block, k, id, found);
    offer(block, found);
  }

  // Updates the farthest reach of the beam's rays after a leaf.
  HWY_INLINE void see_end(uint32_t id) {
    V16 farthest = hn::Zero(kSixteen);
    for (int k = 0; k < kPacket; k += kLanes16)
      farthest = hn::Max(farthest, hn::Load(kSixteen, batch_.t + id * kPacket + k));
    const float t = hn::GetLane(hn::MaxOfLanes(kSixteen, farthest));
    Beam& b = scratch_.beams[id];
    b.t = t == 0 || b.tests_left < 0 ? -1 : t;
  }

  // Which spheres overlap the cone around the beam.
  HWY_INLINE unsigned near_spheres(const SphereBlock& block, uint32_t id) const {
    const auto& f = kEight;
    const Beam& b = scratch_.beams[id];
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

  // Which triangles a line of the beam may pass through: excludes those for which all lines pass
  // one edge on one side and another edge on the other. For a line with origin o and direction d,
  // and an edge e from a vertex x, the sign of d . ((x - o) x e) tells the side; if d varies by
  // `turned` and o by `shifted`, it varies by at most turned . |(x - o) x e| + shifted |e|.
  HWY_INLINE unsigned near_triangles(const TriangleBlock& block, const EdgeLanes& edges,
                                     uint32_t id) const {
    const auto& f = kEight;
    const Beam& b = scratch_.beams[id];
    unsigned mask = 0;
    for (int p = 0; p < kParts; ++p) {
      V8 least = hn::Set(f, kInfinity), most = hn::Set(f, -kInfinity);
      for (int c = 0; c < 3; ++c) {
        V8 x[3];
        for (int a = 0; a < 3; ++a)
          x[a] = hn::Sub(hn::Load(f, &block.corner[c][a][p * kLanes8]), hn::Set(f, b.o[a]));
        V8 side = hn::Zero(f), apart = hn::Mul(hn::Set(f, b.shifted), edges.size[c][p]);
        for (int a = 0; a < 3; ++a) {
          const int next = (a + 1) % 3, last = (a + 2) % 3;
          const V8 normal =
              hn::MulSub(x[next], edges.edge[c][last][p], hn::Mul(x[last], edges.edge[c][next][p]));
          side = hn::MulAdd(hn::Set(f, b.d[a]), normal, side);
          apart = hn::MulAdd(hn::Set(f, b.turned[a]), hn::Abs(normal), apart);
        }
        least = hn::Min(least, hn::Add(side, apart));
        most = hn::Max(most, hn::Sub(side, apart));
      }
      const M8 missed = hn::And(hn::Lt(least, hn::Zero(f)), hn::Gt(most, hn::Zero(f)));
      mask |= bits(f, hn::Not(missed)) << (p * kLanes8);
    }
    return mask;
  }

  // Records hits at `t` for any-hit rays i, i + 1, ... in the lanes of `valid`.
  HWY_INLINE void occlude(size_t i, M16 valid, V16 t) const {
    const auto& f = kSixteen;
    const V16 end = hn::Load(f, batch_.t + i);
    const M16 before = hn::And(hn::Gt(t, hn::Zero(f)), hn::Lt(t, end));
    hn::Store(hn::IfThenElse(hn::And(valid, before), hn::Set(f, kOccluded), end), f, batch_.t + i);
  }

  // Takes hits of rays i, i + 1, ... that are nearer; at equal distance the lower id.
  HWY_INLINE void offer(size_t i, V16 t, PrimitiveId primitive, V16 u, V16 v) const {
    const auto& f = kSixteen;
    const hn::RebindToUnsigned<decltype(kSixteen)> id;
    const V16 best = hn::Load(f, batch_.t + i);
    const auto old = hn::Load(id, batch_.primitive + i);
    // No primitive has the highest id, but a hit at the ray's end does not count.
    const auto lower =
        hn::And(hn::Lt(hn::Set(id, primitive), old), hn::Ne(old, hn::Set(id, kNoPrimitive)));
    const M16 nearer = hn::Or(hn::Lt(t, best), hn::And(hn::Eq(t, best), hn::RebindMask(f, lower)));
    const M16 taken = hn::And(nearer, hn::Gt(t, hn::Zero(f)));
    hn::BlendedStore(t, taken, f, batch_.t + i);
    hn::BlendedStore(u, taken, f, batch_.u + i);
    hn::BlendedStore(v, taken, f, batch_.v + i);
    hn::BlendedStore(hn::Set(id, primitive), hn::RebindMask(id, taken), id, batch_.primitive + i);
  }

  HWY_INLINE void offer(const SphereBlock& block, const BeamCandidate* end) const {
    const V16 none = hn::Zero(kSixteen);
    for (const BeamCandidate* c = scratch_.candidates; c < end; ++c) {
      const V16 middle = hn::Load(kSixteen, c->t), d2 = hn::Load(kSixteen, c->det);
      offer(c->ray, chord_distance(kSixteen, middle, d2), block.primitive[c->lane], none, none);
    }
  }
  HWY_INLINE void offer(const TriangleBlock& block, const BeamCandidate* end) const {
    for (const BeamCandidate* c = scratch_.candidates; c < end; ++c) {
      const V16 det = hn::Load(kSixteen, c->det);
      const auto divided = [&](const float* x)
                               HWY_ATTR { return hn::Div(hn::Load(kSixteen, x), det); };
      offer(c->ray, divided(c->t), block.primitive[c->lane], divided(c->u), divided(c->v));
    }
  }
  template <PrimitiveKind kind>
  HWY_INLINE void offer(const Block<kind>&, const BeamCandidate*) const {}

  // Tests the sixteen rays of `id` with primitive k. Appends possible hits to `found` and returns
  // its new end, or settles them here. `in_beam`: the rays form a beam near the primitive;
  // otherwise most miss and return early.
  template <bool in_beam>
  HWY_INLINE BeamCandidate* intersect(const SphereBlock& block, int k, uint32_t id,
                                      BeamCandidate* found) const {
    const auto& f = kSixteen;
    const V16 x = hn::Set(f, block.x[k]), y = hn::Set(f, block.y[k]), z = hn::Set(f, block.z[k]);
    const V16 radius = hn::Set(f, block.radius[k]);
    for (size_t i = id * kPacket; i < (id + 1) * kPacket; i += kLanes16) {
      const auto hit = chord_test(
          f, hn::Sub(x, hn::Load(f, batch_.o[0] + i)), hn::Sub(y, hn::Load(f, batch_.o[1] + i)),
          hn::Sub(z, hn::Load(f, batch_.o[2] + i)), radius, hn::Load(f, batch_.d[0] + i),
          hn::Load(f, batch_.d[1] + i), hn::Load(f, batch_.d[2] + i));
      if (!in_beam && hn::AllFalse(f, hit.in)) continue;
      if (any) {
        occlude(i, hit.in, chord_distance(f, hit.middle, hit.d2));
      } else {
        hn::Store(hit.middle, f, found->t), hn::Store(hit.d2, f, found->det);
        found->ray = uint32_t(i), found->lane = uint32_t(k);
        found += !hn::AllFalse(f, hit.in);
      }
    }
    return found;
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

  template <bool in_beam>
  HWY_INLINE BeamCandidate* intersect(const TriangleBlock& block, int k, uint32_t id,
                                      BeamCandidate* found) const {
    const auto& f = kSixteen;
    for (size_t i = id * kPacket; i < (id + 1) * kPacket; i += kLanes16) {
      V16 x[3], y[3], z[3];
      for (int c = 0; c < 3; ++c) {
        const auto corner = [&](int a) HWY_ATTR {
          return hn::Sub(hn::Set(f, block.corner[c][a][k]), hn::Load(f, batch_.o[a] + i));
        };
        V16 across, along, depth;
        if (in_beam && scratch_.beams[id].axes != Beam::kMixed) {
          const uint8_t* const order = kShearAxes[scratch_.beams[id].axes];
          across = corner(order[0]), along = corner(order[1]), depth = corner(order[2]);
        } else {
          permute(hn::Load(f, batch_.axes + i), corner(0), corner(1), corner(2), across, along,
                  depth);
        }
        x[c] = hn::Sub(across, hn::Mul(hn::Load(f, batch_.shear[0] + i), depth));
        y[c] = hn::Sub(along, hn::Mul(hn::Load(f, batch_.shear[1] + i), depth));
        z[c] = hn::Mul(hn::Load(f, batch_.shear[2] + i), depth);
      }
      auto hit = edge_test(f, x, y, z);
      if (!in_beam && hn::AllFalse(f, hit.in)) continue;
      hit.in = hn::And(hit.in, within_reach(f, x, y));
      if (any) {
        occlude(i, hit.in, hn::Div(hit.t, hit.det));
      } else {
        // Zero is not in front of the origin.
        hn::Store(hn::IfThenElseZero(hit.in, hit.t), f, found->t);
        hn::Store(hit.det, f, found->det);
        hn::Store(hit.u, f, found->u), hn::Store(hit.v, f, found->v);
        found->ray = uint32_t(i), found->lane = uint32_t(k);
        found += !hn::AllFalse(f, hit.in);
      }
    }
    return found;
  }

  template <bool in_beam, PrimitiveKind kind>
  HWY_INLINE BeamCandidate* intersect(const Block<kind>& block, int k, uint32_t id,
                                      BeamCandidate* found) const {
    const DemotedTag narrow;
    const auto numbers = widened(block.numbers, [&](const float* column) HWY_ATTR {
      return hn::Set(kDoubles, double(column[k]));
    });
    VD origin[3], dir[3];
    const auto& f = kSixteen;
    alignas(64) float t[kPacket];
    unsigned mask = 0;
    const size_t first = id * kPacket;
    for (size_t i = 0; i < kPacket; i += kLanesD) {
      for (int a = 0; a < 3; ++a) {
        origin[a] = hn::PromoteTo(kDoubles, hn::Load(narrow, batch_.o[a] + first + i));
        dir[a] = hn::PromoteTo(kDoubles, hn::Load(narrow, batch_.d[a] + first + i));
      }
      const auto hit = first_hits_at<kind>(numbers, origin, dir, [&]() HWY_ATTR {
        return batch_.time ? hn::PromoteTo(kDoubles, hn::LoadU(narrow, batch_.time + first + i))
                           : hn::Zero(kDoubles);
      });
      mask |= bits(narrow, hit.in) << i;
      hn::Store(hit.t, narrow, t + i);
    }
    if (mask == 0) return found;
    for (size_t i = 0; i < kPacket; i += kLanes16) {
      const uint8_t lanes[8] = {uint8_t(mask >> i), uint8_t(mask >> i >> 8)};
      const M16 in = hn::LoadMaskBits(f, lanes);
      const V16 distance = hn::Load(f, t + i);
      if (any)
        occlude(first + i, in, distance);
      else
        offer(first + i, hn::IfThenElseZero(in, distance), block.primitive[k], hn::Zero(f),
              hn::Zero(f));
    }
    return found;
  }

  const Blocks& blocks_;
  const Batch& batch_;
  BeamScratch& scratch_;
  TraceContext& context_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
