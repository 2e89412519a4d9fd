// The walk of the eight-wide tree that all rays of a batch make together: at each node a list of
// those that meet it, each tested against the eight boxes. What one ray would wait for (the next
// node, the outcome of a comparison) the processor finds in the work of the others. Included by
// bvh_trace.cpp only, once for each instruction set.
//
// Tsakok 2009, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG; Barringer and
// Akenine-Moeller 2014, "Dynamic Ray Stream Traversal", ACM TOG 33(4).
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_ACCEL_BVH_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BVH_STREAM_INL_H_
#undef RAIO_ACCEL_BVH_STREAM_INL_H_
#else
#define RAIO_ACCEL_BVH_STREAM_INL_H_
#endif

#include <hwy/cache_control.h>

#include "accel/bvh_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

constexpr size_t kChunk = 1024;  // rays that travel together

// A child that waits, with the list of those that meet it.
struct Waiting {
  uint32_t ref;
  float nearest;
  uint32_t begin, end;  // of its list
  uint32_t used;        // where all lists of its node end
};
constexpr int kStack = (kBvhWidth - 1) * kBvhMaxLevels + 1;

const hn::CappedTag<uint32_t, 16> kIds;
constexpr size_t kIdLanes = hn::MaxLanes(decltype(kIds)());

struct Lists {
  std::vector<uint32_t> ids;
  uint8_t met[kChunk + 16];  // by place in a list: which of the eight boxes
  Waiting stack[kStack];

  void reserve(size_t n) {
    if (ids.size() < n) ids.resize(2 * n);
  }
};

HWY_INLINE void prefetch(const Bvh& bvh, uint32_t ref) {
  const uint32_t i = bvh_index(ref);
  const auto lines = [](const auto* p) HWY_ATTR {
    for (size_t b = 0; b < sizeof(*p); b += 64)
      hwy::Prefetch(reinterpret_cast<const uint8_t*>(p) + b);
  };
  switch (bvh_kind(ref)) {
    case BvhChild::node:
      return lines(bvh.nodes.data() + i);
    case BvhChild::spheres:
      return lines(bvh.spheres.data() + i);
    case BvhChild::triangles:
      return lines(bvh.triangles.data() + i);
    case BvhChild::cones:
      return lines(bvh.cones.data() + i);
  }
}

// Walks the tree with those in `lists.ids[0 .. count)`. A Crowd knows what they are:
// `meet(id, boxes, nearest)` says which boxes one meets, `leaf(ref, ids, n)` tests a leaf's
// primitives, `worthwhile(waiting, id)` drops a lone one that has found something nearer.
template <class Crowd>
void walk(const Bvh& bvh, size_t count, Lists& lists, Crowd& crowd) {
  Waiting* const stack = lists.stack;
  stack[0] = {bvh_ref(BvhChild::node, 0), 0, 0, uint32_t(count), uint32_t(count)};
  for (int top = 1; top > 0;) {
    const Waiting w = stack[--top];
    const size_t n = w.end - w.begin;
    if (bvh_kind(w.ref) != BvhChild::node) {
      crowd.leaf(w.ref, lists.ids.data() + w.begin, n);
      continue;
    }
    lists.reserve(w.used + kBvhWidth * n + kIdLanes);
    crowd.visits(n);
    uint32_t* const ids = lists.ids.data();
    const BvhNode& node = bvh.nodes[bvh_index(w.ref)];
    const BoxLanes boxes(node.boxes, node.child);
    V8 nearest[kParts];
    for (V8& x : nearest) x = hn::Set(kEight, kInfinity);
    unsigned any = 0;
    for (size_t i = 0; i < n; ++i) {
      const unsigned mask = crowd.meet(ids[w.begin + i], boxes, nearest);
      lists.met[i] = uint8_t(mask);
      any |= mask;
    }
    if (any == 0) continue;
    const hn::Rebind<uint8_t, decltype(kIds)> bytes;
    hn::StoreU(hn::Zero(bytes), bytes, lists.met + n);
    float enter[kBvhWidth];
    for (int p = 0; p < kParts; ++p) hn::StoreU(nearest[p], kEight, enter + p * kLanes8);
    // The lists of the children, who then wait so that the nearest is taken first.
    uint32_t used = w.used;
    const int first = top;
    for_bits(any, [&](int c) {
      const uint32_t begin = used;
      const auto bit = hn::Set(kIds, 1u << c);
      for (size_t i = 0; i < n; i += kIdLanes) {
        const auto in = hn::TestBit(hn::PromoteTo(kIds, hn::LoadU(bytes, lists.met + i)), bit);
        hn::StoreU(hn::Compress(hn::LoadU(kIds, ids + w.begin + i), in), kIds, ids + used);
        used += uint32_t(hn::CountTrue(kIds, in));
      }
      int at = top++;
      for (; at > first && stack[at - 1].nearest < enter[c]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.child[c], enter[c], begin, used, 0};
      prefetch(bvh, node.child[c]);
    });
    for (int i = first; i < top; ++i) stack[i].used = used;
  }
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
