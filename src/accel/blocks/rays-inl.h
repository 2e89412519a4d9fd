// The ray group of single rays, for traversing tree or grid: one ray is tested with the eight
// primitives of a block. Included by blocks/tracer-inl.h and the traversals only, once per
// instruction set (foreach_target.h).
#if defined(RAIO_ACCEL_BLOCKS_RAYS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_ACCEL_BLOCKS_RAYS_INL_H_
#undef RAIO_ACCEL_BLOCKS_RAYS_INL_H_
#else
#define RAIO_ACCEL_BLOCKS_RAYS_INL_H_
#endif

#include <cstddef>
#include <cstring>

#include "accel/blocks/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// The queries of rays: the nearest opaque hit, or any; the next transparent hit after another, or
// the sum of optical depths.
enum class Query : uint8_t { closest, any, next_transparent, depths };

constexpr size_t kChunk = 1024;          // rays that travel together
constexpr float kOccluded = -kInfinity;  // the distance of an any-hit ray after a hit

// The rays or beams in a traversal.
struct IdLists {
  std::vector<uint32_t> ids;

  void reserve(size_t n) {
    if (ids.size() < n) ids.resize(2 * n);
  }
};

// At most kChunk rays of a batch that travel together, with their nearest hits so far. Columns have
// room for whole packets; rays beyond the end are done. A ray is done if its distance is not
// positive: nothing is nearer.
struct Batch {
  size_t count;
  const float *o[3], *d[3];
  const float* time;  // null: 0
  float* t;
  PrimitiveId* primitive;  // this and the next only for the nearest hit
  float *u, *v;
  // For next_transparent: the previous hits and the keys, if any; for depths: where to add them.
  const float* after_t;
  const PrimitiveId* after_primitive;
  const uint32_t* keys;
  DepthBatch* depths;
  size_t first_depth;  // index in it
  // As in ShearedRay, if the scene has triangles; axes as indices in kShearAxes.
  float* shear[3];
  float* axes;

  Ray ray(size_t i) const {
    return {{o[0][i], o[1][i], o[2][i]}, {d[0][i], d[1][i], d[2][i]}, t[i], time ? time[i] : 0};
  }

  HWY_INLINE void shear_packet(size_t first) const {
    const auto& f = kSixteen;
    for (size_t i = first; i < first + kPacket; i += kLanes16) {
      const V16 x = hn::Load(f, d[0] + i), y = hn::Load(f, d[1] + i), z = hn::Load(f, d[2] + i);
      const V16 ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
      const M16 y_less = hn::Ge(ax, ay);
      const M16 along_x = hn::And(y_less, hn::Ge(ax, az));
      const M16 along_y = hn::AndNot(y_less, hn::Ge(ay, az));
      const auto choose = [&](V16 if_x, V16 if_y, V16 if_z) {
        return hn::IfThenElse(along_x, if_x, hn::IfThenElse(along_y, if_y, if_z));
      };
      const V16 depth = choose(x, y, z), next = choose(y, z, x), last = choose(z, x, y);
      const M16 down = hn::Lt(depth, hn::Zero(f));
      hn::Store(hn::Div(hn::IfThenElse(down, last, next), depth), f, shear[0] + i);
      hn::Store(hn::Div(hn::IfThenElse(down, next, last), depth), f, shear[1] + i);
      hn::Store(hn::Div(hn::Set(f, 1), depth), f, shear[2] + i);
      const V16 axis = choose(hn::Zero(f), hn::Set(f, 1), hn::Set(f, 2));
      hn::Store(hn::IfThenElse(down, hn::Add(axis, hn::Set(f, 3)), axis), f, axes + i);
    }
  }
};

// The volume swept by a ray or beam: at distance t it lies around o + t d, within a radius of start
// + t * widening.
struct Sweep {
  const float *o, *d;
  float start, widening;
};

// Structs of four-byte members are transposed from columns: the column of a member.
constexpr size_t column_of(size_t offset_of_member) { return offset_of_member / sizeof(float); }

// The values of a ray for boxes and spheres: one cache line.
struct alignas(64) StreamRay {
  float inverse[3], lower[3], upper[3];  // see BoxLanes::intersect
  float t;
  float o[3], d[3];

  static constexpr size_t kFloats = 16;
};
static_assert(sizeof(StreamRay) == StreamRay::kFloats * sizeof(float));
// Additional values for triangles.
struct alignas(16) StreamShear {
  float x, y, z, axes;
};
// In the order of the columns of Batch.
static_assert(column_of(offsetof(StreamShear, x)) == 0 &&
              column_of(offsetof(StreamShear, y)) == 1 &&
              column_of(offsetof(StreamShear, z)) == 2 &&
              column_of(offsetof(StreamShear, axes)) == 3);

