// Traverses the cells of a grid. The volume swept by a ray or beam is cut into slices one cell
// thick across its main axis; the lanes compute for eight slices at once which cells each may
// overlap. No step waits for the previous one. Cells know their distance to the nearest non-empty
// cell, and that many slices are skipped. Included by grid/trace.cpp only, once per instruction set
// (foreach_target.h).
//
// Wald, Ize, Kensler, Knoll and Parker 2006, "Ray Tracing Animated Scenes using Coherent Grid
// Traversal", ACM TOG 25(3).
//
// Cohen and Sheffer 1994, "Proximity Clouds: An Acceleration Technique for 3D Grid Traversal", The
// Visual Computer 11(1).
#if defined(RAIO_ACCEL_GRID_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_GRID_WALK_INL_H_
#undef RAIO_ACCEL_GRID_WALK_INL_H_
#else
#define RAIO_ACCEL_GRID_WALK_INL_H_
#endif

#include "accel/blocks/rays-inl.h"
#include "accel/grid/grid.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class RayGroup>
class Sweeper {
 public:
  Sweeper(const GridBlocks& blocks, RayGroup& group) : b_(blocks), group_(group) {
    size_t pitch = 1;
    for (int a = 0; a < 3; ++a) pitch_[a] = ptrdiff_t(pitch), pitch *= size_t(b_.n[a]);
  }

  HWY_INLINE void sweep(uint32_t id) {
    if (!start(id)) return visit(0, uint32_t(b_.groups.size()), id);
    for (int next = 0; next < count_;) {
      unsigned left = evaluate(next, group_.end(id));
      int done = kLanes8;
      while (left) {
        const int i = int(hwy::Num0BitsBelowLS1Bit_Nonzero32(left));
        if (enter_[i] > group_.end(id)) return;
        // To the next slice that may be non-empty.
        const int to = i + 1 + int(float(visit_slice(next + i, i, id)) * pace_);
        done = std::max(done, to);
        left = to < kLanes8 ? left >> to << to : 0;
      }
      next += done;
    }
  }

 private:
  // Chooses the main axis: the one along which most cells are certainly crossed. False if numbers
  // leave the range of floats.
  HWY_INLINE bool start(uint32_t id) {
    const Sweep s = group_.sweep(id);
    float size = b_.reach;
    for (int a = 0; a < 3; ++a) size = std::max(size, std::abs(s.o[a]));
    const float width = s.start + 2 * kSlack * size;
    float slowest[3], fastest[3], sum = 0;
    k_ = 0;
    for (int a = 0; a < 3; ++a) {
      const float o = s.o[a] - b_.lo[a];
      low_[a] = (o - width) * b_.per_unit[a], high_[a] = (o + width) * b_.per_unit[a];
      low_rate_[a] = (s.d[a] - s.widening) * b_.per_unit[a];
      high_rate_[a] = (s.d[a] + s.widening) * b_.per_unit[a];
      slowest[a] = s.d[a] > 0 ? low_rate_[a] : -high_rate_[a];
      fastest[a] = s.d[a] > 0 ? high_rate_[a] : -low_rate_[a];
      sum += std::abs(low_[a]) + std::abs(high_[a]) + fastest[a];
      if (slowest[a] > slowest[k_]) k_ = a;
    }
    u_ = k_ == 2 ? 0 : k_ + 1, v_ = k_ == 0 ? 2 : k_ - 1;
    sum += (sum + float(b_.n[k_])) / slowest[k_];
    if (!(slowest[k_] > 0 && sum < kInfinity)) return false;
    // max() prefers 0.0f to a later -0.0f, so a ray along the main axis has pace 1.
    pace_ = std::min(1.0f, slowest[k_] / std::max({0.0f, fastest[u_], fastest[v_]}));
    const bool up = s.d[k_] > 0;
    const float last = float(b_.n[k_] - 1), t = group_.end(id);
    const auto slice = [&](float x) { return int(std::min(std::max(0.0f, x), last)); };
    step_ = up ? 1 : -1;
    first_ = slice(up ? low_[k_] : high_[k_]);
    count_ = (slice(up ? high_[k_] + t * high_rate_[k_] : low_[k_] + t * low_rate_[k_]) - first_) *
                 step_ +
             1;
    return true;
  }

