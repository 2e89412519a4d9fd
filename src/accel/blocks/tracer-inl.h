// Traces a batch of rays through blocks in a tree or grid: coherent rays as beams, the others
// singly. Included by bvh/trace.cpp and grid/trace.cpp only, once per instruction set
// (foreach_target.h).
#if defined(RAIO_ACCEL_BLOCKS_TRACER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BLOCKS_TRACER_INL_H_
#undef RAIO_ACCEL_BLOCKS_TRACER_INL_H_
#else
#define RAIO_ACCEL_BLOCKS_TRACER_INL_H_
#endif

#include <memory>

#include "accel/blocks/beams-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// A thread's memory for all its batches.
template <class TraversalScratch>
struct Scratch {
  // Columns of a batch that its rays do not provide.
  alignas(64) float t[kChunk + 16];  // not a multiple of 4096 bytes, see integrate/tile-inl.h
  alignas(64) float shear[4][kChunk + 16];
  RayScratch rays;
  BeamScratch beams;
  TraversalScratch traversal;
};

// Shared by both kinds of rays: it fills most of the L2 cache.
template <class TraversalScratch>
Scratch<TraversalScratch>& own_scratch() {
  static thread_local const auto scratch =
      std::make_unique_for_overwrite<Scratch<TraversalScratch>>();
  return *scratch;
}

// The outputs of a trace. next_transparent also reads `after` and, if given, `keys`.
struct TraceOutput {
  HitBatch* hits = nullptr;
  uint8_t* hit = nullptr;
  const HitBatch* after = nullptr;
  const uint32_t* keys = nullptr;
  DepthBatch* depths = nullptr;
};

// Traces through a `Structure` of blocks with `empty()` and traverse(structure, without_shared, n,
// traversal_scratch, ray group), which traces the first n of `traversal_scratch.ids`. A ray group
// (Rays, Beams) knows what the ids are; those already tested with the shared blocks skip them.
// `GroupOfRays`: Rays, or one that also logs.
template <Query query, class Structure, class TraversalScratch,
          template <Query> class GroupOfRays = Rays>
class Tracer {
 public:
  static constexpr bool any = query == Query::any;
  static constexpr bool kClear = query == Query::next_transparent || query == Query::depths;
  // Whether rays record hits.
  static constexpr bool kHits = query == Query::closest || query == Query::next_transparent;

  Tracer(const Geometry& geometry, const Structure& structure, bool alone,
         Scratch<TraversalScratch>& scratch, TraceContext& context)
      : g_(geometry),
        structure_(structure),
        scratch_(scratch),
        context_(context),
        beams_(!alone && !kClear) {
    size_t work = 0;
    for_each_bounded_kind([&]<PrimitiveKind kind> {
      beams_ = beams_ && g_.two_sided(kind);
      work += kWork<kind> * g_.count(kind);
    });
    few_ = work <= kFew && structure.count() <= kFew;
  }

  // Rays first, first + 1, ... of the batch, at most kChunk. Hits go to `out.hits` or `out.hit`.
  void trace(const RayBatch& rays, size_t first, const TraceOutput& out) {
    HitBatch* const hits = out.hits;
    Batch b = {.count = std::min(rays.size() - first, kChunk),
               .o = {&rays.ox[first], &rays.oy[first], &rays.oz[first]},
               .d = {&rays.dx[first], &rays.dy[first], &rays.dz[first]},
               .time = rays.has_time() ? &rays.time[first] : nullptr,
               .t = kHits ? &hits->t[first] : scratch_.t,
               .primitive = kHits ? &hits->primitive[first] : nullptr,
               .u = kHits ? &hits->u[first] : nullptr,
               .v = kHits ? &hits->v[first] : nullptr,
               .after_t = out.after ? &out.after->t[first] : nullptr,
               .after_primitive = out.after ? &out.after->primitive[first] : nullptr,
               .keys = out.keys ? out.keys + first : nullptr,
               .depths = out.depths,
               .first_depth = first,
               .shear = {scratch_.shear[0], scratch_.shear[1], scratch_.shear[2]},
               .axes = scratch_.shear[3]};
    start(b, &rays.tmax[first]);
    if (query == Query::depths) leave_out_stopped(b);
    for (uint32_t i = 0; i < g_.count(PrimitiveKind::plane); ++i) intersect_plane(b, i);
    if (!structure_.empty()) trace_blocks(b);
    if (any) {
      // A local copy: byte stores may alias anything.
      const float* const t = b.t;
      uint8_t* const hit = out.hit + first;
      for (size_t i = 0, count = b.count; i < count; ++i) hit[i] = t[i] == kOccluded;
    }
  }

