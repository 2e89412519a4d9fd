// Shared by SIMD code for rays and blocks: tags, boxes, and loading the numbers of blocks. The
// tests of primitives are at the ends of shape/<kind>.h: each lane computes exactly the scalar
// test, so hits equal those of brute force on every machine. Included by blocks/rays-inl.h only,
// once per instruction set (foreach_target.h).
#if defined(RAIO_ACCEL_BLOCKS_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BLOCKS_LANES_INL_H_
#undef RAIO_ACCEL_BLOCKS_LANES_INL_H_
#else
#define RAIO_ACCEL_BLOCKS_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "accel/accel.h"
#include "accel/blocks/blocks.h"
#include "accel/intersect.h"
#include "shape/first_hits-inl.h"

#define RAIO_KINDS_IN_LANES
#include "shape/kinds.h"
#undef RAIO_KINDS_IN_LANES

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Machines with fewer lanes take several steps.
constexpr int kPacket = 16;  // neighbouring rays in the batch
const hn::CappedTag<float, kBlockWidth> kEight;
const hn::CappedTag<float, kPacket> kSixteen;
const hn::CappedTag<double, 8> kDoubles;
using V8 = hn::Vec<decltype(kEight)>;
using M8 = hn::Mask<decltype(kEight)>;
using V16 = hn::Vec<decltype(kSixteen)>;
using M16 = hn::Mask<decltype(kSixteen)>;
using VD = hn::Vec<decltype(kDoubles)>;
using MD = hn::Mask<decltype(kDoubles)>;
constexpr int kLanes8 = int(hn::MaxLanes(decltype(kEight)()));
constexpr int kLanes16 = int(hn::MaxLanes(decltype(kSixteen)()));
constexpr int kLanesD = int(hn::MaxLanes(decltype(kDoubles)()));
constexpr int kParts = kBlockWidth / kLanes8;
constexpr float kEpsilon = std::numeric_limits<float>::epsilon();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

template <class D, class M = hn::Mask<D>>
HWY_INLINE unsigned bits(D d, M mask) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  return unsigned(bytes[0] | bytes[1] << 8);
}

template <class F>
HWY_INLINE void for_bits(unsigned mask, F&& f) {
  for (; mask; mask &= mask - 1) f(int(hwy::Num0BitsBelowLS1Bit_Nonzero32(mask)));
}

// Eight boxes, to be intersected with many rays.
struct BoxLanes {
  V8 planes[2][3][kParts];
  unsigned exist;

  HWY_INLINE BoxLanes(const EightBoxes& boxes, const uint32_t* names) {
    for (int side = 0; side < 2; ++side)
      for (int a = 0; a < 3; ++a)
        for (int p = 0; p < kParts; ++p)
          planes[side][a][p] = hn::Load(kEight, &boxes.planes[side][a][p * kLanes8]);
    exist = named(names);
  }
  // The boxes of triangles.
  HWY_INLINE explicit BoxLanes(const TriangleBlock& block) {
    for (int a = 0; a < 3; ++a)
      for (int p = 0; p < kParts; ++p) {
        const auto corner = [&](int c) {
          return hn::Load(kEight, &block.corner[c][a][p * kLanes8]);
        };
        planes[0][a][p] = hn::Min(hn::Min(corner(0), corner(1)), corner(2));
        planes[1][a][p] = hn::Max(hn::Max(corner(0), corner(1)), corner(2));
      }
    exist = named(block.primitive);
  }

  // Mask of lanes 0-7 that are used; kNoChild and kNoPrimitive have all bits set.
  static HWY_INLINE unsigned named(const uint32_t* names) {
    const hn::RebindToUnsigned<decltype(kEight)> tag;
    unsigned mask = 0;
    for (int i = 0; i < kBlockWidth; i += kLanes8)
      mask |= bits(tag, hn::Ne(hn::LoadU(tag, names + i), hn::Set(tag, kNoPrimitive))) << i;
    return mask;
  }

  // The ray hits a lower plane at x at x * inverse[0] - offset[0], an upper one with [1]. Returns
  // which boxes it hits before `tmax`; where it enters them nearer than `nearest`, if given,
  // updates that.
  HWY_INLINE unsigned intersect(const float* lower_inverse, const float* upper_inverse,
                                const float* lower_offset, const float* upper_offset, float tmax,
                                V8* nearest = nullptr) const {
    unsigned mask = 0;
    for (int p = 0; p < kParts; ++p) {
      V8 from = hn::Zero(kEight), to = hn::Set(kEight, tmax);
      for (int a = 0; a < 3; ++a) {
        const V8 x = hn::MulSub(planes[0][a][p], hn::Set(kEight, lower_inverse[a]),
                                hn::Set(kEight, lower_offset[a]));
        const V8 y = hn::MulSub(planes[1][a][p], hn::Set(kEight, upper_inverse[a]),
                                hn::Set(kEight, upper_offset[a]));
        from = hn::Max(from, hn::Min(x, y));
        to = hn::Min(to, hn::Max(x, y));
      }
      const M8 met = hn::Le(from, to);
      if (nearest) nearest[p] = hn::IfThenElse(met, hn::Min(from, nearest[p]), nearest[p]);
      mask |= bits(kEight, met) << (p * kLanes8);
    }
    return mask & exist;
  }
};

