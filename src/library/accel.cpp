// Accel of the public interface: traces the caller's rays, a batch at a time.
#include "accel/accel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "integrate/surface.h"
#include "library/library.h"

namespace raio::inline v1 {

using namespace core;           // NOLINT(google-build-using-namespace)
using namespace core::library;  // NOLINT(google-build-using-namespace)

namespace {

// Kept per thread: a single ray must not allocate memory.
struct Scratch {
  RayBatch rays;
  HitBatch hits;
  std::vector<uint8_t> occluded;
  DepthBatch depths;
};

core::Ray ray_of(const Ray& ray, size_t number, Vec3d scene_origin) {
  const Vec3d origin = vec(ray.origin);
  Vec3d direction = vec(ray.direction);
  if (!is_finite(origin) || !is_finite(direction) || std::isnan(ray.length) ||
      !std::isfinite(ray.time))
    refuse(fmt::format("ray {}: a number is not finite", number));
  const double longest = max_component(abs(direction));
  if (longest == 0) refuse(fmt::format("ray {}: the direction is zero", number));
  // Squares of such numbers leave the range of doubles.
  if (longest > 1e150 || longest < 1e-150) direction = direction / longest;
  return {Vec3f(origin - scene_origin), Vec3f(normalize(direction)), float(ray.length),
          float(ray.time)};
}

// Calls trace(scratch, first, count, context) for chunks of the rays.
template <class Trace>
void in_batches(const Accel::Data& data, size_t count, const Ray* rays, const void* results,
                const Trace& trace) {
  if (count > 0 && !(rays && results)) refuse("rays or results are a null pointer");
  constexpr size_t kBatch = 1024;
  thread_local Scratch scratch;
  if (!scratch.rays.has_time()) scratch.rays.add_time();
  TraceContext context;
  for (size_t first = 0; first < count; first += kBatch) {
    const size_t n = std::min(kBatch, count - first);
    scratch.rays.resize(n);
    for (size_t i = 0; i < n; ++i)
      scratch.rays.set(i, ray_of(rays[first + i], first + i, data.scene.origin));
    trace(scratch, first, n, context);
  }
}

constexpr Kind kind_of(PrimitiveKind kind) {
  switch (kind) {
    case PrimitiveKind::plane:
      return Kind::plane;
    case PrimitiveKind::sphere:
      return Kind::sphere;
    case PrimitiveKind::triangle:
      return Kind::triangle;
    case PrimitiveKind::cone:
      return Kind::cone;
    case PrimitiveKind::ellipsoid:
      return Kind::ellipsoid;
    case PrimitiveKind::disc:
      return Kind::disc;
    case PrimitiveKind::moving_sphere:
      return Kind::moving_sphere;
    case PrimitiveKind::moving_triangle:
      break;
  }
  return Kind::moving_triangle;
}

Hit hit_of(const Accel::Data& data, const core::Ray& ray, const core::Hit& found) {
  if (!found.found()) return {};
  const Geometry& whole = data.accel->geometry();
  const Geometry& geometry = whole.object_at(found.instance);
  const Surface surface = surface_at(whole, ray, found);
  const PrimitiveKind kind = geometry.kind_of(found.primitive);
  Hit hit{double(found.t),
          kind_of(kind),
          geometry.index_of(kind, found.primitive),
          surface.material,
          triple(data.scene.origin + Vec3d(surface.point)),
          triple(Vec3d(surface.normal))};
  if (found.instance) hit.instance = whole.placed(found.instance).index;
  if (hit.kind != Kind::triangle) return hit;
  const size_t source = geometry.source_of(hit.index), triangles = geometry.count_of_triangles();
  if (source < triangles) {
    hit.index = uint32_t(source), hit.u = double(found.u), hit.v = double(found.v);
  } else {
    hit.kind = Kind::polygon, hit.index = uint32_t(source - triangles);
  }
  return hit;
}

// Whether anything is hit, of rays of this batch.
void find_occluded(const Accel::Data& data, Scratch& scratch, size_t n, TraceContext& context) {
  scratch.occluded.resize(padded(n));
  data.accel->occluded(scratch.rays, scratch.occluded.data(), context);
  if (!data.accel->geometry().any_transparent()) return;
  scratch.depths.reset(n, scratch.occluded.data());
  data.accel->transparent_depths(scratch.rays, scratch.depths, context);
  for (size_t i = 0; i < n; ++i) scratch.occluded[i] = scratch.depths.sum[i] > 0;
}

}  // namespace

const std::string& Accel::Data::hash() const {
  std::call_once(is_hashed_, [&] { hash_ = content_hash(scene); });
  return hash_;
}

Accel::Accel(Scene scene, const Settings& settings, const Accel* like) {
  guarded_work(settings.data().options.threads, [&] {
    const auto data = std::make_shared<Data>();
    data->scene = std::move(scene.data_->scene);
    data->has_background = scene.data_->has_background;
    data->read = scene.data_->read;
    data->options = settings.data().options;
    if (const auto problems = validate(data->scene); !problems.empty()) refuse(problems.front());
    if (const auto why = option_conflict(data->options)) fail(*why);
    const RenderSettings resolved = resolve_options(data->options, data->scene);
    data->options.accel = resolved.accel;
    const bool is_alike = like && like->data_->options.accel == resolved.accel &&
                          like->data_->options.one_sided == resolved.one_sided;
    data->options.one_sided = resolved.one_sided;
    auto accel = build_accel(data->scene, resolved.accel, resolved.one_sided, true,
                             is_alike ? like->data_->accel.get() : nullptr);
    if (!accel) fail(accel.error());
    data->accel = std::move(*accel);
    data_ = data;
  });
}

void Accel::closest(size_t count, const Ray* rays, Hit* hits) const {
  guarded([&] {
    in_batches(*data_, count, rays, hits,
               [&](Scratch& scratch, size_t first, size_t n, TraceContext& context) {
                 data_->accel->closest_of_all(scratch.rays, scratch.hits, context);
                 for (size_t i = 0; i < n; ++i)
                   hits[first + i] = hit_of(*data_, scratch.rays[i], scratch.hits[i]);
               });
  });
}

void Accel::occluded(size_t count, const Ray* rays, uint8_t* occluded) const {
  guarded([&] {
    in_batches(*data_, count, rays, occluded,
               [&](Scratch& scratch, size_t first, size_t n, TraceContext& context) {
                 find_occluded(*data_, scratch, n, context);
                 std::copy_n(scratch.occluded.begin(), n, occluded + first);
               });
  });
}

namespace {

// Rays in the caller's arrays, whose rows may lie anywhere.
struct RayColumns {
  const Column<float, 3>&origins, &directions;
  const Column<float>& lengths;  // perhaps none

