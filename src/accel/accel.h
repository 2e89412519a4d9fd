// Structures that find what rays hit, behind one interface: whole batches of rays go through it, so
// that the call costs nothing and a structure may trace its rays together in whatever way suits it.
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

namespace raio {

enum class AccelKind { automatic, none, grid, bvh, embree };

struct AccelOptions {
  AccelKind kind = AccelKind::automatic;
  float grid_factor = 0;  // cells a side per cube root of the number of primitives; 0: best
  std::array<int, 3> grid_resolution{0, 0, 0};  // cells along x, y, z; 0 0 0: by grid_factor
  // To be held against published counts: all primitives in the grid, each in the cells that its box
  // touches, and none remembered from one cell to the next.
  bool grid_plain = false;
  // Count tests and steps. Costs a few per cent; the grid then walks cell by cell, several times as
  // long.
  bool counters = false;

  float opacity = 1;  // of what has none of its own, by itself or by its material

  friend bool operator==(const AccelOptions&, const AccelOptions&) = default;
};

/// The capacity of batches is a multiple of this, so that wide loads and stores of the last
/// elements stay inside.
inline constexpr size_t kBatchPad = 16;
constexpr size_t padded(size_t n) { return (n + kBatchPad - 1) / kBatchPad * kBatchPad; }

/// Rays as the walks want them: one array per component, of which the first size() elements count.
/// A ray with tmax <= 0 meets nothing.
class RayBatch {
 public:
  Column<float> ox, oy, oz, dx, dy, dz, tmax;
  Column<float> time;  // empty without has_time()

  size_t size() const { return size_; }
  size_t capacity() const { return tmax.size(); }
  void clear() { size_ = 0; }
  /// Have the rays times of their own, rather than all 0?
  bool has_time() const { return has_time_; }
  /// From now on; unset.
  void add_time() {
    has_time_ = true;
    time.resize(capacity());
  }
  /// Elements beyond the old size are unset.
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

/// What the rays of a batch hit, element by element; see Hit.
class HitBatch {
 public:
  Column<float> t;
  Column<PrimitiveId> primitive;
  Column<float> u, v;
  Column<InstanceId> instance;  // 0 unless the scene has instances

  /// Makes room for at least n hits, all unset but that they belong to no instance.
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

/// What tracing a batch may read and must count into; one per thread.
struct TraceContext {
  const std::atomic<bool>* stop = nullptr;  // asks to give up; results are then without meaning
  bool coherent = false;                    // neighbours in the batch go nearly the same way
  uint64_t tests = 0;  // pairs of ray and primitive; counted for sure with AccelOptions::counters
  uint64_t steps = 0;  // cells or nodes visited; likewise
  TraceLog* log = nullptr;  // for Accel::log()

  bool stopped() const { return stop && stop->load(std::memory_order_relaxed); }
};

/// What a structure is made of, for people and statistics.
struct AccelInfo {
  std::string name;
  size_t bytes = 0;       // with what it has of the geometry besides the scene
  size_t cells = 0;       // of a grid, nodes of a tree
  size_t references = 0;  // primitives listed in all cells together
  std::array<int, 3> resolution{0, 0, 0};
  size_t oversized = 0;  // primitives kept outside and tested by every ray
  size_t instances = 0;  // of objects that have a structure of their own, which counts once
};

/// A box of a structure, for people to look at.
struct AccelBox {
  Box3f box{};
  int level = 0;          // of a tree; 0: the root's box, and all cells of a grid
  size_t primitives = 0;  // that it lists, or that are below it
};

/// Instead of a level: those boxes below which there are no others.
inline constexpr int kLeafBoxes = -1;

/// The optical depths that rays gather on their way, element by element: their sum, and the largest
/// of them. Once those beside the largest are more than a ray's limit, it is stopped: its sum is
/// kMaxOpticalDepth. As sums only grow, it does not matter in which order they are added. A single
/// depth stops no ray, so that behind one layer there is always as much as passes it.
class DepthBatch {
 public:
  static constexpr uint32_t kNoLimit = 0xffffffffu;