// The edges of eight triangles, each from its vertex to the next.
struct EdgeLanes {
  V8 edge[3][3][kParts];  // [vertex][axis]
  V8 size[3][kParts];     // the 1-norm, an upper bound of the length

  HWY_INLINE explicit EdgeLanes(const TriangleBlock& block) {
    for (int c = 0; c < 3; ++c)
      for (int p = 0; p < kParts; ++p) {
        size[c][p] = hn::Zero(kEight);
        for (int a = 0; a < 3; ++a) {
          const auto corner = [&](int i) HWY_ATTR {
            return hn::Load(kEight, &block.corner[i][a][p * kLanes8]);
          };
          edge[c][a][p] = hn::Sub(corner((c + 1) % 3), corner(c));
          size[c][p] = hn::Add(size[c][p], hn::Abs(edge[c][a][p]));
        }
      }
  }
};

// Boxes are widened by the rounding errors of a float hit and of the arithmetic above: a few
// epsilons of the numbers involved (shape/sphere.h, triangle.h). Ize 2013, "Robust BVH Ray
// Traversal", JCGT 2(2). Widening is free: lower planes use an origin this much higher, upper
// planes one this much lower.
constexpr float kSlack = 16 * kEpsilon;

// Small enough that products with coordinates cannot overflow. Over the length of a scene,
// directions closer to zero consume no more slack than zero itself.
constexpr float kLargestInverse = 1e18f;
template <class D, class V = hn::Vec<D>>
HWY_INLINE V finite_inverse(D d, V x) {
  const V limit = hn::Set(d, 1 / kLargestInverse);
  return hn::IfThenElse(hn::Lt(hn::Abs(x), limit), hn::CopySign(hn::Set(d, kLargestInverse), x),
                        hn::Div(hn::Set(d, 1), x));
}

// The axes of ShearedRay as one number: its kz, plus 3 if the ray descends along it.
constexpr uint8_t kShearAxes[6][3] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2},
                                      {2, 1, 0}, {0, 2, 1}, {1, 0, 2}};

using DemotedTag = hn::Rebind<float, decltype(kDoubles)>;

// Kinds tested in float occur in millions, so their tests are inlined. Those tested in double are
// called, which keeps registers free for the former.
template <PrimitiveKind kind>
constexpr bool kTestedInFloat = kind == PrimitiveKind::sphere || kind == PrimitiveKind::triangle;

template <class F, class Blocks>
HWY_NOINLINE void call_apart(const F& f, const Blocks& blocks) {
  f(blocks);
}

// Calls f(array of blocks) for the kind with this pool.
template <size_t k = 0, class F>
HWY_INLINE void visit_pool(const Blocks& blocks, Pool pool, F&& f) {
  constexpr auto kind = PrimitiveKind(k);
  if constexpr (!kIsBounded<kind>) {
    return visit_pool<k + 1>(blocks, pool, f);
  } else {
    if constexpr (k + 1 < kPrimitiveKinds)
      if (pool != Pool(k)) return visit_pool<k + 1>(blocks, pool, f);
    if constexpr (kTestedInFloat<kind>)
      f(blocks.of<kind>());
    else
      call_apart(f, blocks.of<kind>());
  }
}

// The first hits of a kind tested in double. `time` computes the rays' times, for moving kinds.
template <PrimitiveKind kind, class Numbers, class Time>
HWY_INLINE auto first_hits_at(const Numbers& numbers, const VD* origin, const VD* dir,
                              const Time& time) {
  if constexpr (kMoves<kind>)
    return first_hits(kDoubles, numbers, origin, dir, time());
  else
    return first_hits(kDoubles, numbers, origin, dir);
}

// The numbers of primitives in double: `load` applied to each column.
template <template <class> class Numbers, class Load>
HWY_INLINE Numbers<VD> widened(const Numbers<float[kBlockWidth]>& columns, Load&& load) {
  constexpr size_t kColumns = sizeof columns / sizeof(float[kBlockWidth]);
  Numbers<VD> out;
  static_assert(sizeof out == kColumns * sizeof(VD));
  const auto* const from = reinterpret_cast<const float(*)[kBlockWidth]>(&columns);
  auto* const to = reinterpret_cast<VD*>(&out);
  [&]<size_t... c>(std::index_sequence<c...>)
      HWY_ATTR { ((to[c] = load(from[c])), ...); }(std::make_index_sequence<kColumns>());
  return out;
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