// Transposes four columns of four.
HWY_INLINE void transpose(const float* column, size_t step, float* row, size_t row_step) {
#if HWY_TARGET == HWY_SCALAR
  // The rows are structs, and some of their members are not floats.
  for (size_t i = 0; i < 4; ++i)
    for (size_t k = 0; k < 4; ++k)
      std::memcpy(row + i * row_step + k, column + k * step + i, sizeof(float));
#else
  const hn::CappedTag<float, 4> four;
  using V4 = hn::Vec<decltype(four)>;
  const V4 a = hn::LoadU(four, column), b = hn::LoadU(four, column + step);
  const V4 c = hn::LoadU(four, column + 2 * step), d = hn::LoadU(four, column + 3 * step);
  const V4 ab_low = hn::InterleaveLower(four, a, b), ab_high = hn::InterleaveUpper(four, a, b);
  const V4 cd_low = hn::InterleaveLower(four, c, d), cd_high = hn::InterleaveUpper(four, c, d);
  hn::Store(hn::ConcatLowerLower(four, cd_low, ab_low), four, row);
  hn::Store(hn::ConcatUpperUpper(four, cd_low, ab_low), four, row + row_step);
  hn::Store(hn::ConcatLowerLower(four, cd_high, ab_high), four, row + 2 * row_step);
  hn::Store(hn::ConcatUpperUpper(four, cd_high, ab_high), four, row + 3 * row_step);
#endif
}

// A ray that may hit some of a leaf's eight primitives: which, and where.
struct alignas(64) Candidate {
  float t[kBlockWidth];  // the distance; for spheres the middle of the chord, for triangles t * det
  float det[kBlockWidth];                // for spheres the square of half the chord
  float u[kBlockWidth], v[kBlockWidth];  // times det
  uint32_t id;
  unsigned mask;
};
constexpr size_t kCandidates = 64;

// Pairs of a ray and a primitive of a block that it may hit.
struct alignas(64) Pairs {
  int32_t id[kBlockWidth * kCandidates], lane[kBlockWidth * kCandidates];
};

struct RayScratch {
  Pairs pairs;
  StreamRay rays[kChunk];
  StreamShear shears[kChunk];
  Candidate candidates[kCandidates];
};

template <Query query>
class Rays {
 public:
  static constexpr bool any = query == Query::any;
  static constexpr bool kAny = any || query == Query::depths;  // in any order

  Rays(const Geometry& geometry, const Blocks& blocks, const Batch& batch, RayScratch& scratch,
       TraceContext& context)
      : g_(geometry),
        blocks_(blocks),
        batch_(batch),
        rays_(scratch.rays),
        shears_(scratch.shears),
        candidates_(scratch.candidates),
        pairs_(scratch.pairs),
        context_(context) {}

  // Prepares the rays of a packet and appends the active ones to the list.
  HWY_INLINE size_t add_packet(size_t first, uint32_t* ids, size_t n) {
    alignas(64) float columns[StreamRay::kFloats][kPacket];
    const auto& f = kSixteen;
    constexpr size_t kInverse = column_of(offsetof(StreamRay, inverse)),
                     kLower = column_of(offsetof(StreamRay, lower)),
                     kUpper = column_of(offsetof(StreamRay, upper)),
                     kT = column_of(offsetof(StreamRay, t)), kO = column_of(offsetof(StreamRay, o)),
                     kD = column_of(offsetof(StreamRay, d));
    for (int i = 0; i < kPacket; i += kLanes16) {
      V16 size = hn::Set(f, blocks_.reach);
      V16 o[3];
      for (int a = 0; a < 3; ++a) {
        o[a] = hn::Load(f, batch_.o[a] + first + i);
        size = hn::Max(size, hn::Abs(o[a]));
      }
      const V16 slack = hn::Mul(size, hn::Set(f, 2 * kSlack));
      for (size_t a = 0; a < 3; ++a) {
        const V16 d = hn::Load(f, batch_.d[a] + first + i);
        const V16 inverse = finite_inverse(f, d);
        hn::Store(inverse, f, columns[kInverse + a] + i);
        hn::Store(hn::Mul(hn::Add(o[a], slack), inverse), f, columns[kLower + a] + i);
        hn::Store(hn::Mul(hn::Sub(o[a], slack), inverse), f, columns[kUpper + a] + i);
        hn::Store(o[a], f, columns[kO + a] + i);
        hn::Store(d, f, columns[kD + a] + i);
      }
      hn::Store(hn::Load(f, batch_.t + first + i), f, columns[kT] + i);
    }
    constexpr size_t kRow = StreamRay::kFloats;
    auto* const rows = reinterpret_cast<float*>(&rays_[first]);
    for (size_t i = 0; i < kPacket; i += 4)
      for (size_t c = 0; c < kRow; c += 4)
        transpose(&columns[c][i], kPacket, rows + kRow * i + c, kRow);
    if (!blocks_.of<PrimitiveKind::triangle>().empty())
      for (size_t i = first; i < first + kPacket; i += 4)
        transpose(batch_.shear[0] + i, size_t(batch_.shear[1] - batch_.shear[0]), &shears_[i].x, 4);
    for (size_t i = first; i < first + kPacket; ++i) {
      ids[n] = uint32_t(i);
      n += batch_.t[i] > 0;
    }
    return n;
  }

