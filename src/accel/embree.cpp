// Embree 3 behind the common interface: a yardstick for speed and an independent oracle of hits.
//
// Used as its documentation advises: a high-quality build; robust mode, which closes the edges
// between triangles; packets of eight, with the coherence flag; denormals flushed while it runs.
// Kinds that Embree does not have, all but spheres and triangles, are user geometry with Raio's
// test; infinite planes are tested first. Embree decides which primitive is hit; Raio's test then
// finds the point, since mirrors magnify differences in the last bits of a distance.
#include <embree3/rtcore.h>
#include <fmt/core.h>

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include <bit>

#include "accel/intersect.h"
#include "accel/structures.h"
#include "base/lazy_library.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

// Loaded only on demand.
constexpr char kEmbree[] = "libembree3.so.3";

// Flushes denormals while it lives, if the machine can.
class FlushDenormals {
 public:
#if defined(__SSE__)
  FlushDenormals() {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  ~FlushDenormals() { _mm_setcsr(saved_); }

 private:
  unsigned saved_ = _mm_getcsr();
#endif
};

constexpr unsigned kWidth = 8;

class Embree final : public Accel {
 public:
  explicit Embree(Geometry geometry) : Accel(std::move(geometry)) {}

  ~Embree() override {
    if (scene_) call<kEmbree, rtcReleaseScene>(scene_);
    if (device_) call<kEmbree, rtcReleaseDevice>(device_);
  }

  std::optional<std::string> build() {
    if (auto loaded = load_library(kEmbree); !loaded) return loaded.error();
    device_ = call<kEmbree, rtcNewDevice>(nullptr);
    if (!device_)
      return fmt::format("Embree cannot start (error {})",
                         int(call<kEmbree, rtcGetDeviceError>(nullptr)));
    call<kEmbree, rtcSetDeviceMemoryMonitorFunction>(device_, count_bytes, this);
    scene_ = call<kEmbree, rtcNewScene>(device_);
    call<kEmbree, rtcSetSceneBuildQuality>(scene_, RTC_BUILD_QUALITY_HIGH);
    call<kEmbree, rtcSetSceneFlags>(scene_, RTC_SCENE_FLAG_ROBUST);
    for_each_bounded_kind([&]<PrimitiveKind kind> {
      if constexpr (kind == PrimitiveKind::sphere)
        add_spheres();
      else if constexpr (kind == PrimitiveKind::triangle)
        add_triangles();
      else
        add_own<kind>();
    });
    call<kEmbree, rtcSetSceneProgressMonitorFunction>(scene_, may_continue,
                                                      const_cast<WorkScope*>(WorkScope::current()));
    call<kEmbree, rtcCommitScene>(scene_);
    check_stop();
    const RTCError error = call<kEmbree, rtcGetDeviceError>(device_);
    if (error != RTC_ERROR_NONE)
      return fmt::format("Embree cannot build its structure (error {}{})", int(error),
                         error == RTC_ERROR_OUT_OF_MEMORY ? ": out of memory" : "");
    return std::nullopt;
  }

  void find_closest(const RayBatch& rays, HitBatch& hits, TraceContext& context) const override {
    hits.reset(rays.size());
    const FlushDenormals flush;
    RTCIntersectContext embree = make_context(context);
    size_t i = 0;
    for (; i + 1 < rays.size() && !context.stopped(); i += kWidth) closest8(rays, i, hits, embree);
    for (; i < rays.size() && !context.stopped(); ++i) {
      hits.set(i, nearest_plane(rays[i]).best);
      RTCRayHit query;
      query.ray = single(rays[i], hits.t[i]);
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      call<kEmbree, rtcIntersect1>(scene_, &embree, &query);
      if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID)
        hits.set(
            i, refined(rays[i], {query.ray.tfar,
                                 geometry_.id_of(PrimitiveKind(query.hit.geomID), query.hit.primID),
                                 query.hit.u, query.hit.v}));
    }
  }