 private:
  // Coherent rays as beams, then all others singly.
  void trace_blocks(Batch& b) {
    GroupOfRays<query> rays(g_, structure_, b, scratch_.rays, context_);
    Beams<any> beams(structure_, b, scratch_.beams, context_);
    TraversalScratch& lists = scratch_.traversal;
    lists.reserve(kChunk + kPacket);
    const uint32_t packets = uint32_t(padded(b.count) / kPacket);
    uint32_t alone[kPackets];
    size_t n = 0, n_alone = 0;
    if (!structure_.template of<PrimitiveKind::triangle>().empty())
      for (size_t p = 0; p < packets; ++p) b.shear_packet(p * kPacket);
    BeamMaker<any> maker(structure_, b, scratch_.beams);
    if (beams_) maker.measure(packets);
    for (uint32_t first = 0; first < packets; first += kPacket) {
      const unsigned formed = beams_ ? maker.form(first) : 0;
      for (uint32_t p = first; p < std::min(first + kPacket, packets); ++p) {
        if (formed >> (p - first) & 1) {
          if (beams.alive(p)) lists.ids[n++] = p;
        } else if (beams_ && few_) {
          beams.intersect_all(p);
        } else {
          alone[n_alone++] = p;
        }
      }
    }
    if (n > 0) traverse(structure_, false, n, lists, beams);
    if (beams_)
      for (uint32_t p = 0; p < packets; ++p)
        if (beams.gave_up(p)) alone[n_alone++] = p;
    if (beams_)
      for (const uint32_t block : structure_.shared)
        for (size_t i = 0; i < n_alone; ++i) beams.intersect_block(block, alone[i]);
    n = 0;
    for (size_t i = 0; i < n_alone; ++i)
      n = rays.add_packet(size_t(alone[i]) * kPacket, lists.ids.data(), n);
    if (n > 0) traverse(structure_, beams_, n, lists, rays);
  }

  void start(Batch& b, const float* tmax) {
    const auto& f = kSixteen;
    const hn::RebindToUnsigned<decltype(kSixteen)> ids;
    for (size_t i = 0; i < b.count; i += kLanes16) {
      const V16 t = hn::Load(f, tmax + i), done = hn::Set(f, -1);
      hn::Store(hn::IfThenElse(hn::Gt(t, hn::Zero(f)), t, done), f, b.t + i);
      if (!kHits) continue;
      hn::Store(hn::Set(ids, kNoPrimitive), ids, b.primitive + i);
      hn::Store(hn::Zero(f), f, b.u + i), hn::Store(hn::Zero(f), f, b.v + i);
    }
    for (size_t i = b.count; i < padded(b.count); ++i) b.t[i] = -1;
  }

  void leave_out_stopped(Batch& b) {
    for (size_t i = 0; i < b.count; ++i)
      if (b.depths->is_stopped(b.first_depth + i)) b.t[i] = kOccluded;
  }

