// Forms beams of sixteen coherent rays each: first the extents of a beam's rays; then, with sixteen
// beams in the lanes, the values that traversal needs. Included by blocks/beams-inl.h only, once
// per instruction set (foreach_target.h).
#if defined(RAIO_ACCEL_BLOCKS_FORM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BLOCKS_FORM_INL_H_
#undef RAIO_ACCEL_BLOCKS_FORM_INL_H_
#else
#define RAIO_ACCEL_BLOCKS_FORM_INL_H_
#endif

#include "accel/blocks/rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

constexpr size_t kPackets = kChunk / kPacket;

struct alignas(16) Beam {
  static constexpr uint32_t kMixed = std::size(kShearAxes);  // `axes` if the rays' axes differ

  float inverse[2][3], offset[2][3];  // see BoxLanes::intersect
  // The cone around all rays: its radius at distance s is start + s * widening.
  float o[3], d[3], start, widening;
  float t;             // of the farthest ray; not positive: all are done
  uint32_t axes;       // of all rays, in kShearAxes, or kMixed
  int32_t tests_left;  // negative: too many tests, its rays continue singly
  // The maximum deviation, rounding included, of the rays' directions (scaled) from d along each
  // axis, and of their origins (scaled in the same way) from o.
  float turned[3], shifted;
  uint32_t unused;
};
static_assert(sizeof(Beam) % (4 * sizeof(float)) == 0);

// The minimum and maximum of four values over sixteen rays.
constexpr int kSteps = kPacket / kLanes8;
const hn::CappedTag<float, 4> kFour;
struct alignas(16) Extents {
  float lo[4], hi[4];

  HWY_INLINE void enclose(const V8 (*x)[kSteps]) {
    reduce(x, lo, [](auto a, auto b) HWY_ATTR { return hn::Min(a, b); });
    reduce(x, hi, [](auto a, auto b) HWY_ATTR { return hn::Max(a, b); });
  }

 private:
#if HWY_TARGET != HWY_SCALAR
  template <class D, class V, class Op>
  static HWY_INLINE auto fold(D, V x, Op&& op) {
    if constexpr (hn::MaxLanes(D()) > 4) {
      const hn::Half<D> half;
      return fold(half, op(hn::LowerHalf(half, x), hn::UpperHalf(half, x)), op);
    } else {
      return x;
    }
  }
#endif

  template <class Op>
  static HWY_INLINE void reduce(const V8 (*x)[kSteps], float* out, Op&& op) {
    V8 y[4];
    for (int k = 0; k < 4; ++k) {
      y[k] = x[k][0];
      for (int p = 1; p < kSteps; ++p) y[k] = op(y[k], x[k][p]);
    }
#if HWY_TARGET == HWY_SCALAR
    for (int k = 0; k < 4; ++k) out[k] = hn::GetLane(y[k]);
#else
    const auto& f = kEight;
    const hn::Repartition<double, decltype(kEight)> pairs;
    // Per block of four lanes: 0 1 0 1, then 0 1 2 3.
    const V8 y01 = op(hn::InterleaveLower(f, y[0], y[1]), hn::InterleaveUpper(f, y[0], y[1]));
    const V8 y23 = op(hn::InterleaveLower(f, y[2], y[3]), hn::InterleaveUpper(f, y[2], y[3]));
    const auto u = hn::BitCast(pairs, y01), v = hn::BitCast(pairs, y23);
    const V8 all = op(hn::BitCast(f, hn::InterleaveLower(pairs, u, v)),
                      hn::BitCast(f, hn::InterleaveUpper(pairs, u, v)));
    hn::Store(fold(f, all, op), kFour, out);
#endif
  }
};

// Rays `ray`, `ray` + 1, ... of a beam, some of which may hit primitive `lane` of a leaf, and
// where: columns as in Candidate.
struct alignas(64) BeamCandidate {
  float t[kLanes16], det[kLanes16], u[kLanes16], v[kLanes16];
  uint32_t ray, lane;
};