  // Counts visits of node `ref` of a tree.
  void visits(uint32_t, size_t n) { context_.steps += n; }
  float end(uint32_t id) const { return rays_[id].t; }
  Sweep sweep(uint32_t id) const { return {rays_[id].o, rays_[id].d, 0, 0}; }

  HWY_INLINE unsigned intersect(uint32_t id, const BoxLanes& boxes, V8* nearest = nullptr) const {
    const StreamRay& r = rays_[id];
    return boxes.intersect(r.inverse, r.inverse, r.lower, r.upper, r.t, nearest);
  }

  HWY_INLINE void leaf(uint32_t ref, const uint32_t* ids, size_t n) {
    const uint32_t block = ref_index(ref);
    visit_pool(blocks_, ref_pool(ref),
               [&](const auto& blocks) RAIO_INLINE_LAMBDA { leaf(blocks[block], ids, n); });
  }

 private:
  // First all rays, without branches on results, since half would be mispredicted; then those with
  // candidates. For any-hit, the first step suffices.
  template <PrimitiveKind kind>
  HWY_INLINE void leaf(const Block<kind>& block, const uint32_t* ids, size_t n) {
    context_.tests += hwy::PopCount(BoxLanes::named(block.primitive)) * n;
    if (!g_.two_sided(kind)) {
      for (size_t i = 0; i < n; ++i) intersect_one_by_one<kind>(block.primitive, ids[i]);
      return;
    }
    if constexpr (kTestedInFloat<kind>)
      leaf_in_float(block, ids, n);
    else
      leaf_in_double(block, ids, n);
  }
  template <PrimitiveKind kind>
  HWY_INLINE void leaf_in_float(const Block<kind>& block, const uint32_t* ids, size_t n) {
    if (any) {
      for (size_t i = 0; i < n; ++i) occlude(block, ids[i]);
      return;
    }
    for (size_t first = 0; first < n; first += kCandidates) {
      const size_t end = std::min(n, first + kCandidates);
      size_t found = 0;
      for (size_t i = first; i < end; ++i) {
        Candidate& c = candidates_[found];
        c.id = ids[i];
        c.mask = intersect(block, ids[i], c);
        found += c.mask != 0;
      }
      for (size_t i = 0; i < found; ++i) {
        const Candidate& c = candidates_[i];
        for_bits(c.mask, [&](int k) { offer<kind>(c, k, block.primitive[k]); });
      }
    }
  }

  // For an any-hit ray.
  template <class Block>
  HWY_INLINE void occlude(const Block& block, uint32_t id) {
    const auto& f = kEight;
    Candidate c;
    intersect(block, id, c);
    float& end = rays_[id].t;
    unsigned hits = 0;
    for (int i = 0; i < kBlockWidth; i += kLanes8) {
      const V8 t = distance(block, c, i);
      hits |= bits(f, hn::And(hn::Gt(t, hn::Zero(f)), hn::Lt(t, hn::Set(f, end))));
    }
    const float ends[] = {end, kOccluded};
    end = batch_.t[id] = ends[hits != 0];
  }
  static HWY_INLINE V8 distance(const TriangleBlock&, const Candidate& c, int i) {
    return hn::Div(hn::Load(kEight, c.t + i), hn::Load(kEight, c.det + i));
  }
  static HWY_INLINE V8 distance(const SphereBlock&, const Candidate& c, int i) {
    return chord_distance(kEight, hn::Load(kEight, c.t + i), hn::Load(kEight, c.det + i));
  }

  template <PrimitiveKind kind>
  HWY_INLINE void offer(const Candidate& c, int k, PrimitiveId primitive) {
    if (kind == PrimitiveKind::triangle) {
      const float det = c.det[k];
      return take<kind>(c.id, c.t[k] / det, primitive, c.u[k] / det, c.v[k] / det);
    }
    const float half = std::sqrt(c.det[k]);
    take<kind>(c.id, c.t[k] - half > 0 ? c.t[k] - half : c.t[k] + half, primitive, 0, 0);
  }

