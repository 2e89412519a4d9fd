// The walks of the eight-wide tree, compiled once for each instruction set (Highway's
// foreach_target) and chosen when the program runs.
#include "accel/bvh.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "accel/bvh_trace.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "accel/bvh_packet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

// Children that wait, farthest first; those that an ever nearer hit has overtaken are dropped on
// the way.
struct Waiting {
  uint32_t ref;
  float t;
};
constexpr int kStack = (kBvhWidth - 1) * kBvhMaxLevels + 1;

// Pushes the hit children so that the nearest is taken first.
HWY_INLINE int push_sorted(const BvhNode& node, unsigned mask, const float* t, Waiting* stack,
                           int top) {
  const int first = top;
  for_bits(mask, [&](int i) {
    int at = top++;
    for (; at > first && stack[at - 1].t < t[i]; --at) stack[at] = stack[at - 1];
    stack[at] = {node.child[i], t[i]};
  });
  return top;
}

class Walk {
 public:
  Walk(const Geometry& geometry, const Bvh& bvh)
      : g_(geometry),
        bvh_(bvh),
        sided_spheres_(!g_.two_sided(ItemKind::sphere)),
        sided_triangles_(!g_.two_sided(ItemKind::triangle)),
        packets_(!sided_spheres_ && !sided_triangles_ && !bvh_.nodes.empty()) {}

  // Calls `one(i)` for each ray that goes alone and `eight(first, packet)` for packets that were
  // traced.
  template <bool any, class One, class Eight>
  void each(const RayBatch& rays, TraceContext& context, One&& one, Eight&& eight) const {
    const size_t step = context.coherent && packets_ ? size_t(kBvhWidth) : 1;
    Packet packet;
    for (size_t i = 0; i < rays.size() && !context.stopped(); i += step) {
      const size_t end = std::min(rays.size(), i + step);
      if (step > 1 && end - i > 2 && gather(rays, i, end, packet)) {
        if (packet_tree<any>(packet, context)) {
          eight(i, end, packet);
          continue;
        }
      }
      for (size_t k = i; k < end; ++k) one(k);
    }
  }

  // The nearest hit; with `any`, the first that turns up.
  template <bool any>
  RayQuery single(const Ray& ray, TraceContext& context) const {
    RayQuery query(ray);
    for (uint32_t i = 0; i < g_.count(ItemKind::plane); ++i)
      if (test_plane(g_, i, query) && any) return query;
    if (!bvh_.nodes.empty()) single_tree<any>(query, context);
    return query;
  }

 private:
  template <bool any>
  void single_tree(RayQuery& query, TraceContext& context) const {
    const SlabRay slabs(query.ray, bvh_.reach);
    Waiting stack[kStack];
    stack[0] = {bvh_ref(BvhChild::node, 0), 0};
    for (int top = 1; top > 0;) {
      const Waiting next = stack[--top];
      if (next.t > query.best.t) continue;
      if (bvh_kind(next.ref) == BvhChild::node) {
        const BvhNode& node = bvh_.nodes[bvh_index(next.ref)];
        float enter[kBvhWidth];
        const unsigned mask = meet_boxes(node.boxes, slabs, query.best.t, enter);
        top = push_sorted(node, mask, enter, stack, top);
        ++context.steps;
      } else {
        context.tests += kBvhWidth;
        if (leaf(next.ref, slabs, query) && any) return;
      }
    }
  }