  void find_any(const RayBatch& rays, uint8_t* hit, TraceContext& context) const override {
    const FlushDenormals flush;
    RTCIntersectContext embree = make_context(context);
    size_t i = 0;
    for (; i + 1 < rays.size() && !context.stopped(); i += kWidth) occluded8(rays, i, hit, embree);
    for (; i < rays.size() && !context.stopped(); ++i) {
      hit[i] = nearest_plane(rays[i]).best.found();
      if (hit[i] || !(rays.tmax[i] > 0)) continue;
      RTCRay query = single(rays[i], rays.tmax[i]);
      call<kEmbree, rtcOccluded1>(scene_, &embree, &query);
      hit[i] = query.tfar < 0;
    }
  }

  AccelInfo describe() const override {
    return {.name = "embree",
            .bytes = geometry_.bytes() + size_t(bytes_.load()),
            .oversized = geometry_.count(PrimitiveKind::plane)};
  }

 private:
  // Called by Embree's threads while they build.
  static bool may_continue(void* scope, double) {
    const WorkScope::Bound bound(static_cast<const WorkScope*>(scope));
    return !stop_requested();
  }

  // A geometry of the scene, which owns it, to be committed; its id is its PrimitiveKind.
  RTCGeometry add_geometry(RTCGeometryType type, PrimitiveKind kind) {
    RTCGeometry g = call<kEmbree, rtcNewGeometry>(device_, type);
    call<kEmbree, rtcAttachGeometryByID>(scene_, g, unsigned(kind));
    call<kEmbree, rtcReleaseGeometry>(g);
    return g;
  }

  // Transparent primitives become NaN, which Embree leaves out.
  static constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  bool is_here(PrimitiveKind kind, uint32_t i) const { return geometry_.is_opaque(kind, i); }

  void add_spheres() {
    const size_t n = geometry_.count(PrimitiveKind::sphere);
    if (n == 0) return;
    RTCGeometry g = add_geometry(RTC_GEOMETRY_TYPE_SPHERE_POINT, PrimitiveKind::sphere);
    auto* out = static_cast<float*>(call<kEmbree, rtcSetNewGeometryBuffer>(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, n));
    if (!out) return;
    for_each_index(n, [&](size_t i) {
      Sphere s = geometry_.sphere(uint32_t(i));
      if (!is_here(PrimitiveKind::sphere, uint32_t(i))) s.center = Vec3f(kNan);
      float* const to = out + 4 * i;
      to[0] = s.center.x, to[1] = s.center.y, to[2] = s.center.z, to[3] = s.radius;
    });
    filter_sides(g, PrimitiveKind::sphere);
    call<kEmbree, rtcCommitGeometry>(g);
  }

  void add_triangles() {
    const size_t n = geometry_.count(PrimitiveKind::triangle);
    if (n == 0) return;
    RTCGeometry g = add_geometry(RTC_GEOMETRY_TYPE_TRIANGLE, PrimitiveKind::triangle);
    auto* out = static_cast<float*>(call<kEmbree, rtcSetNewGeometryBuffer>(
        g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * n));
    auto* index = static_cast<uint32_t*>(call<kEmbree, rtcSetNewGeometryBuffer>(
        g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, n));
    if (!out || !index) return;
    for_each_index(n, [&](size_t i) {
      Triangle t = geometry_.triangle(uint32_t(i));
      if (!is_here(PrimitiveKind::triangle, uint32_t(i))) t.a = t.b = t.c = Vec3f(kNan);
      float* to = out + 9 * i;
      for (const Vec3f& corner : {t.a, t.b, t.c})
        *to++ = corner.x, *to++ = corner.y, *to++ = corner.z;
      for (uint32_t k = 0; k < 3; ++k) index[3 * i + k] = uint32_t(3 * i) + k;
    });
    filter_sides(g, PrimitiveKind::triangle);
    call<kEmbree, rtcCommitGeometry>(g);
  }