  // Takes a hit if it is the nearest; among equally near ones, the lowest id.
  template <PrimitiveKind kind>
  HWY_INLINE void take(uint32_t id, float t, PrimitiveId primitive, float u, float v) {
    float& best = rays_[id].t;
    if (!(t > 0 && t <= best)) return;
    if constexpr (query == Query::depths) {
      if (t < best && !batch_.depths->add(batch_.first_depth + id,
                                          g_.depth_of(kind, g_.index_of(kind, primitive))))
        best = batch_.t[id] = kOccluded;
      return;
    }
    if constexpr (query == Query::next_transparent) {
      const float after = batch_.after_t[id];
      if (t < after || (t == after && primitive <= batch_.after_primitive[id])) return;
    }
    if (any) {
      if (t < best) best = batch_.t[id] = kOccluded;
      return;
    }
    PrimitiveId& old = batch_.primitive[id];
    if (t == best && (old == kNoPrimitive || old <= primitive)) return;
    if constexpr (query == Query::next_transparent)
      if (batch_.keys && !g_.stops(kind, g_.index_of(kind, primitive), batch_.keys[id])) return;
    best = batch_.t[id] = t, old = primitive;
    batch_.u[id] = u, batch_.v[id] = v;
  }

  HWY_INLINE unsigned intersect(const SphereBlock& block, uint32_t id, Candidate& c) const {
    const auto& f = kEight;
    const StreamRay& r = rays_[id];
    unsigned mask = 0;
    for (int i = 0; i < kBlockWidth; i += kLanes8) {
      const V8 radius = hn::Load(f, block.radius + i);
      const auto hit = chord_test(f, hn::Sub(hn::Load(f, block.x + i), hn::Set(f, r.o[0])),
                                  hn::Sub(hn::Load(f, block.y + i), hn::Set(f, r.o[1])),
                                  hn::Sub(hn::Load(f, block.z + i), hn::Set(f, r.o[2])), radius,
                                  hn::Set(f, r.d[0]), hn::Set(f, r.d[1]), hn::Set(f, r.d[2]));
      // Neither behind the origin nor beyond the nearest hit; the root is computed later.
      const V8 half = hn::Mul(radius, hn::Set(f, 1 + 4 * kEpsilon));
      const M8 near = hn::And(hn::Ge(hn::Add(hit.middle, half), hn::Zero(f)),
                              hn::Le(hn::Sub(hit.middle, half), hn::Set(f, r.t)));
      mask |= bits(f, hn::And(hit.in, near)) << i;
      hn::Store(hit.middle, f, c.t + i), hn::Store(hit.d2, f, c.det + i);
    }
    return mask;
  }

  HWY_INLINE unsigned intersect(const TriangleBlock& block, uint32_t id, Candidate& c) const {
    const auto& f = kEight;
    const StreamRay& r = rays_[id];
    const StreamShear& s = shears_[id];
    const uint8_t* const k = kShearAxes[int(s.axes)];
    const V8 ox = hn::Set(f, r.o[k[0]]), oy = hn::Set(f, r.o[k[1]]), oz = hn::Set(f, r.o[k[2]]);
    const V8 sx = hn::Set(f, s.x), sy = hn::Set(f, s.y), sz = hn::Set(f, s.z);
    unsigned mask = 0;
    for (int i = 0; i < kBlockWidth; i += kLanes8) {
      V8 x[3], y[3], z[3];
      for (int p = 0; p < 3; ++p) {
        const V8 depth = hn::Sub(hn::Load(f, &block.corner[p][k[2]][i]), oz);
        x[p] = hn::Sub(hn::Sub(hn::Load(f, &block.corner[p][k[0]][i]), ox), hn::Mul(sx, depth));
        y[p] = hn::Sub(hn::Sub(hn::Load(f, &block.corner[p][k[1]][i]), oy), hn::Mul(sy, depth));
        z[p] = hn::Mul(sz, depth);
      }
      auto hit = edge_test(f, x, y, z);
      hit.in = hn::And(hit.in, within_reach(f, x, y));
      mask |= bits(f, hit.in) << i;
      // Zero is not in front of the origin.
      hn::Store(hn::IfThenElseZero(hit.in, hit.t), f, c.t + i), hn::Store(hit.det, f, c.det + i);
      hn::Store(hit.u, f, c.u + i), hn::Store(hit.v, f, c.v + i);
    }
    return mask;
  }