  Ray operator[](size_t i) const {
    Ray ray{triple_at(origins, i), triple_at(directions, i)};
    if (lengths.data) ray.length = double(at(lengths, i, 0));
    return ray;
  }

 private:
  template <size_t N>
  static float at(const Column<float, N>& column, size_t i, size_t k) {
    float value = 0;
    const char* const row =
        reinterpret_cast<const char*>(column.data) + ptrdiff_t(i) * column.stride;
    std::memcpy(&value, row + k * sizeof(float), sizeof value);
    return value;
  }
  static Triple triple_at(const Column<float, 3>& column, size_t i) {
    return {double(at(column, i, 0)), double(at(column, i, 1)), double(at(column, i, 2))};
  }
};

// Orders rays so that those in similar directions that enter the scene's box nearby follow each
// other. They then find the nodes that they need in the processor's caches, which halves the time
// of random rays in a large scene.
class RayOrder {
 public:
  explicit RayOrder(const Box3f& box) : box_(box) {
    for (int axis = 0; axis < 3; ++axis)
      cells_per_unit_[axis] = kCells / std::max(box.hi[axis] - box.lo[axis], 1e-30f);
  }

  // The numbers of all rays, by a counting sort.
  void sort(std::span<const core::Ray> rays, std::vector<uint32_t>& order) {
    keys_.resize(rays.size());
    counts_.assign(kKeys + 1, 0);
    for (size_t i = 0; i < rays.size(); ++i) ++counts_[(keys_[i] = key_of(rays[i])) + 1];
    std::partial_sum(counts_.begin(), counts_.end(), counts_.begin());
    order.resize(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) order[counts_[keys_[i]]++] = uint32_t(i);
  }

 private:
  static constexpr uint32_t kCellBits = 5, kCells = 1 << kCellBits;
  static constexpr size_t kKeys = size_t(8) << (3 * kCellBits);

  uint32_t key_of(const core::Ray& ray) const {
    float enter = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (const float d = ray.dir[axis]; d != 0)
        enter = std::max(enter, ((d > 0 ? box_.lo : box_.hi)[axis] - ray.origin[axis]) / d);
    uint32_t key = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float place =
          (ray.origin[axis] + enter * ray.dir[axis] - box_.lo[axis]) * cells_per_unit_[axis];
      // Also for NaN.
      const uint32_t cell = place > 0 ? uint32_t(std::min(place, float(kCells - 1))) : 0;
      for (uint32_t bit = 0; bit < kCellBits; ++bit)
        key |= (cell >> bit & 1) << (3 * bit + uint32_t(axis));
      key |= uint32_t(ray.dir[axis] < 0) << (3 * kCellBits + uint32_t(axis));
    }
    return key;
  }