  // Computes where the slices from `next`, as many as there are lanes, are entered and which of
  // their cells may be overlapped. Returns the bits of those with any.
  HWY_INLINE unsigned evaluate(int next, float end) {
    const auto& f = kEight;
    const hn::RebindToSigned<decltype(kEight)> ints;
    const bool up = step_ > 0;
    const float enter = up ? high_[k_] : low_[k_], leave = up ? low_[k_] : high_[k_];
    const float enter_rate = up ? high_rate_[k_] : low_rate_[k_];
    const float leave_rate = up ? low_rate_[k_] : high_rate_[k_];
    const V8 zero = hn::Zero(f), step = hn::Set(f, float(step_)), lanes = hn::Iota(f, 0);
    const V8 x = hn::MulAdd(step, hn::Add(hn::Set(f, float(next)), lanes),
                            hn::Set(f, float(up ? first_ : first_ + 1)));
    const V8 t0 = hn::Max(zero, hn::Mul(hn::Sub(x, hn::Set(f, enter)), hn::Set(f, 1 / enter_rate)));
    const V8 t1 = hn::Min(hn::Set(f, end), hn::Mul(hn::Sub(hn::Add(x, step), hn::Set(f, leave)),
                                                   hn::Set(f, 1 / leave_rate)));
    M8 in = hn::Lt(lanes, hn::Set(f, float(count_ - next)));
    const auto range = [&](int a, int32_t* first, int32_t* last) HWY_ATTR {
      const V8 slow = hn::Set(f, low_rate_[a]), fast = hn::Set(f, high_rate_[a]);
      const V8 lo = hn::Add(hn::Set(f, low_[a]), hn::Min(hn::Mul(t0, slow), hn::Mul(t1, slow)));
      const V8 hi = hn::Add(hn::Set(f, high_[a]), hn::Max(hn::Mul(t0, fast), hn::Mul(t1, fast)));
      in = hn::AndNot(hn::Or(hn::Lt(hi, zero), hn::Ge(lo, hn::Set(f, float(b_.n[a])))), in);
      const V8 most = hn::Set(f, float(b_.n[a] - 1));
      hn::Store(hn::ConvertTo(ints, hn::Min(hn::Max(lo, zero), most)), ints, first);
      hn::Store(hn::ConvertTo(ints, hn::Min(hn::Max(hi, zero), most)), ints, last);
    };
    range(u_, u0_, u1_), range(v_, v0_, v1_);
    hn::Store(t0, f, enter_);
    return bits(f, in);
  }

  // Tests a slice; returns the minimum number of steps to a non-empty slice.
  HWY_INLINE int visit_slice(int number, int i, uint32_t id) {
    const ptrdiff_t slice = (first_ + number * step_) * pitch_[k_];
    int free = kFarthest;
    for (int v = v0_[i]; v <= v1_[i]; ++v)
      for (int u = u0_[i]; u <= u1_[i]; ++u) {
        const ptrdiff_t cell = slice + v * pitch_[v_] + u * pitch_[u_];
        const int around = b_.empty_around[cell];
        free = std::min(free, around);
        if (around == 0) visit(b_.begin[cell], b_.begin[cell + 1], id);
      }
    return std::max(0, free - 1);
  }

  HWY_INLINE void visit(uint32_t first, uint32_t end, uint32_t id) {
    for (uint32_t i = first; i < end; ++i) {
      const BlockGroup& group = b_.groups[i];
      for_bits(group_.intersect(id, BoxLanes(group.boxes, group.block)),
               [&](int k) { group_.leaf(group.block[k], &id, 1); });
    }
  }

  const GridBlocks& b_;
  RayGroup& group_;
  ptrdiff_t pitch_[3];
  // The swept volume, in cells: at distance t, coordinate a is between low + t * low_rate and high
  // + t * high_rate.
  float low_[3], high_[3], low_rate_[3], high_rate_[3];
  int k_, u_, v_;             // the main axis and the others
  int step_, first_, count_;  // `count_` slices first, first + step, ...
  float pace_;                // steps along the main axis per step along any
  // The first and last cells along u and v of the slices in the lanes.
  alignas(32) float enter_[kLanes8];
  alignas(32) int32_t u0_[kLanes8], u1_[kLanes8], v0_[kLanes8], v1_[kLanes8];
};

template <class RayGroup>
void traverse(const GridBlocks& blocks, bool without_shared, size_t count, IdLists& lists,
              RayGroup& group) {
  if (!without_shared)
    for (const uint32_t ref : blocks.shared) group.leaf(ref, lists.ids.data(), count);
  if (blocks.groups.empty()) return;
  Sweeper<RayGroup> sweeper(blocks, group);
  for (size_t i = 0; i < count; ++i)
    if (group.end(lists.ids[i]) > 0) sweeper.sweep(lists.ids[i]);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
