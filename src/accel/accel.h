// The common interface of acceleration structures. Whole batches of rays go through it, so the cost
// of virtual calls vanishes and a structure may trace its rays together as it likes.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "accel/geometry.h"
#include "accel/trace_log.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/ray.h"

namespace raio::core {

enum class AccelKind { automatic, none, grid, bvh, embree };

struct AccelOptions {
  AccelKind kind = AccelKind::automatic;
  float grid_factor = 0;  // cells per side, per cube root of the number of primitives; 0: automatic
  std::array<int, 3> grid_resolution{0, 0, 0};  // cells along x, y, z; 0 0 0: from grid_factor
  // For comparison with published counts: all primitives in the grid, each in the cells that its
  // box overlaps, and no mailboxing.
  bool grid_plain = false;
  // Count tests and steps. Costs a few per cent; the grid then traverses cell by cell, which takes
  // several times as long.
  bool counters = false;

  float opacity = 1;  // of primitives if neither they nor their materials have one

  friend bool operator==(const AccelOptions&, const AccelOptions&) = default;
};

/// Capacities of batches are multiples of this, so that SIMD accesses to the last elements stay
/// inside.
inline constexpr size_t kBatchPad = 16;
constexpr size_t padded(size_t n) { return (n + kBatchPad - 1) / kBatchPad * kBatchPad; }

/// Rays as a structure of arrays; the first size() elements are valid. A ray with tmax <= 0 hits
/// nothing.
class RayBatch {
 public:
  Column<float> ox, oy, oz, dx, dy, dz, tmax;
  Column<float> time;  // empty unless has_time()

  size_t size() const { return size_; }
  size_t capacity() const { return tmax.size(); }
  void clear() { size_ = 0; }
  /// Whether rays have their own times; otherwise all are 0.
  bool has_time() const { return has_time_; }
  /// Adds times, which are uninitialized.
  void add_time() {
    has_time_ = true;
    time.resize(capacity());
  }
  /// New elements are uninitialized.
  void resize(size_t n) {
    if (n > capacity()) grow(n);
    size_ = n;
  }
  void push(const Ray& r) {
    resize(size_ + 1);
    set(size_ - 1, r);
  }
  void set(size_t i, const Ray& r) {
    ox[i] = r.origin.x, oy[i] = r.origin.y, oz[i] = r.origin.z;
    dx[i] = r.dir.x, dy[i] = r.dir.y, dz[i] = r.dir.z;
    tmax[i] = r.tmax;
    if (has_time_) time[i] = r.time;
  }
  Ray operator[](size_t i) const {
    return {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}, tmax[i], has_time_ ? time[i] : 0};
  }

 private:
  void grow(size_t n) {
    n = padded(std::max(n, 2 * capacity()));
    for (auto* v : {&ox, &oy, &oz, &dx, &dy, &dz, &tmax}) v->resize(n);
    if (has_time_) time.resize(n);
  }

  size_t size_ = 0;
  bool has_time_ = false;
};

/// The hits of a batch of rays; see Hit.
class HitBatch {
 public:
  Column<float> t;
  Column<PrimitiveId> primitive;
  Column<float> u, v;
  Column<InstanceId> instance;  // 0 unless the scene has instances

  /// Makes room for at least n hits, uninitialized except for `instance`, which is 0.
  void reset(size_t n) {
    if (n <= t.size()) return;
    n = padded(n);
    t.resize(n), primitive.resize(n), u.resize(n), v.resize(n);
    instance.assign(n, 0);
  }
  void set(size_t i, const Hit& h) {
    t[i] = h.t, primitive[i] = h.primitive, u[i] = h.u, v[i] = h.v, instance[i] = h.instance;
  }
  Hit operator[](size_t i) const { return {t[i], primitive[i], u[i], v[i], instance[i]}; }
};

/// Input and counters for tracing a batch; one per thread.
struct TraceContext {
  const std::atomic<bool>* stop = nullptr;  // asks to stop; results are then meaningless
  bool coherent = false;                    // neighbours in the batch have similar directions
  uint64_t tests = 0;       // pairs of ray and primitive; complete with AccelOptions::counters
  uint64_t steps = 0;       // cells or nodes visited, counted in the same way
  TraceLog* log = nullptr;  // for Accel::log()

  bool stopped() const { return stop && stop->load(std::memory_order_relaxed); }
};

/// Properties of a structure, for users and statistics.
struct AccelInfo {
  std::string name;
  size_t bytes = 0;       // including the geometry's memory, without the scene
  size_t cells = 0;       // of a grid; nodes of a tree
  size_t references = 0;  // entries in the lists of all cells
  std::array<int, 3> resolution{0, 0, 0};
  size_t oversized = 0;  // primitives outside the structure, tested with every ray
  size_t instances = 0;  // of objects with their own structures, which count once
};

/// A box of a structure, for display.
struct AccelBox {
  Box3f box{};
  int level = 0;          // in a tree, 0 being the root; 0 for all cells of a grid
  size_t primitives = 0;  // listed in it or below it
};

/// A pseudo-level: boxes without boxes below.
inline constexpr int kLeafBoxes = -1;

/// The sum of the optical depths along each ray, and the largest of them. When the sum without the
/// largest exceeds a ray's limit, the ray stops: its sum becomes kMaxOpticalDepth. Sums only grow,
/// so the order of additions does not matter. A single depth stops no ray, so what is behind one
/// layer always gets the light that passes it.
class DepthBatch {
 public:
  static constexpr uint32_t kNoLimit = 0xffffffffu;