  // Tests in double are expensive: boxes and passes_by() cull most primitives, and the remaining
  // pairs fill all lanes, whatever ray they belong to.
  template <PrimitiveKind kind>
  HWY_INLINE void leaf_in_double(const Block<kind>& block, const uint32_t* ids, size_t n) {
    const BoxLanes boxes(block.boxes, block.primitive);
    for (size_t first = 0; first < n; first += kCandidates) {
      size_t found = 0;
      for (size_t i = first; i < std::min(n, first + kCandidates); ++i)
        for_bits(near(block, boxes, ids[i]), [&](int k) {
          pairs_.id[found] = int32_t(ids[i]), pairs_.lane[found] = k;
          ++found;
        });
      for (size_t i = found; i % kLanesD != 0; ++i) pairs_.id[i] = pairs_.lane[i] = 0;
      for (size_t i = 0; i < found; i += kLanesD) intersect_pairs(block, i, found);
    }
  }

  // Which primitives a ray may hit.
  template <PrimitiveKind kind>
  HWY_INLINE unsigned near(const Block<kind>& block, const BoxLanes& boxes, uint32_t id) const {
    const unsigned mask = intersect(id, boxes);
    if (mask == 0) return 0;
    const StreamRay& r = rays_[id];
    unsigned aside = 0;
    if constexpr (requires { passes_by(kEight, block.numbers, 0, r.o, r.d, kSlack); })
      for (int i = 0; i < kBlockWidth; i += kLanes8)
        aside |= bits(kEight, passes_by(kEight, block.numbers, i, r.o, r.d, kSlack)) << i;
    return mask & ~aside;
  }

  // Tests pairs first, first + 1, ... in the lanes, none from `end`.
  template <PrimitiveKind kind>
  HWY_INLINE void intersect_pairs(const Block<kind>& block, size_t first, size_t end) {
    const DemotedTag f;
    const hn::RebindToSigned<DemotedTag> ints;
    const int32_t *const id = pairs_.id + first, *const lane = pairs_.lane + first;
    constexpr int32_t kRow = sizeof(StreamRay) / sizeof(float);
    const auto of_ray = hn::Mul(hn::Load(ints, id), hn::Set(ints, kRow));
    const auto of_primitive = hn::Load(ints, lane);
    const auto ray = [&](const float* from) HWY_ATTR {
      return hn::PromoteTo(kDoubles, hn::GatherIndex(f, from, of_ray));
    };
    const auto numbers = widened(block.numbers, [&](const float* column) HWY_ATTR {
      // A permutation of one register that holds the column is faster than a gather.
      if constexpr (kLanesD == kBlockWidth)
        return hn::PromoteTo(kDoubles, hn::TableLookupLanes(hn::Load(f, column),
                                                            hn::IndicesFromVec(f, of_primitive)));
      else
        return hn::PromoteTo(kDoubles, hn::GatherIndex(f, column, of_primitive));
    });
    VD origin[3], dir[3];
    for (int a = 0; a < 3; ++a) origin[a] = ray(rays_->o + a), dir[a] = ray(rays_->d + a);
    const auto hit = first_hits_at<kind>(numbers, origin, dir, [&]() HWY_ATTR {
      return batch_.time
                 ? hn::PromoteTo(kDoubles, hn::GatherIndex(f, batch_.time, hn::Load(ints, id)))
                 : hn::Zero(kDoubles);
    });
    alignas(64) float t[kLanesD];
    hn::Store(hit.t, f, t);
    const unsigned exist = (1u << std::min(end - first, size_t(kLanesD))) - 1;
    for_bits(bits(f, hit.in) & exist,
             [&](int i) { take<kind>(uint32_t(id[i]), t[i], block.primitive[lane[i]], 0, 0); });
  }

  // One by one, for the rare surfaces visible from one side only.
  template <PrimitiveKind kind>
  void intersect_one_by_one(const PrimitiveId* primitives, uint32_t id) {
    for (int i = 0; i < kBlockWidth && primitives[i] != kNoPrimitive; ++i) {
      RayQuery alone(batch_.ray(id));
      // Accepts equally near hits, too.
      if (query == Query::closest || query == Query::next_transparent)
        alone.best.primitive = kNoPrimitive - 1;
      if (!test<kind>(g_, g_.index_of(kind, primitives[i]), alone)) continue;
      take<kind>(id, alone.best.t, primitives[i], alone.best.u, alone.best.v);
      if (any) return;
    }
  }

  const Geometry& g_;
  const Blocks& blocks_;
  const Batch& batch_;
  StreamRay* rays_;
  StreamShear* shears_;
  Candidate* candidates_;
  Pairs& pairs_;
  TraceContext& context_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
