// Accel of the public interface: traces the caller's rays, a batch at a time.
#include "accel/accel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

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

// Calls trace(scratch, first, count, context) for chunks of the rays, on all threads.
template <class Trace>
void in_parallel(const Accel::Data& data, const Column<float, 3>& origins,
                 const Column<float, 3>& directions, const Column<float>& lengths,
                 const Trace& trace) {
  const size_t count = origins.count;
  if (directions.count != count || (lengths.data && lengths.count != count))
    refuse(fmt::format("found {} origins, but {} directions{}", count, directions.count,
                       lengths.data ? fmt::format(" and {} lengths", lengths.count) : ""));
  if (count > 0 && !(origins.data && directions.data)) refuse("the rays are a null pointer");
  // Rows may lie anywhere.
  const auto at = [](const auto& column, size_t i, size_t k) {
    float value = 0;
    const char* const row =
        reinterpret_cast<const char*>(column.data) + ptrdiff_t(i) * column.stride;
    std::memcpy(&value, row + k * sizeof(float), sizeof value);
    return value;
  };
  const auto triple_at = [&](const Column<float, 3>& column, size_t i) {
    return Triple{double(at(column, i, 0)), double(at(column, i, 1)), double(at(column, i, 2))};
  };
  constexpr size_t kBatch = 4096;
  PerThread<Scratch> scratches;
  parallel_for((count + kBatch - 1) / kBatch, [&](size_t batch) {
    Scratch& scratch = scratches.local();
    TraceContext context;
    const size_t first = batch * kBatch, n = std::min(kBatch, count - first);
    scratch.rays.resize(n);
    for (size_t i = first; i < first + n; ++i) {
      Ray ray{triple_at(origins, i), triple_at(directions, i)};
      if (lengths.data) ray.length = double(at(lengths, i, 0));
      scratch.rays.set(i - first, ray_of(ray, i, data.scene.origin));
    }
    trace(scratch, first, n, context);
  });
}

}  // namespace

void Accel::closest(const Column<float, 3>& origins, const Column<float, 3>& directions,
                    const Column<float>& lengths, const Hits& hits) const {
  const bool only_distance =
      !(hits.kind || hits.index || hits.instance || hits.position || hits.normal || hits.uv);
  guarded_work(0, [&] {
    in_parallel(*data_, origins, directions, lengths,
                [&](Scratch& scratch, size_t first, size_t n, TraceContext& context) {
                  data_->accel->closest_of_all(scratch.rays, scratch.hits, context);
                  for (size_t i = 0; i < n; ++i) {
                    const size_t to = first + i;
                    if (hits.distance) hits.distance[to] = scratch.hits[i].t;
                    if (only_distance) continue;
                    const Hit hit = hit_of(*data_, scratch.rays[i], scratch.hits[i]);
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
    in_parallel(*data_, origins, directions, lengths,
                [&](Scratch& scratch, size_t first, size_t n, TraceContext& context) {
                  find_occluded(*data_, scratch, n, context);
                  std::copy_n(scratch.occluded.begin(), n, occluded + first);
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
