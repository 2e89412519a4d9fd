// The arithmetic of rays and blocks in SIMD lanes: one ray against eight boxes or primitives, or
// one primitive against sixteen rays. Included by blocks_rays-inl.h only, once for each instruction
// set. Lane by lane the arithmetic of primitives is that of the scalar tests in shape/, so that
// hits are those of brute force to the last bit, on every machine. Once for each instruction set,
// as foreach_target.h passes again.
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

template <class D, class V = hn::Vec<D>>
HWY_INLINE V dot(D, V ax, V ay, V az, V bx, V by, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}
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
    exist = named(block.item);
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
  HWY_INLINE unsigned meet(const float* lower_inverse, const float* upper_inverse,
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

// Which lines of rays hit the spheres whose centres lie at (x, y, z) from their origins, and by
// middle and square of half of the chord where. shape/sphere.h explains.
template <class D>
struct SphereLanes {
  hn::Mask<D> in;
  hn::Vec<D> middle, d2;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE SphereLanes<D> chord_test(D d, V x, V y, V z, V radius, V dx, V dy, V dz) {
  const V middle = dot(d, x, y, z, dx, dy, dz);
  const V px = hn::Sub(x, hn::Mul(dx, middle));
  const V py = hn::Sub(y, hn::Mul(dy, middle));
  const V pz = hn::Sub(z, hn::Mul(dz, middle));
  const V d2 = hn::Sub(hn::Mul(radius, radius), dot(d, px, py, pz, px, py, pz));
  return {hn::Ge(d2, hn::Zero(d)), middle, d2};
}
// The distance; not positive for spheres behind the ray.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V chord_distance(D d, V middle, V d2) {
  const V half = hn::Sqrt(d2);
  const V entry = hn::Sub(middle, half);
  return hn::IfThenElse(hn::Gt(entry, hn::Zero(d)), entry, hn::Add(middle, half));
}

// Distances and weights of the triangles with sheared corners (x, y, z), all still to be divided by
// `det`, and which of them the lines of the rays hit. shape/triangle.h explains.
template <class D>
struct TriangleLanes {
  hn::Mask<D> in;
  hn::Vec<D> det, t, u, v;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE TriangleLanes<D> edge_test(D d, const V* x, const V* y, const V* z) {
  const V zero = hn::Zero(d);
  const V u = hn::Sub(hn::Mul(x[2], y[1]), hn::Mul(y[2], x[1]));
  const V v = hn::Sub(hn::Mul(x[0], y[2]), hn::Mul(y[0], x[2]));
  const V w = hn::Sub(hn::Mul(x[1], y[0]), hn::Mul(y[1], x[0]));
  const V smallest = hn::Min(hn::Min(u, v), w), largest = hn::Max(hn::Max(u, v), w);
  const V det = hn::Add(hn::Add(u, v), w);
  const V t = hn::Add(hn::Add(hn::Mul(u, z[0]), hn::Mul(v, z[1])), hn::Mul(w, z[2]));
  const auto both = hn::And(hn::Lt(smallest, zero), hn::Gt(largest, zero));
  return {hn::AndNot(both, hn::Ne(det, zero)), det, t, v, w};
}
// And which of them are passed near enough, for those seen edge-on.
template <class D, class V = hn::Vec<D>>
HWY_INLINE hn::Mask<D> within_reach(D d, const V* x, const V* y) {
  const V x0 = hn::Min(hn::Min(x[0], x[1]), x[2]), x1 = hn::Max(hn::Max(x[0], x[1]), x[2]);
  const V y0 = hn::Min(hn::Min(y[0], y[1]), y[2]), y1 = hn::Max(hn::Max(y[0], y[1]), y[2]);
  const V reach = hn::Max(hn::Max(hn::Neg(x0), x1), hn::Max(hn::Neg(y0), y1));
  const V away = hn::Max(hn::Max(x0, hn::Neg(x1)), hn::Max(y0, hn::Neg(y1)));
  return hn::Le(away, hn::Mul(hn::Set(d, kEdgeSlack), reach));
}

// The axes of ShearedRay by one number: its kz, plus 3 where the ray goes down that axis.
constexpr uint8_t kShearAxes[6][3] = {{1, 2, 0}, {2, 0, 1}, {0, 1, 2},
                                      {2, 1, 0}, {0, 2, 1}, {1, 0, 2}};

// The first hits in front of the rays with cones. shape/cone.h explains; the order of operations is
// its.
struct ConeInput {
  VD base[3], axis[3], height, radius, slope, origin[3], dir[3];
};
using DemotedTag = hn::Rebind<float, decltype(kDoubles)>;
struct ConeLanes {
  hn::Mask<DemotedTag> in;
  hn::Vec<DemotedTag> t;
};
HWY_INLINE ConeLanes cone_test(const ConeInput& c) {
  const auto dot3 = [](const VD* x, const VD* y) {
    return dot(kDoubles, x[0], x[1], x[2], y[0], y[1], y[2]);
  };
  const VD zero = hn::Zero(kDoubles), half = hn::Set(kDoubles, 0.5);
  VD from_base[3], from_middle[3], o[3], o_across[3], d_across[3];
  for (int a = 0; a < 3; ++a) {
    from_base[a] = hn::Sub(c.origin[a], c.base[a]);
    from_middle[a] = hn::Sub(from_base[a], hn::Mul(c.axis[a], hn::Mul(half, c.height)));
  }
  const VD shift = hn::Div(hn::Neg(dot3(from_middle, c.dir)), dot3(c.dir, c.dir));
  for (int a = 0; a < 3; ++a) o[a] = hn::Add(from_base[a], hn::Mul(c.dir[a], shift));
  const VD oz = dot3(o, c.axis), dz = dot3(c.dir, c.axis);
  for (int a = 0; a < 3; ++a) {
    o_across[a] = hn::Sub(o[a], hn::Mul(c.axis[a], oz));
    d_across[a] = hn::Sub(c.dir[a], hn::Mul(c.axis[a], dz));
  }
  const VD o_r = hn::Add(c.radius, hn::Mul(c.slope, oz)), d_r = hn::Mul(c.slope, dz);
  const VD qa = hn::Sub(dot3(d_across, d_across), hn::Mul(d_r, d_r));
  const VD qb = hn::Sub(dot3(o_across, d_across), hn::Mul(o_r, d_r));
  const VD qc = hn::Sub(dot3(o_across, o_across), hn::Mul(o_r, o_r));
  const VD disc = hn::Sub(hn::Mul(qb, qb), hn::Mul(qa, qc));
  const MD parallel = hn::Eq(qa, zero);
  const MD real = hn::Or(hn::Ge(disc, zero), parallel);
  const DemotedTag demoted;
  const auto narrow = [&](MD m) {
    return hn::DemoteTo(demoted, hn::IfThenElseZero(m, hn::Set(kDoubles, 1.0)));
  };
  const auto none = hn::Zero(demoted);
  if (hn::AllFalse(kDoubles, real)) return {hn::Ne(none, none), none};
  const VD root = hn::Sqrt(hn::Max(disc, zero));
  const VD big =
      hn::IfThenElse(hn::Ge(qb, zero), hn::Sub(hn::Neg(qb), root), hn::Add(hn::Neg(qb), root));
  VD s0 = hn::Div(big, qa);
  VD s1 = hn::IfThenElse(hn::Ne(big, zero), hn::Div(qc, big), s0);
  const MD swap = hn::Gt(s0, s1);
  const VD first = hn::IfThenElse(swap, s1, s0);
  s1 = hn::IfThenElse(swap, s0, s1);
  s0 = hn::IfThenElse(parallel, hn::Div(hn::Mul(hn::Set(kDoubles, -0.5), qc), qb), first);
  const auto on_surface = [&](VD s) {
    const VD z = hn::Add(oz, hn::Mul(s, dz));
    const MD within = hn::And(hn::Ge(z, zero), hn::Le(z, c.height));
    return hn::AndNot(hn::Lt(hn::Add(c.radius, hn::Mul(c.slope, z)), zero), within);
  };
  const MD in0 =
      hn::And(hn::And(on_surface(s0), real), hn::Or(hn::Not(parallel), hn::Ne(qb, zero)));
  const MD in1 = hn::And(hn::And(on_surface(s1), real), hn::Not(parallel));
  const auto t0 = hn::DemoteTo(demoted, hn::Add(s0, shift));
  const auto t1 = hn::DemoteTo(demoted, hn::Add(s1, shift));
  const auto hit0 = hn::And(hn::Ne(narrow(in0), none), hn::Gt(t0, none));
  const auto hit1 = hn::And(hn::Ne(narrow(in1), none), hn::Gt(t1, none));
  return {hn::Or(hit0, hit1), hn::IfThenElse(hit0, t0, t1)};
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