  Box3f box_;
  Vec3f cells_per_unit_;
  std::vector<uint32_t> keys_, counts_;
};

// Calls trace(scratch, numbers, context) for batches of the rays, on all threads: ray i of the
// batch is the caller's ray numbers[i].
template <class Trace>
void in_parallel(const Accel::Data& data, const RayColumns& rays, const Trace& trace) {
  const size_t count = rays.origins.count;
  if (rays.directions.count != count || (rays.lengths.data && rays.lengths.count != count))
    refuse(
        fmt::format("found {} origins, but {} directions{}", count, rays.directions.count,
                    rays.lengths.data ? fmt::format(" and {} lengths", rays.lengths.count) : ""));
  if (count > 0 && !(rays.origins.data && rays.directions.data))
    refuse("the rays are a null pointer");
  constexpr size_t kBatch = 4096, kLargestBlock = size_t(1) << 18;
  const size_t block = std::clamp(count / (8 * size_t(max_concurrency())), kBatch, kLargestBlock);
  struct Worker {
    explicit Worker(const Box3f& box) : order(box) {}

    Scratch scratch;
    RayOrder order;
    std::vector<core::Ray> rays;
    std::vector<uint32_t> sorted;
    std::vector<size_t> numbers;
  };
  // Few rays would not repay the search for the scene's box.
  const bool is_sorted = count > kBatch;
  PerThread<Worker> workers(
      [box = is_sorted ? bounds(data.scene) : Box3f()] { return Worker(box); });
  parallel_for((count + block - 1) / block, [&](size_t b) {
    Worker& w = workers.local();
    const size_t first = b * block, n = std::min(block, count - first);
    w.rays.resize(n);
    for (size_t i = 0; i < n; ++i)
      w.rays[i] = ray_of(rays[first + i], first + i, data.scene.origin);
    if (is_sorted) {
      w.order.sort(w.rays, w.sorted);
    } else {
      w.sorted.resize(n);
      std::iota(w.sorted.begin(), w.sorted.end(), 0);
    }
    for (size_t begin = 0; begin < n; begin += kBatch) {
      check_stop();
      const size_t size = std::min(kBatch, n - begin);
      w.scratch.rays.resize(size), w.numbers.resize(size);
      for (size_t i = 0; i < size; ++i) {
        w.scratch.rays.set(i, w.rays[w.sorted[begin + i]]);
        w.numbers[i] = first + w.sorted[begin + i];
      }
      TraceContext context;
      trace(w.scratch, std::span<const size_t>(w.numbers), context);
    }
  });
}

}  // namespace

void Accel::closest(const Column<float, 3>& origins, const Column<float, 3>& directions,
                    const Column<float>& lengths, const Hits& hits) const {
  const bool only_distance =
      !(hits.kind || hits.index || hits.instance || hits.position || hits.normal || hits.uv);
  guarded_work(0, [&] {
    in_parallel(*data_, {origins, directions, lengths},
                [&](Scratch& scratch, std::span<const size_t> numbers, TraceContext& context) {
                  data_->accel->closest_of_all(scratch.rays, scratch.hits, context);
                  for (size_t i = 0; i < numbers.size(); ++i) {
                    const size_t to = numbers[i];
                    const core::Hit nearest = scratch.hits[i];
                    if (hits.distance) hits.distance[to] = nearest.found() ? nearest.t : INFINITY;
                    if (only_distance) continue;
                    const Hit hit = hit_of(*data_, scratch.rays[i], nearest);
                    const bool found = hit.found();
                    if (hits.kind) hits.kind[to] = uint8_t(hit.kind);
                    if (hits.index) hits.index[to] = found ? int64_t(hit.index) : -1;
                    if (hits.instance) hits.instance[to] = hit.instance;
                    for (size_t k = 0; k < 3; ++k) {
                      if (hits.position)
                        hits.position[3 * to + k] = found ? float(hit.position[k]) : NAN;
                      if (hits.normal) hits.normal[3 * to + k] = float(hit.normal[k]);
                    }
                    if (hits.uv) hits.uv[2 * to] = float(hit.u), hits.uv[2 * to + 1] = float(hit.v);
                  }
                });
  });
}

void Accel::occluded(const Column<float, 3>& origins, const Column<float, 3>& directions,
                     const Column<float>& lengths, uint8_t* occluded) const {
  guarded_work(0, [&] {
    in_parallel(*data_, {origins, directions, lengths},
                [&](Scratch& scratch, std::span<const size_t> numbers, TraceContext& context) {
                  find_occluded(*data_, scratch, numbers.size(), context);
                  for (size_t i = 0; i < numbers.size(); ++i)
                    occluded[numbers[i]] = scratch.occluded[i];
                });
  });
}

Hit Accel::closest(const Ray& ray) const {
  Hit hit;
  closest(1, &ray, &hit);
  return hit;
}

bool Accel::occluded(const Ray& ray) const {
  uint8_t found = 0;
  occluded(1, &ray, &found);
  return found != 0;
}

Accel::Info Accel::info() const {
  const AccelInfo info = data_->accel->info();
  size_t primitives = 0;
  for_each_kind(
      [&]<PrimitiveKind kind> { primitives += data_->accel->geometry().count_all(kind); });
  return {info.name, primitives, info.bytes, info.cells, info.references};
}

std::optional<std::array<Triple, 2>> Accel::bounds() const { return bounds_of(data_->scene); }

}  // namespace raio::inline v1
