// What rays and blocks in SIMD lanes have in common: tags, boxes, and the numbers of blocks as
// lanes want them. The arithmetic of primitives ends shape/<kind>.h: lane by lane that of the
// scalar tests, so that hits are those of brute force to the last bit, on every machine. Included
// by blocks/rays-inl.h only, once for each instruction set, as foreach_target.h passes again.
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
namespace raio::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Where the machine has fewer lanes, everything is done in several steps.
constexpr int kPacket = 16;  // rays that are neighbours in the batch
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

// Eight boxes ready to be met by ray after ray.
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

  // Those of lanes 0-7 that have a name; kNoChild and kNoPrimitive are all bits set.
  static HWY_INLINE unsigned named(const uint32_t* names) {
    const hn::RebindToUnsigned<decltype(kEight)> tag;
    unsigned mask = 0;
    for (int i = 0; i < kBlockWidth; i += kLanes8)
      mask |= bits(tag, hn::Ne(hn::LoadU(tag, names + i), hn::Set(tag, kNoPrimitive))) << i;
    return mask;
  }

  // A lower plane at x is met at x * inverse[0] - offset[0], an upper one by [1]. Which of the
  // boxes are met before `tmax`; where they are entered goes to `nearest`, if wanted, where that is
  // nearer.
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

// The edges of eight triangles, each from its corner to the next.
struct EdgeLanes {
  V8 edge[3][3][kParts];  // [corner][axis]
  V8 size[3][kParts];     // the sum of its parts along the axes, at least its length

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

// Boxes are widened by what a float hit, and the reckoning above, may be off by: a few epsilons of
// the numbers at hand (shape/sphere.h, triangle.h). Ize 2013, "Robust BVH Ray Traversal", JCGT
// 2(2). It is done where it is free: lower planes are met from an origin this much further up,
// upper planes from one further down.
constexpr float kSlack = 16 * kEpsilon;

// Not so large that a product with a coordinate could overflow. Over the length of a scene,
// directions that are nearer to zero leave the slack no more than zero itself.
constexpr float kLargestInverse = 1e18f;
template <class D, class V = hn::Vec<D>>
HWY_INLINE V finite_inverse(D d, V x) {
  const V limit = hn::Set(d, 1 / kLargestInverse);
  return hn::IfThenElse(hn::Lt(hn::Abs(x), limit), hn::CopySign(hn::Set(d, kLargestInverse), x),
                        hn::Div(hn::Set(d, 1), x));
}

// The axes of ShearedRay by one number: its kz, plus 3 where the ray goes down that axis.
constexpr uint8_t kShearAxes[6][3] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2},
                                      {2, 1, 0}, {0, 2, 1}, {1, 0, 2}};

using DemotedTag = hn::Rebind<float, decltype(kDoubles)>;

// Kinds that are tested in float stand by the million in scenes, and are inlined wherever they are
// tested; the others, in double, are called, so that their registers are not taken from the first.
template <PrimitiveKind kind>
constexpr bool kTestedInFloat = kind == PrimitiveKind::sphere || kind == PrimitiveKind::triangle;

template <class F, class Blocks>
HWY_NOINLINE void call_apart(const F& f, const Blocks& blocks) {
  f(blocks);
}

// f(column of blocks) for the kind whose blocks are in the pool.
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

// The first hits of a kind that is tested in double. `time`: makes the rays' times, for kinds that
// move.
template <PrimitiveKind kind, class Numbers, class Time>
HWY_INLINE auto first_hits_at(const Numbers& numbers, const VD* origin, const VD* dir,
                              const Time& time) {
  if constexpr (kMoves<kind>)
    return first_hits(kDoubles, numbers, origin, dir, time());
  else
    return first_hits(kDoubles, numbers, origin, dir);
}

// The numbers of primitives in double: what `load` makes of each column.
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

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