  // Rays first .. end - 1 as a packet with what single() does before the tree, if they are alike
  // enough to gain from it.
  bool gather(const RayBatch& rays, size_t first, size_t end, Packet& p) const {
    constexpr float kMaxSpread = 0.06f;  // of the directions, over the three axes; measured
    Box3f dirs;
    int axis = -1;
    for (int i = 0; i < kBvhWidth; ++i) {
      const size_t k = std::min(first + size_t(i), end - 1);
      RayQuery query(rays[k]);
      const Ray& ray = query.ray;
      for (uint32_t n = 0; n < g_.count(ItemKind::plane); ++n) test_plane(g_, n, query);
      for (int a = 0; a < 3; ++a) {
        p.o[a][i] = ray.origin[a], p.d[a][i] = ray.dir[a];
        p.inverse[a][i] = finite_inverse(ray.dir[a]);
      }
      dirs.extend(ray.dir);
      if (i == 0) axis = query.sheared.kz;
      if (query.sheared.kz != axis) return false;
      p.kx = query.sheared.kx, p.ky = query.sheared.ky, p.kz = query.sheared.kz;
      p.shear[0][i] = query.sheared.sx;
      p.shear[1][i] = query.sheared.sy;
      p.shear[2][i] = query.sheared.sz;
      p.t[i] = first + size_t(i) < end ? query.best.t : -1;
      p.item[i] = query.best.item;
      p.u[i] = p.v[i] = 0;
    }
    const Vec3f spread = dirs.size();
    if (!(spread.x + spread.y + spread.z < kMaxSpread)) return false;
    for (int a = 0; a < 3; ++a)
      if (std::signbit(dirs.lo[a]) != std::signbit(dirs.hi[a])) return false;
    return true;
  }

  // The packet as an interval. Shadow rays that end in one point (a light) are taken from there:
  // their origins lie apart, and as an interval of origins they would meet much that none of them
  // meets. (The order of what they meet is then from the light, which is as good for any hit.)
  template <bool any>
  RayInterval interval(Packet& p) const {
    Box3f origins, ends, dirs;
    for (int i = 0; i < kBvhWidth; ++i) {
      if (p.t[i] < 0) continue;
      const Vec3f o(p.o[0][i], p.o[1][i], p.o[2][i]), d(p.d[0][i], p.d[1][i], p.d[2][i]);
      origins.extend(o);
      ends.extend(o + d * p.t[i]);
      dirs.extend(d);
    }
    const float size = std::max(max_component(abs(origins.lo)), max_component(abs(origins.hi)));
    p.slack = 8 * kEpsilon * (bvh_.reach + size);
    const float far = p.farthest();
    const Vec3f apart = ends.size(), starts = origins.size();
    if (any && apart.x + apart.y + apart.z < starts.x + starts.y + starts.z) {
      const float reach = std::max(max_component(abs(ends.lo)), max_component(abs(ends.hi)));
      return RayInterval(ends, {-dirs.hi, -dirs.lo}, p.slack + 8 * kEpsilon * (reach + far));
    }
    return RayInterval(origins, dirs, p.slack);
  }

