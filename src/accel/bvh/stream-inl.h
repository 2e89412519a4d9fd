// Traverses the eight-wide tree with all rays of a batch together: each node has a list of the rays
// that hit it, and each is tested with the eight boxes. Where one ray would wait (for the next
// node, for a comparison), the processor works on the others. Included by bvh/trace.cpp only, once
// per instruction set (foreach_target.h).
//
// Tsakok 2009, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG; Barringer and
// Akenine-Moeller 2014, "Dynamic Ray Stream Traversal", ACM TOG 33(4).
#if defined(RAIO_ACCEL_BVH_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BVH_STREAM_INL_H_
#undef RAIO_ACCEL_BVH_STREAM_INL_H_
#else
#define RAIO_ACCEL_BVH_STREAM_INL_H_
#endif

#include <hwy/cache_control.h>

#include "accel/blocks/rays-inl.h"
#include "accel/bvh/bvh.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// A pending child, with the list of rays that hit it.
struct Waiting {
  uint32_t ref;
  uint32_t begin, end;  // of its list
  uint32_t used;        // end of all lists of its node
};
constexpr int kStack = (kBlockWidth - 1) * kBvhMaxLevels + 1;

const hn::CappedTag<uint32_t, 16> kIds;
constexpr size_t kIdLanes = hn::MaxLanes(decltype(kIds)());

struct StreamScratch : IdLists {
  uint8_t met[kChunk + 16];  // by position in a list: which of the eight boxes
  Waiting stack[kStack];
  // For a single ray or beam.
  uint32_t waiting[kStack];
  float enter[kStack];
};

HWY_INLINE void prefetch(const Bvh& bvh, uint32_t ref) {
  const uint32_t i = ref_index(ref);
  const auto lines = [](const auto* p) HWY_ATTR {
    for (size_t b = 0; b < sizeof(*p); b += 64)
      hwy::Prefetch(reinterpret_cast<const uint8_t*>(p) + b);
  };
  if (ref_pool(ref) == Pool::nodes) return lines(bvh.nodes.data() + i);
  visit_pool(bvh, ref_pool(ref),
             [&](const auto& blocks) RAIO_INLINE_LAMBDA { lines(blocks.data() + i); });
}

// Mask of the root's children.
HWY_INLINE unsigned shared_children(const Bvh& bvh) {
  unsigned mask = 0;
  for (const uint32_t block : bvh.shared)
    for (int c = 0; c < kBlockWidth; ++c) mask |= unsigned(bvh.nodes[0].child[c] == block) << c;
  return mask;
}

// How many of the children in `mask` come after child c, entered at enter[c]: its place in a stack
// with the nearest on top. Insertion sort would mispredict its branches.
HWY_INLINE int later(const float* enter, unsigned mask, int c) {
  unsigned farther = 0, same = 0;
  for (int p = 0; p < kParts; ++p) {
    const V8 others = hn::Load(kEight, enter + p * kLanes8), own = hn::Set(kEight, enter[c]);
    farther |= bits(kEight, hn::Gt(others, own)) << (p * kLanes8);
    same |= bits(kEight, hn::Eq(others, own)) << (p * kLanes8);
  }
  return int(hwy::PopCount(mask & (farther | (same & ((1u << c) - 1)))));
}

// Traverses the subtree at `ref` with a single ray or beam, without lists, skipping whatever lies
// behind its hit.
template <class RayGroup>
HWY_INLINE void traverse_alone(const Bvh& bvh, uint32_t ref, uint32_t id, StreamScratch& scratch,
                               RayGroup& group) {
  int top = 0;
  while (true) {
    if (ref_pool(ref) == Pool::nodes) {
      group.visits(ref, 1);
      const BvhNode& node = bvh.nodes[ref_index(ref)];
      V8 nearest[kParts];
      for (V8& x : nearest) x = hn::Set(kEight, kInfinity);
      const BoxLanes boxes(node.boxes, node.child);
      const unsigned mask = group.intersect(id, boxes, RayGroup::kAny ? nullptr : nearest);
      alignas(32) float enter[kBlockWidth];
      if (!RayGroup::kAny)
        for (int p = 0; p < kParts; ++p) hn::Store(nearest[p], kEight, enter + p * kLanes8);
      int kept = top;
      for_bits(mask, [&](int c) {
        const int place = RayGroup::kAny ? kept++ : top + later(enter, mask, c);
        scratch.waiting[place] = node.child[c];
        if (!RayGroup::kAny) scratch.enter[place] = enter[c];
        prefetch(bvh, node.child[c]);
      });
      top += int(hwy::PopCount(mask));
    } else {
      group.leaf(ref, &id, 1);
      if (!(group.end(id) > 0)) return;
    }
    do {
      if (top == 0) return;
      ref = scratch.waiting[--top];
    } while (!RayGroup::kAny && !(scratch.enter[top] <= group.end(id)));
  }
}

