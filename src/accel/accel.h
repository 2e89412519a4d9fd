// Structures that find what rays hit, behind one interface: whole batches of rays go through it, so
// that the call costs nothing and a structure may trace its rays together in whatever way suits it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <expected>
#include <memory>
#include <string>

#include "accel/geometry.h"
#include "base/ray.h"

namespace raio {

enum class AccelKind { automatic, none, grid, bvh, embree };

struct AccelOptions {
  AccelKind kind = AccelKind::automatic;
  float grid_factor = 0;  // cells a side per cube root of the number of primitives; 0: 2
  std::array<int, 3> grid_resolution{0, 0, 0};  // cells along x, y, z; 0 0 0: by grid_factor
  bool counters = false;                        // count tests and steps; costs a few per cent
};

/// Rays as the walks want them: one array per component, of which the first size() elements count.
/// Adding a ray checks for room once and not once per component.
class RayBatch {
 public:
  std::vector<float> ox, oy, oz, dx, dy, dz, tmax;

  size_t size() const { return size_; }
  size_t capacity() const { return tmax.size(); }
  void clear() { size_ = 0; }
  void drop_last(size_t count) { size_ -= count; }
  void push(const Ray& r) {
    if (size_ == capacity()) grow();
    const size_t i = size_++;
    ox[i] = r.origin.x, oy[i] = r.origin.y, oz[i] = r.origin.z;
    dx[i] = r.dir.x, dy[i] = r.dir.y, dz[i] = r.dir.z;
    tmax[i] = r.tmax;
  }
  Ray operator[](size_t i) const { return {{ox[i], oy[i], oz[i]}, {dx[i], dy[i], dz[i]}, tmax[i]}; }

 private:
  void grow() {
    const size_t n = std::max<size_t>(64, 2 * capacity());
    for (auto* v : {&ox, &oy, &oz, &dx, &dy, &dz, &tmax}) v->resize(n);
  }

  size_t size_ = 0;
};

/// What tracing a batch may read and must count into; one per thread.
struct TraceContext {
  const std::atomic<bool>* stop = nullptr;  // asks to give up; results are then without meaning
  bool coherent = false;                    // neighbours in the batch go nearly the same way
  uint64_t tests = 0;  // pairs of ray and primitive; counted for sure with AccelOptions::counters
  uint64_t steps = 0;  // cells or nodes visited; likewise

  bool stopped() const { return stop && stop->load(std::memory_order_relaxed); }
};

/// What a structure is made of, for people and statistics.
struct AccelInfo {
  std::string name;
  size_t bytes = 0;       // the structure with its copy of the geometry
  size_t cells = 0;       // of a grid, nodes of a tree
  size_t references = 0;  // primitives listed in all cells together
  std::array<int, 3> resolution{0, 0, 0};
  size_t giants = 0;  // primitives kept outside and tested by every ray
};

/// Immutable once built; any number of threads may trace at the same time.
class Accel {
 public:
  virtual ~Accel() = default;
  Accel(const Accel&) = delete;
  Accel& operator=(const Accel&) = delete;

  /// The nearest hit of each ray with 0 < t < tmax; `hits` has room for rays.size().
  virtual void closest(const RayBatch& rays, Hit* hits, TraceContext& context) const = 0;

  /// Is there any hit with 0 < t < tmax? 1 or 0 per ray.
  virtual void occluded(const RayBatch& rays, uint8_t* hit, TraceContext& context) const = 0;

  virtual AccelInfo info() const = 0;

  const Geometry& geometry() const { return geometry_; }

 protected:
  explicit Accel(Geometry geometry) : geometry_(std::move(geometry)) {}
  Geometry geometry_;
};

/// Bakes the scene and builds the structure that `options` ask for (`automatic`: the best for the
/// scene). `one_sided`: opaque surfaces are seen from outside only. The error is one line: memory
/// that would not suffice, or options that do not fit together.
std::expected<std::unique_ptr<Accel>, std::string> build_accel(const Scene& scene,
                                                               const AccelOptions& options,
                                                               bool one_sided = false);

}  // namespace raio