// A thread's memory for beams.
struct BeamScratch {
  // Pairs of a beam and a primitive in a leaf: kBlockWidth * id + lane. Entries after the last may
  // be overwritten.
  static constexpr size_t kPairs = 40;
  uint32_t pairs[kPairs + kBlockWidth];
  BeamCandidate candidates[kPairs * (kPacket / kLanes16) + 1];
  Beam beams[kPackets];
  // Per packet: the number of active rays, and the extents.
  alignas(64) float alive[kPackets];
  enum { origins_and_t, directions_and_axes, ends, kinds };
  float lo_hi[kinds][8][kPackets];
};

template <bool any>
class BeamMaker {
 public:
  BeamMaker(const Blocks& blocks, const Batch& batch, BeamScratch& scratch)
      : blocks_(blocks), batch_(batch), scratch_(scratch) {}

  // Call for all packets of the batch before forming beams.
  HWY_INLINE void measure(size_t packets) {
    for (size_t p = 0; p < packets; p += 4) {
      Extents x[BeamScratch::kinds][4] = {};
      for (size_t k = 0; k < std::min<size_t>(4, packets - p); ++k)
        scratch_.alive[p + k] = measure((p + k) * kPacket, x[0][k], x[1][k], x[2][k]);
      for (int kind = 0; kind < kKinds; ++kind)
        for (size_t c = 0; c < 8; c += 4)
          transpose(x[kind][0].lo + c, 8, &scratch_.lo_hi[kind][c][p], kPackets);
    }
  }

  // Forms beams first, first + 1, ... + 15; returns the bits of those that are coherent or done.
  HWY_INLINE unsigned form(size_t first) {
    alignas(64) float rows[kBeamFloats][kPacket];
    unsigned formed = 0;
    for (int i = 0; i < kPacket; i += kLanes16) formed |= form_lanes(first + i, rows, i) << i;
    for (size_t i = 0; i < kPacket; i += 4) {
      auto* const beams = reinterpret_cast<float*>(&scratch_.beams[first + i]);
      for (size_t c = 0; c < kBeamFloats; c += 4)
        transpose(&rows[c][i], kPacket, beams + c, kBeamFloats);
    }
    return formed;
  }

 private:
  static constexpr size_t kBeamFloats = sizeof(Beam) / sizeof(float);
  static constexpr int kKinds = any ? 3 : 2;
  // Measured.
  static constexpr int kFewest = any ? 8 : 3;        // active rays
  static constexpr float kMaxSpread = 0.4f;          // of the directions, over three axes
  static constexpr float kMaxSpreadToPoint = 0.05f;  // plus the spread of their end points
  // Primitives tested per ray. If primitives are smaller than the distance between rays, a beam
  // mostly tests primitives that no ray hits, and single rays are faster.
  static constexpr float kMaxTests = any ? 2 : 4;

  // The number of active rays and, unless there are too few, their extents.
  HWY_INLINE float measure(size_t first, Extents& origins, Extents& dirs, Extents& ends) const {
    const auto& f = kEight;
    M8 counts[kSteps];
    unsigned alive = 0;
    for (int s = 0; s < kSteps; ++s) {
      counts[s] = hn::Gt(hn::Load(f, batch_.t + first + s * kLanes8), hn::Zero(f));
      alive |= bits(f, counts[s]) << (s * kLanes8);
    }
    const int n_alive = int(hwy::PopCount(alive));
    if (n_alive < kFewest) return float(n_alive);
    // Inactive rays are replaced by an active one.
    const size_t one = first + hwy::Num0BitsBelowLS1Bit_Nonzero32(alive);
    V8 o[4][kSteps], d[4][kSteps];
    for (int s = 0; s < kSteps; ++s) {
      const auto column = [&](const float* c) HWY_ATTR {
        return hn::IfThenElse(counts[s], hn::Load(f, c + first + s * kLanes8), hn::Set(f, c[one]));
      };
      for (int a = 0; a < 3; ++a) o[a][s] = column(batch_.o[a]), d[a][s] = column(batch_.d[a]);
      o[3][s] = column(batch_.t);
      d[3][s] = blocks_.of<PrimitiveKind::triangle>().empty() ? hn::Zero(f) : column(batch_.axes);
    }
    origins.enclose(o);
    dirs.enclose(d);
    if (any) {
      for (int s = 0; s < kSteps; ++s)
        for (int a = 0; a < 3; ++a) o[a][s] = hn::MulAdd(d[a][s], o[3][s], o[a][s]);
      ends.enclose(o);
    }
    return float(n_alive);
  }