  // A kind that Embree does not have.
  template <PrimitiveKind kind>
  void add_own() {
    const size_t n = geometry_.count(kind);
    if (n == 0) return;
    RTCGeometry g = add_geometry(RTC_GEOMETRY_TYPE_USER, kind);
    call<kEmbree, rtcSetGeometryUserPrimitiveCount>(g, unsigned(n));
    call<kEmbree, rtcSetGeometryUserData>(g, this);
    call<kEmbree, rtcSetGeometryBoundsFunction>(g, own_bounds<kind>, nullptr);
    call<kEmbree, rtcSetGeometryIntersectFunction>(g, own_closest<kind>);
    call<kEmbree, rtcSetGeometryOccludedFunction>(g, own_occluded<kind>);
    call<kEmbree, rtcCommitGeometry>(g);
  }

  // One-sided surfaces: Embree asks before it accepts a hit.
  void filter_sides(RTCGeometry g, PrimitiveKind kind) {
    if (geometry_.two_sided(kind)) return;
    call<kEmbree, rtcSetGeometryUserData>(g, this);
    call<kEmbree, rtcSetGeometryIntersectFilterFunction>(g, reject_unseen);
    call<kEmbree, rtcSetGeometryOccludedFilterFunction>(g, reject_unseen);
  }

  static void reject_unseen(const RTCFilterFunctionNArguments* args) {
    const auto& self = *static_cast<const Embree*>(args->geometryUserPtr);
    const unsigned n = args->N;
    for (unsigned i = 0; i < n; ++i) {
      if (args->valid[i] != -1) continue;
      const auto kind = PrimitiveKind(RTCHitN_geomID(args->hit, n, i));
      const float cosine = RTCHitN_Ng_x(args->hit, n, i) * RTCRayN_dir_x(args->ray, n, i) +
                           RTCHitN_Ng_y(args->hit, n, i) * RTCRayN_dir_y(args->ray, n, i) +
                           RTCHitN_Ng_z(args->hit, n, i) * RTCRayN_dir_z(args->ray, n, i);
      if (!visible(self.geometry_.sides_of(kind, RTCHitN_primID(args->hit, n, i)), cosine))
        args->valid[i] = 0;
    }
  }