// Traverses the tree with `lists.ids[0 .. count)`. A RayGroup knows what they are: `intersect(id,
// boxes, nearest)` tests one with eight boxes, `leaf(ref, ids, n)` tests a leaf's primitives;
// `kAny`: for any hit, not the nearest.
template <class RayGroup>
void traverse(const Bvh& bvh, bool without_shared, size_t count, StreamScratch& lists,
              RayGroup& group) {
  Waiting* const stack = lists.stack;
  stack[0] = {pool_ref(Pool::nodes, 0), 0, uint32_t(count), uint32_t(count)};
  for (int top = 1; top > 0;) {
    const Waiting w = stack[--top];
    const size_t n = w.end - w.begin;
    if (ref_pool(w.ref) != Pool::nodes) {
      group.leaf(w.ref, lists.ids.data() + w.begin, n);
      continue;
    }
    if (n == 1 && w.used > count) {
      traverse_alone(bvh, w.ref, lists.ids[w.begin], lists, group);
      continue;
    }
    lists.reserve(w.used + kBlockWidth * n + kIdLanes);
    group.visits(w.ref, n);
    uint32_t* const ids = lists.ids.data();
    const BvhNode& node = bvh.nodes[ref_index(w.ref)];
    const BoxLanes boxes(node.boxes, node.child);
    V8 nearest[kParts];
    for (V8& x : nearest) x = hn::Set(kEight, kInfinity);
    unsigned any = 0;
    for (size_t i = 0; i < n; ++i) {
      const unsigned mask =
          group.intersect(ids[w.begin + i], boxes, RayGroup::kAny ? nullptr : nearest);
      lists.met[i] = uint8_t(mask);
      any |= mask;
    }
    if (without_shared && w.used == count) any &= ~shared_children(bvh);  // the root
    if (any == 0) continue;
    const hn::Rebind<uint8_t, decltype(kIds)> bytes;
    hn::StoreU(hn::Zero(bytes), bytes, lists.met + n);
    alignas(32) float enter[kBlockWidth];
    for (int p = 0; p < kParts; ++p) hn::Store(nearest[p], kEight, enter + p * kLanes8);
    // Makes the lists of the children and pushes them so that the nearest comes first.
    uint32_t used = w.used;
    uint32_t begin[kBlockWidth], end[kBlockWidth];
    for_bits(any, [&](int c) {
      begin[c] = used;
      const auto bit = hn::Set(kIds, 1u << c);
      for (size_t i = 0; i < n; i += kIdLanes) {
        const auto in = hn::TestBit(hn::PromoteTo(kIds, hn::LoadU(bytes, lists.met + i)), bit);
        hn::StoreU(hn::Compress(hn::LoadU(kIds, ids + w.begin + i), in), kIds, ids + used);
        used += uint32_t(hn::CountTrue(kIds, in));
      }
      end[c] = used;
      // Any-hit rays: the child that most rays hit comes first, as it probably stops the most.
      if (RayGroup::kAny) enter[c] = -float(used - begin[c]);
      prefetch(bvh, node.child[c]);
    });
    for_bits(any, [&](int c) {
      stack[top + later(enter, any, c)] = {node.child[c], begin[c], end[c], used};
    });
    top += int(hwy::PopCount(any));
  }
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