  // Intervals of three coordinates, one per beam.
  struct Box {
    V16 lo[3], hi[3];
    HWY_INLINE V16 extent() const {
      return hn::Add(hn::Add(hn::Sub(hi[0], lo[0]), hn::Sub(hi[1], lo[1])), hn::Sub(hi[2], lo[2]));
    }
    HWY_INLINE V16 largest() const {
      V16 x = hn::Zero(kSixteen);
      for (int a = 0; a < 3; ++a) x = hn::Max(x, hn::Max(hn::Abs(lo[a]), hn::Abs(hi[a])));
      return x;
    }
    HWY_INLINE V16 diagonal() const {
      V16 x[3];
      for (int a = 0; a < 3; ++a) x[a] = hn::Sub(hi[a], lo[a]);
      return hn::Sqrt(dot(kSixteen, x[0], x[1], x[2], x[0], x[1], x[2]));
    }
  };
  HWY_INLINE Box box(int kind, size_t p) const {
    Box b;
    for (int a = 0; a < 3; ++a) {
      b.lo[a] = hn::Load(kSixteen, scratch_.lo_hi[kind][a] + p);
      b.hi[a] = hn::Load(kSixteen, scratch_.lo_hi[kind][4 + a] + p);
    }
    return b;
  }

  // Forms as many beams as there are lanes, from packet p, into the columns from `i`.
  HWY_INLINE unsigned form_lanes(size_t p, float (*columns)[kPacket], int i) const {
    const auto& f = kSixteen;
    const hn::RebindToSigned<decltype(kSixteen)> ints;
    const V16 zero = hn::Zero(f), one = hn::Set(f, 1), half = hn::Set(f, 0.5f);
    const V16 rounding = hn::Set(f, 8 * kEpsilon);
    // Stores the column of a member of Beam, or of the n-th element of one.
    const auto put = [&](size_t member, V16 x, size_t n = 0)
                         HWY_ATTR { hn::Store(x, f, columns[column_of(member) + n] + i); };
    const V16 alive = hn::Load(f, scratch_.alive + p);
    const V16 t = hn::Load(f, scratch_.lo_hi[BeamScratch::origins_and_t][7] + p);
    const V16 axes = hn::Load(f, scratch_.lo_hi[BeamScratch::directions_and_axes][7] + p);
    Box origins = box(BeamScratch::origins_and_t, p),
        dirs = box(BeamScratch::directions_and_axes, p);

    const V16 apart = dirs.extent();
    M16 formed = hn::And(hn::Ge(alive, hn::Set(f, kFewest)), hn::Lt(apart, hn::Set(f, kMaxSpread)));
    for (int a = 0; a < 3; ++a) {
      const auto signs = hn::BitCast(ints, hn::Xor(dirs.lo[a], dirs.hi[a]));
      formed = hn::AndNot(hn::RebindMask(f, hn::Lt(signs, hn::Zero(ints))), formed);
    }
    const V16 first_axes = hn::Load(f, scratch_.lo_hi[BeamScratch::directions_and_axes][3] + p);
    const V16 common_axes =
        hn::IfThenElse(hn::Eq(first_axes, axes), axes, hn::Set(f, float(Beam::kMixed)));

    V16 size = hn::Max(hn::Set(f, blocks_.reach), origins.largest());
    // Shadow rays that end in one point (a light) are reversed to start there: their origins are
    // far apart, and an interval of origins would overlap much that no ray hits. (Hits are then
    // ordered from the light, which is fine for any-hit.)
    if (any) {
      const Box ends = box(BeamScratch::ends, p);
      const M16 end = hn::Lt(t, hn::Set(f, kInfinity));
      formed = hn::And(formed, hn::Le(origins.extent(), hn::Set(f, blocks_.farthest_apart)));
      // Directions to an area light differ by its size, which counts less.
      const V16 to_point = hn::Sub(apart, hn::Div(ends.extent(), t));
      formed = hn::AndNot(hn::AndNot(hn::Lt(to_point, hn::Set(f, kMaxSpreadToPoint)), end), formed);
      const M16 back = hn::And(end, hn::Lt(ends.extent(), origins.extent()));
      size = hn::IfThenElse(back, hn::Max(size, ends.largest()), size);
      for (int a = 0; a < 3; ++a) {
        origins.lo[a] = hn::IfThenElse(back, ends.lo[a], origins.lo[a]);
        origins.hi[a] = hn::IfThenElse(back, ends.hi[a], origins.hi[a]);
        const V16 lo = dirs.lo[a];
        dirs.lo[a] = hn::IfThenElse(back, hn::Neg(dirs.hi[a]), lo);
        dirs.hi[a] = hn::IfThenElse(back, hn::Neg(lo), dirs.hi[a]);
      }
    }
    const V16 slack = hn::Mul(size, hn::Set(f, 2 * kSlack));
    V16 d[3];
    for (size_t a = 0; a < 3; ++a) {
      // All directions have the same sign, so these are the earliest and latest.
      const V16 lower = finite_inverse(f, dirs.hi[a]), upper = finite_inverse(f, dirs.lo[a]);
      put(offsetof(Beam, inverse), lower, a), put(offsetof(Beam, inverse), upper, 3 + a);
      put(offsetof(Beam, offset), hn::Mul(hn::Add(origins.hi[a], slack), lower), a);
      put(offsetof(Beam, offset), hn::Mul(hn::Sub(origins.lo[a], slack), upper), 3 + a);
      put(offsetof(Beam, o), hn::Add(hn::Mul(origins.lo[a], half), hn::Mul(origins.hi[a], half)),
          a);
      d[a] = hn::Mul(hn::Add(dirs.lo[a], dirs.hi[a]), half);
    }
    // The middle is almost of unit length: one Newton step, error squared.
    const V16 error = hn::Sub(one, dot(f, d[0], d[1], d[2], d[0], d[1], d[2]));
    const V16 to_unit = hn::MulAdd(half, error, one);
    for (size_t a = 0; a < 3; ++a) {
      const V16 half_size = hn::MulAdd(half, hn::Sub(dirs.hi[a], dirs.lo[a]), rounding);
      put(offsetof(Beam, d), hn::Mul(d[a], to_unit), a);
      put(offsetof(Beam, turned), hn::Mul(half_size, to_unit), a);
    }
    // |o_i + s d_i - (o + s d)| <= start + s spread, and s <= (along + radius + start) / (1 -
    // spread) for a sphere that is hit, with its centre `along` the axis. The centre of the box of
    // unit vectors may be longer than they are.
    const V16 spread = hn::Add(hn::MulAdd(half, dirs.diagonal(), hn::Abs(error)), rounding);
    const V16 start = hn::MulAdd(half, origins.diagonal(), slack);
    put(offsetof(Beam, start), start);
    put(offsetof(Beam, widening), hn::Div(spread, hn::Sub(one, spread)));

    const M16 done = hn::Eq(alive, zero);
    put(offsetof(Beam, t), hn::IfThenElse(hn::AndNot(done, formed), t, hn::Set(f, -1)));
    put(offsetof(Beam, axes), hn::BitCast(f, hn::ConvertTo(ints, common_axes)));
    put(offsetof(Beam, tests_left),
        hn::BitCast(f, hn::ConvertTo(ints, hn::Mul(alive, hn::Set(f, kMaxTests)))));
    // Triangles round more: three products, and the test of each ray.
    put(offsetof(Beam, shifted), hn::Mul(hn::MulAdd(slack, hn::Set(f, 3), start), to_unit));
    put(offsetof(Beam, unused), zero);
    return bits(f, hn::Or(formed, done));
  }

  const Blocks& blocks_;
  const Batch& batch_;
  BeamScratch& scratch_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