  Column<uint32_t> sum, largest, limit;

  /// Of n rays that have met nothing yet and have no limits; those for which `stopped` is not 0, if
  /// it is there, are stopped.
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
  /// Does the ray go on?
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

  /// The nearest hit of each ray with 0 < t < tmax on what is opaque (Geometry::is_opaque()).
  void closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const;

  /// Is there any such hit? 1 or 0 per ray; `hit` has room for padded(rays.size()).
  void occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const;

  /// A ray meets each clear primitive once, where it first hits it. The hit of this kind with
  /// 0 < t < tmax that comes next behind element i of `after`, which may have t = 0; of equally
  /// near ones that of the lowest id is first. No hit where there are no more. With `keys`, one
  /// for each ray, of those hits only that stop it: each as likely as it is opaque, by a hash of
  /// key and primitive, so that the order in which they are tried does not matter.
  void next_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                        TraceContext& context, const uint32_t* keys = nullptr) const;
  /// Adds the optical depths of all hits of this kind, of rays that are not stopped yet.
  void transparent_depths(const RayBatch& rays, DepthBatch& depths, TraceContext& context) const;
  /// As closest(), of what is clear as well as of what is opaque. Shortens rays to the latter.
  void closest_of_all(RayBatch& rays, HitBatch& hits, TraceContext& context) const;
  /// Builds the tree by which these find hits, whatever the structure of what is opaque;
  /// without it they try all primitives. The error is one line: memory that would not suffice.
  std::optional<std::string> build_transparent();

  /// From now on rays hit the scene's instances, too. The error is one line.
  std::optional<std::string> add_instances(std::unique_ptr<const Instances> instances);

  /// What a ray does on its own, step by step, to find its nearest hit, or any hit: the tests and
  /// steps that are counted for it, one by one. Nothing where the structure cannot tell: Embree,
  /// and a grid without AccelOptions::counters.
  virtual std::optional<TraceLog> log(const Ray& ray, bool any) const;

  /// Calls `see` for the boxes at a level of a tree and for the leaves above it, or for all leaves;
  /// for the cells of a grid that list something, whatever the level. For none where there is no
  /// structure, or one that does not show its boxes: Embree.
  virtual void boxes(int level, const std::function<void(const AccelBox&)>& see) const;

  AccelInfo info() const;

  const Geometry& geometry() const { return geometry_; }

 protected:
  explicit Accel(Geometry geometry);
  Geometry geometry_;

 private:
  // The same without instances: what a structure does.
  virtual void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const = 0;
  virtual void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const = 0;
  virtual AccelInfo describe() const = 0;

  void try_all_transparent(const RayBatch& rays, const HitBatch& after, HitBatch& hits,
                           TraceContext& context, const uint32_t* keys) const;
  void sum_all_transparent(const RayBatch& rays, DepthBatch& depths, TraceContext& context) const;

  std::unique_ptr<const Instances> instances_;
  std::unique_ptr<const Bvh> transparent_;
};

/// Bakes the scene, or an object that it shows, and builds the structure that `options` ask for
/// (`automatic`: the best for the scene). Both must outlive the result. `one_sided` and
/// `with_sources` as for Geometry.
/// Errors: memory that would not suffice (no_resource), options that do not fit together
/// (bad_option).
std::expected<std::unique_ptr<Accel>, Error> build_accel(const Scene& scene, const Object& object,
                                                         const AccelOptions& options,
                                                         bool one_sided = false,
                                                         bool with_sources = false);
inline std::expected<std::unique_ptr<Accel>, Error> build_accel(const Scene& scene,
                                                                const AccelOptions& options,
                                                                bool one_sided = false,
                                                                bool with_sources = false) {
  return build_accel(scene, scene, options, one_sided, with_sources);
}
void build_accel(Scene&&, const AccelOptions&, bool = false, bool = false) = delete;

}  // namespace raio