  // False when it has given up: where primitives are smaller than the rays are apart, the interval
  // meets most that no ray does, and each ray alone is faster.
  template <bool any>
  bool packet_tree(Packet& p, TraceContext& context) const {
    constexpr int kMostTests = 32;  // measured
    int tests_left = kMostTests;
    if (any && finish_hit_lanes(p)) return true;
    const RayInterval rays = interval<any>(p);
    float farthest = p.farthest();
    Waiting stack[kStack];
    stack[0] = {bvh_ref(BvhChild::node, 0), 0};
    for (int top = 1; top > 0;) {
      const Waiting next = stack[--top];
      if (next.t > farthest) continue;
      const uint32_t i = bvh_index(next.ref);
      const int tests_before = tests_left;
      float enter[kBvhWidth];
      const auto boxes = [&](const EightBoxes& b) {
        return rays.meet([&](int side, int a, int k) { return load(&b.planes[side][a][k]); },
                         farthest, enter);
      };
      switch (bvh_kind(next.ref)) {
        case BvhChild::node: {
          const BvhNode& node = bvh_.nodes[i];
          top = push_sorted(node, boxes(node.boxes), enter, stack, top);
          ++context.steps;
          continue;
        }
        case BvhChild::spheres: {
          const SphereBlock& block = bvh_.spheres[i];
          const float* centers[] = {block.x, block.y, block.z};
          for_bits(rays.meet(
                       [&](int side, int a, int k) {
                         const V c = load(centers[a] + k), r = load(block.radius + k);
                         return side ? hn::Add(c, r) : hn::Sub(c, r);
                       },
                       farthest, enter),
                   [&](int k) { meet_sphere(block, k, p), --tests_left; });
          break;
        }
        case BvhChild::triangles: {
          const TriangleBlock& block = bvh_.triangles[i];
          for_bits(rays.meet(
                       [&](int side, int a, int k) {
                         const V x = load(&block.corner[0][a][k]), y = load(&block.corner[1][a][k]);
                         const V z = load(&block.corner[2][a][k]);
                         return side ? hn::Max(hn::Max(x, y), z) : hn::Min(hn::Min(x, y), z);
                       },
                       farthest, enter),
                   [&](int k) { meet_triangle(block, k, p), --tests_left; });
          break;
        }
        case BvhChild::cones: {
          const ConeBlock& block = bvh_.cones[i];
          for_bits(boxes(block.boxes), [&](int k) { meet_cone(g_, block, k, p), --tests_left; });
          break;
        }
      }
      context.tests += uint64_t(tests_before - tests_left) * kBvhWidth;
      if (any && finish_hit_lanes(p)) return true;
      if (tests_left < 0) return false;
      farthest = p.farthest();
    }
    return true;
  }

  // True when every lane is done.
  static bool finish_hit_lanes(Packet& p) {
    bool all = true;
    for (int i = 0; i < kBvhWidth; ++i) {
      if (p.item[i] != kNoItem) p.t[i] = -1;
      all &= p.t[i] < 0;
    }
    return all;
  }

  HWY_INLINE bool leaf(uint32_t ref, const SlabRay& slabs, RayQuery& query) const {
    const uint32_t i = bvh_index(ref);
    switch (bvh_kind(ref)) {
      case BvhChild::spheres:
        return sided_spheres_ ? meet_items(g_, bvh_.spheres[i].item, query)
                              : meet_spheres(bvh_.spheres[i], query);
      case BvhChild::triangles:
        return sided_triangles_ ? meet_items(g_, bvh_.triangles[i].item, query)
                                : meet_triangles(bvh_.triangles[i], query);
      default:
        return meet_cones(g_, bvh_.cones[i], slabs, query);
    }
  }

  const Geometry& g_;
  const Bvh& bvh_;
  bool sided_spheres_, sided_triangles_;
  bool packets_;  // those surfaces go ray by ray
};

void closest(const Geometry& g, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
             TraceContext& context) {
  const Walk walk(g, bvh);
  walk.each<false>(
      rays, context, [&](size_t i) { hits.set(i, walk.single<false>(rays[i], context).best); },
      [&](size_t first, size_t end, const Packet& p) {
        for (size_t k = 0; k < end - first; ++k)
          hits.set(first + k, {p.t[k], p.item[k], p.u[k], p.v[k]});
      });
}

void occluded(const Geometry& g, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
              TraceContext& context) {
  const Walk walk(g, bvh);
  walk.each<true>(
      rays, context, [&](size_t i) { hit[i] = walk.single<true>(rays[i], context).best.found(); },
      [&](size_t first, size_t end, const Packet& p) {
        for (size_t k = 0; k < end - first; ++k) hit[first + k] = p.item[k] != kNoItem;
      });
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio {

HWY_EXPORT(closest);
HWY_EXPORT(occluded);

void bvh_closest(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, HitBatch& hits,
                 TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(closest)(geometry, bvh, rays, hits, context);
}

void bvh_occluded(const Geometry& geometry, const Bvh& bvh, const RayBatch& rays, uint8_t* hit,
                  TraceContext& context) {
  HWY_DYNAMIC_DISPATCH(occluded)(geometry, bvh, rays, hit, context);
}

}  // namespace raio
#endif