  Column<uint32_t> sum, largest, limit;

  /// Resets n rays to no depth and no limits; those with a nonzero `stopped`, if given, are
  /// stopped.
  void reset(size_t n, const uint8_t* stopped = nullptr) {
    if (n > sum.size()) sum.resize(padded(n)), largest.resize(padded(n)), limit.resize(padded(n));
    for (size_t i = 0; i < n; ++i) {
      sum[i] = stopped && stopped[i] ? kMaxOpticalDepth : 0;
      largest[i] = 0, limit[i] = kNoLimit;
    }
  }
  void take(size_t i, const DepthBatch& from, size_t k) {
    sum[i] = from.sum[k], largest[i] = from.largest[k], limit[i] = from.limit[k];
  }
  bool is_stopped(size_t i) const { return sum[i] >= kMaxOpticalDepth; }
  /// Whether the ray continues.
  bool add(size_t i, uint32_t depth) {
    largest[i] = std::max(largest[i], depth);
    sum[i] = std::min(sum[i] + depth, kMaxOpticalDepth);
    if (sum[i] - largest[i] > limit[i]) sum[i] = kMaxOpticalDepth;
    return !is_stopped(i);
  }
};

struct Bvh;       // accel/bvh/bvh.h
class Instances;  // accel/instances.h

/// Immutable once built; any number of threads may trace at the same time.
class Accel {
 public:
  virtual ~Accel();
  Accel(const Accel&) = delete;
  Accel& operator=(const Accel&) = delete;

  /// The nearest hit of each ray with 0 < t < tmax on opaque primitives (Geometry::is_opaque()).
  void closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const;

  /// Whether there is such a hit: 1 or 0 per ray; `hit` has room for padded(rays.size()).
  void occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const;

  /// Each transparent primitive counts once, at the ray's first hit. Finds the next such hit with 0
  /// < t < tmax after element i of `after`, which may have t = 0; among equally near hits the
  /// lowest id comes first. No hit if there are no more. With `keys`, one per ray, only hits that
  /// stop the ray count: each with the probability of its opacity, by a hash of key and primitive,
  /// so the order of tests does not matter.
  void next_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                        TraceContext& context, const uint32_t* keys = nullptr) const;
  /// Adds the optical depths of all such hits, for rays that are not stopped yet.
  void transparent_depths(const RayBatch& rays, DepthBatch& depths, TraceContext& context) const;
  /// closest() for transparent and opaque primitives together. Shortens rays to the opaque hit.
  void closest_of_all(RayBatch& rays, HitBatch& hits, TraceContext& context) const;
  /// Builds the tree for transparent hits, whatever the structure of opaque primitives; without it,
  /// all are tested. The error is one line: not enough memory.
  std::optional<std::string> build_transparent();

  /// From now on, rays also hit the scene's instances. The error is one line.
  std::optional<std::string> add_instances(std::unique_ptr<const Instances> instances);

  /// Traces one ray by itself and logs, one by one, the tests and steps counted for its nearest
  /// hit, or any hit. Nothing if the structure cannot tell: Embree, and a grid without
  /// AccelOptions::counters.
  virtual std::optional<TraceLog> log(const Ray& ray, bool any) const;

  /// Calls `see` for the boxes at a level of a tree and the leaves above it, or for all leaves; for
  /// a grid, for all non-empty cells at any level. Not called without a structure, or by Embree,
  /// which hides its boxes.
  virtual void boxes(int level, const std::function<void(const AccelBox&)>& see) const;

  AccelInfo info() const;

  /// The same structure, without instances, for a geometry with traces_like(geometry()), which it
  /// moves from. Null, and the geometry stays, if this structure cannot be shared.
  std::unique_ptr<Accel> shared_with(Geometry& geometry) const;
  /// Equal for those that share a structure.
  virtual const void* structure() const { return this; }

  const Geometry& geometry() const { return geometry_; }
  /// Of the prototype with this number; null if there is none.
  const Accel* prototype(size_t number) const;

 protected:
  explicit Accel(Geometry geometry);
  Geometry geometry_;

 private:
  // The same without instances, implemented by each structure.
  virtual void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const = 0;
  virtual void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const = 0;
  virtual AccelInfo describe() const = 0;
  virtual std::unique_ptr<Accel> share(Geometry&) const { return nullptr; }

  void try_all_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                           TraceContext& context, const uint32_t* keys) const;
  void sum_all_transparent(const RayBatch& rays, DepthBatch& depths, TraceContext& context) const;

  std::unique_ptr<const Instances> instances_;
  std::shared_ptr<const Bvh> transparent_;
};

/// Bakes the scene, which must outlive the result, and builds the structure selected by `options`
/// (`automatic`: the best for the scene). `one_sided` and `with_sources` as for Geometry. `like`:
/// of another scene, with the same options; trees of objects that differ only in colours and
/// materials are shared. Errors: not enough memory (no_resource), options that contradict each
/// other (bad_option), a stopped executor (stopped).
std::expected<std::unique_ptr<Accel>, Error> build_accel(const Scene& scene,
                                                         const AccelOptions& options,
                                                         bool one_sided = false,
                                                         bool with_sources = false,
                                                         const Accel* like = nullptr);
void build_accel(Scene&&, const AccelOptions&, bool = false, bool = false,
                 const Accel* = nullptr) = delete;

}  // namespace raio::core