  // All rays with one plane, in double, with the operations of shape/plane.h.
  void intersect_plane(Batch& b, uint32_t index) {
    const uint32_t depth = g_.depth_of(PrimitiveKind::plane, index);
    if (depth == 0 || (depth == kOpaque) == kClear) return;
    context_.tests += b.count;
    if (kClear || !g_.two_sided(PrimitiveKind::plane)) return intersect_plane_one_by_one(b, index);
    const Plane& plane = g_.plane(index);
    const PrimitiveId id = g_.id_of(PrimitiveKind::plane, index);
    const DemotedTag f;
    const auto& wide = kDoubles;
    const VD normal[3] = {hn::Set(wide, double(plane.normal.x)),
                          hn::Set(wide, double(plane.normal.y)),
                          hn::Set(wide, double(plane.normal.z))};
    for (size_t i = 0; i < b.count; i += kLanesD) {
      const auto load = [&](const float* x)
                            HWY_ATTR { return hn::PromoteTo(wide, hn::Load(f, x + i)); };
      VD d[3], to_plane[3];
      for (int a = 0; a < 3; ++a) {
        d[a] = load(b.d[a]);
        to_plane[a] = hn::Sub(hn::Set(wide, double(plane.point[a])), load(b.o[a]));
      }
      const VD along = dot(wide, normal[0], normal[1], normal[2], d[0], d[1], d[2]);
      const VD height =
          dot(wide, normal[0], normal[1], normal[2], to_plane[0], to_plane[1], to_plane[2]);
      // Infinite or NaN for a parallel ray; neither is nearer than anything.
      const auto t = narrowed(f, hn::Div(height, along));
      const auto best = hn::Load(f, b.t + i);
      // Planes have the lowest ids and come in order: the first stays.
      const auto taken = hn::And(hn::Gt(t, hn::Zero(f)), hn::Lt(t, best));
      if (hn::AllFalse(f, taken)) continue;
      hn::BlendedStore(any ? hn::Set(f, kOccluded) : t, taken, f, b.t + i);
      if (any) continue;
      const hn::RebindToUnsigned<DemotedTag> ids;
      hn::BlendedStore(hn::Set(ids, id), hn::RebindMask(ids, taken), ids, b.primitive + i);
    }
  }

  void intersect_plane_one_by_one(Batch& b, uint32_t index) {
    const PrimitiveId id = g_.id_of(PrimitiveKind::plane, index);
    for (size_t i = 0; i < b.count; ++i) {
      RayQuery alone(b.ray(i));
      if (kHits) alone.best.primitive = b.primitive[i];
      if (!test<PrimitiveKind::plane>(g_, index, alone)) continue;
      const float t = alone.best.t;
      if (query == Query::depths) {
        if (!b.depths->add(b.first_depth + i, g_.depth_of(PrimitiveKind::plane, index)))
          b.t[i] = kOccluded;
        continue;
      }
      if (query == Query::next_transparent &&
          (t < b.after_t[i] || (t == b.after_t[i] && id <= b.after_primitive[i]) ||
           (b.keys && !g_.stops(PrimitiveKind::plane, index, b.keys[i]))))
        continue;
      b.t[i] = any ? kOccluded : t;
      if (kHits) b.primitive[i] = id;
    }
  }

  const Geometry& g_;
  const Structure& structure_;
  Scratch<TraversalScratch>& scratch_;
  TraceContext& context_;
  static constexpr size_t kFew = 32;  // measured
  // The cost of a test relative to a sphere's: 2 for a triangle, 4 in double.
  template <PrimitiveKind kind>
  static constexpr size_t kWork = kind == PrimitiveKind::sphere     ? 1
                                  : kind == PrimitiveKind::triangle ? 2
                                                                    : 4;

  bool beams_;  // not for a single ray, nor with one-sided surfaces
  bool few_;    // so few primitives that every ray is tested with all
};

template <Query query, class TraversalScratch, template <Query> class GroupOfRays = Rays,
          class Structure>
void trace_all(const Geometry& g, const Structure& structure, const RayBatch& rays,
               const TraceOutput& out, TraceContext& context) {
  // A single ray reports its own cost.
  const bool alone = rays.size() == 1;
  Tracer<query, Structure, TraversalScratch, GroupOfRays> tracer(
      g, structure, alone, own_scratch<TraversalScratch>(), context);
  for (size_t i = 0; i < rays.size() && !context.stopped(); i += kChunk) tracer.trace(rays, i, out);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