  template <PrimitiveKind kind>
  static void own_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& self = *static_cast<const Embree*>(args->geometryUserPtr);
    Box3f b = bounds(self.geometry_.get<kind>(args->primID));
    if (!self.is_here(kind, args->primID)) b = {Vec3f(kNan), Vec3f(kNan)};
    *args->bounds_o = {b.lo.x, b.lo.y, b.lo.z, 0, b.hi.x, b.hi.y, b.hi.z, 0};
  }

  static RayQuery own_query(RTCRayN* r, unsigned n, unsigned i) {
    return RayQuery({{RTCRayN_org_x(r, n, i), RTCRayN_org_y(r, n, i), RTCRayN_org_z(r, n, i)},
                     {RTCRayN_dir_x(r, n, i), RTCRayN_dir_y(r, n, i), RTCRayN_dir_z(r, n, i)},
                     RTCRayN_tfar(r, n, i),
                     RTCRayN_time(r, n, i)});
  }

  template <PrimitiveKind kind>
  static void own_closest(const RTCIntersectFunctionNArguments* args) {
    const auto& self = *static_cast<const Embree*>(args->geometryUserPtr);
    const unsigned n = args->N;
    RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
    RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
    for (unsigned i = 0; i < n; ++i) {
      if (args->valid[i] != -1) continue;
      RayQuery query = own_query(rays, n, i);
      if (!test<kind>(self.geometry_, args->primID, query)) continue;
      RTCRayN_tfar(rays, n, i) = query.best.t;
      RTCHitN_geomID(hits, n, i) = args->geomID;
      RTCHitN_primID(hits, n, i) = args->primID;
    }
  }

  template <PrimitiveKind kind>
  static void own_occluded(const RTCOccludedFunctionNArguments* args) {
    const auto& self = *static_cast<const Embree*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
      if (args->valid[i] != -1) continue;
      RayQuery query = own_query(args->ray, args->N, i);
      if (test<kind>(self.geometry_, args->primID, query))
        RTCRayN_tfar(args->ray, args->N, i) = -std::numeric_limits<float>::infinity();
    }
  }

  static bool count_bytes(void* self, ssize_t bytes, bool) {
    static_cast<Embree*>(self)->bytes_ += bytes;
    return true;
  }

  static RTCIntersectContext make_context(const TraceContext& context) {
    RTCIntersectContext c;
    rtcInitIntersectContext(&c);
    c.flags = context.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return c;
  }

  static RTCRay single(const Ray& r, float tfar) {
    return {r.origin.x, r.origin.y, r.origin.z, 0,   r.dir.x, r.dir.y,
            r.dir.z,    r.time,     tfar,       ~0u, 0,       0};
  }

  RayQuery nearest_plane(const Ray& ray) const {
    RayQuery query(ray);
    for (uint32_t i = 0; i < geometry_.count(PrimitiveKind::plane); ++i)
      if (is_here(PrimitiveKind::plane, i)) test<PrimitiveKind::plane>(geometry_, i, query);
    return query;
  }

  // Keeps a grazing hit that Raio's test misses.
  Hit refined(const Ray& ray, const Hit& hit) const {
    RayQuery query(ray);
    return test_primitive(geometry_, hit.primitive, query) ? query.best : hit;
  }

  // Lanes first .. first + 7 of the batch; the caller sets `tfar` and `valid`.
  static void fill(RTCRay8& out, const RayBatch& rays, size_t first, unsigned lanes) {
    for (unsigned k = 0; k < lanes; ++k) {
      const size_t i = first + k;
      out.org_x[k] = rays.ox[i], out.org_y[k] = rays.oy[i], out.org_z[k] = rays.oz[i];
      out.dir_x[k] = rays.dx[i], out.dir_y[k] = rays.dy[i], out.dir_z[k] = rays.dz[i];
      out.tnear[k] = 0, out.time[k] = rays.has_time() ? rays.time[i] : 0, out.mask[k] = ~0u,
      out.id[k] = k, out.flags[k] = 0;
    }
  }

  void closest8(const RayBatch& rays, size_t first, HitBatch& hits,
                RTCIntersectContext& embree) const {
    const unsigned lanes = unsigned(std::min<size_t>(kWidth, rays.size() - first));
    alignas(32) int valid[kWidth] = {};
    RTCRayHit8 query;
    fill(query.ray, rays, first, lanes);
    for (unsigned k = 0; k < lanes; ++k) {
      hits.set(first + k, nearest_plane(rays[first + k]).best);
      query.ray.tfar[k] = hits.t[first + k];
      query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
      valid[k] = rays.tmax[first + k] > 0 ? -1 : 0;
    }
    call<kEmbree, rtcIntersect8>(valid, scene_, &embree, &query);
    for (unsigned k = 0; k < lanes; ++k)
      if (query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID)
        hits.set(first + k,
                 refined(rays[first + k],
                         {query.ray.tfar[k],
                          geometry_.id_of(PrimitiveKind(query.hit.geomID[k]), query.hit.primID[k]),
                          query.hit.u[k], query.hit.v[k]}));
  }

  void occluded8(const RayBatch& rays, size_t first, uint8_t* hit,
                 RTCIntersectContext& embree) const {
    const unsigned lanes = unsigned(std::min<size_t>(kWidth, rays.size() - first));
    alignas(32) int valid[kWidth] = {};
    RTCRay8 query;
    fill(query, rays, first, lanes);
    for (unsigned k = 0; k < lanes; ++k) {
      hit[first + k] = nearest_plane(rays[first + k]).best.found();
      query.tfar[k] = rays.tmax[first + k];
      valid[k] = !hit[first + k] && rays.tmax[first + k] > 0 ? -1 : 0;
    }
    call<kEmbree, rtcOccluded8>(valid, scene_, &embree, &query);
    for (unsigned k = 0; k < lanes; ++k)
      if (valid[k]) hit[first + k] = query.tfar[k] < 0;
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::atomic<ssize_t> bytes_{0};
};

}  // namespace

AccelResult make_embree(Geometry geometry, const AccelOptions&) {
  auto embree = std::make_unique<Embree>(std::move(geometry));
  if (auto error = embree->build()) return std::unexpected(std::move(*error));
  return embree;
}

}  // namespace raio::core
