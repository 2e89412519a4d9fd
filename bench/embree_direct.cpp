#include "bench/embree_direct.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include "bench/figures.h"

namespace raio::core::bench {
namespace {

constexpr size_t kWidth = 8;

// While it lives, sets the mode that Embree's documentation advises.
struct FlushDenormals {
#if defined(__SSE__)
  FlushDenormals() { _mm_setcsr(saved | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~FlushDenormals() { _mm_setcsr(saved); }
  unsigned saved = _mm_getcsr();
#endif
};

// Eight rays of the batch, which has padding for as many after its end; `valid` says which are
// active.
void fill(RTCRay8& out, int* valid, const RayBatch& r, size_t first) {
  const auto copy = [first](float* to, const Column<float>& from) {
    std::memcpy(to, from.data() + first, kWidth * sizeof(float));
  };
  copy(out.org_x, r.ox), copy(out.org_y, r.oy), copy(out.org_z, r.oz);
  copy(out.dir_x, r.dx), copy(out.dir_y, r.dy), copy(out.dir_z, r.dz), copy(out.tfar, r.tmax);
  for (size_t k = 0; k < kWidth; ++k) {
    out.tnear[k] = 0, out.time[k] = 0, out.mask[k] = ~0u, out.flags[k] = 0;
    valid[k] = first + k < r.size() ? -1 : 0;
  }
}

// Output of a stream, and columns that batches do not have. One per thread.
struct StreamColumns {
  Column<float> zero, tfar, ng_x, ng_y, ng_z, u, v;
  Column<unsigned> mask, flags, prim, geom, instance;

  RTCRayHitNp fill(const RayBatch& r) {
    const size_t n = r.size();
    if (zero.size() < n) {
      zero.assign(n, 0), mask.assign(n, ~0u), flags.assign(n, 0);
      for (auto* column : {&tfar, &ng_x, &ng_y, &ng_z, &u, &v}) column->resize(n);
      for (auto* column : {&prim, &geom, &instance}) column->resize(n);
    }
    std::copy_n(r.tmax.data(), n, tfar.data());
    std::fill_n(geom.data(), n, RTC_INVALID_GEOMETRY_ID);
    // Embree only reads through pointers to float here.
    const auto in = [](const Column<float>& c) { return const_cast<float*>(c.data()); };
    return {{in(r.ox), in(r.oy), in(r.oz), zero.data(), in(r.dx), in(r.dy), in(r.dz), zero.data(),
             tfar.data(), mask.data(), flags.data(), flags.data()},
            {ng_x.data(),
             ng_y.data(),
             ng_z.data(),
             u.data(),
             v.data(),
             prim.data(),
             geom.data(),
             {instance.data()}}};
  }
};

bool count_bytes(void* sum, ssize_t bytes, bool) {
  *static_cast<std::atomic<ssize_t>*>(sum) += bytes;
  return true;
}

template <class T>
T* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t size, size_t n) {
  void* buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, size, n);
  if (!buffer) give_up(3, "out of memory for Embree's buffers");
  return static_cast<T*>(buffer);
}

void attach(RTCScene scene, RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

}  // namespace

EmbreeScene::EmbreeScene(const Geometry& geometry) {
  const FlushDenormals flush;
  device_ = rtcNewDevice(nullptr);
  if (!device_) give_up(3, "Embree cannot start");
  rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
  scene_ = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
  if (geometry.count(PrimitiveKind::sphere) > 0) add_spheres(geometry);
  if (geometry.count(PrimitiveKind::triangle) > 0) add_triangles(geometry);
  rtcCommitScene(scene_);
  if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE)
    give_up(3, fmt::format("Embree cannot build its structure (error {})", int(error)));
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreeScene::add_spheres(const Geometry& geometry) {
  const uint32_t n = uint32_t(geometry.count(PrimitiveKind::sphere));
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* out = new_buffer<float>(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, 16, n);
  for (uint32_t i = 0; i < n; ++i) {
    const Sphere s = geometry.sphere(i);
    for (const float f : {s.center.x, s.center.y, s.center.z, s.radius}) *out++ = f;
  }
  attach(scene_, g);
}

void EmbreeScene::add_triangles(const Geometry& geometry) {
  const Scene& scene = geometry.scene();
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  const auto vertices = [&](size_t n) {
    return new_buffer<Vec3f>(g, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(Vec3f), n);
  };
  const auto indices = [&](size_t n) {
    return new_buffer<TriangleIndices>(g, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 12, n);
  };
  if (scene.polygons.empty()) {  // vertices are shared
    std::ranges::copy(scene.positions, vertices(scene.positions.size()));
    std::ranges::copy(scene.triangles, indices(scene.triangles.size()));
  } else {
    const uint32_t n = uint32_t(geometry.count(PrimitiveKind::triangle));
    Vec3f* corner = vertices(3 * size_t(n));
    TriangleIndices* index = indices(n);
    for (uint32_t i = 0; i < n; ++i) {
      const Triangle t = geometry.triangle(i);
      for (const Vec3f& v : {t.a, t.b, t.c}) *corner++ = v;
      *index++ = {3 * i, 3 * i + 1, 3 * i + 2};
    }
  }
  attach(scene_, g);
}

size_t EmbreeScene::trace(const RayBatch& r, const EmbreeWay& way, bool shadow) const {
  const FlushDenormals flush;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      way.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  size_t found = 0;
  const auto count = [&](float tfar, unsigned geometry) {
    found += shadow ? tfar < 0 : geometry != RTC_INVALID_GEOMETRY_ID;
  };
  switch (way.shape) {
    case EmbreeWay::single:
      for (size_t i = 0; i < r.size(); ++i) {
        RTCRayHit query{
            {r.ox[i], r.oy[i], r.oz[i], 0, r.dx[i], r.dy[i], r.dz[i], 0, r.tmax[i], ~0u, 0, 0}, {}};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        shadow ? rtcOccluded1(scene_, &context, &query.ray)
               : rtcIntersect1(scene_, &context, &query);
        count(query.ray.tfar, query.hit.geomID);
      }
      break;
    case EmbreeWay::packet:
      for (size_t i = 0; i < r.size(); i += kWidth) {
        RTCRayHit8 query;
        alignas(32) int valid[kWidth];
        fill(query.ray, valid, r, i);
        std::fill_n(query.hit.geomID, kWidth, RTC_INVALID_GEOMETRY_ID);
        shadow ? rtcOccluded8(valid, scene_, &context, &query.ray)
               : rtcIntersect8(valid, scene_, &context, &query);
        for (size_t k = 0; k < kWidth; ++k)
          if (valid[k]) count(query.ray.tfar[k], query.hit.geomID[k]);
      }
      break;
    case EmbreeWay::stream:
      thread_local StreamColumns columns;
      RTCRayHitNp query = columns.fill(r);
      shadow ? rtcOccludedNp(scene_, &context, &query.ray, unsigned(r.size()))
             : rtcIntersectNp(scene_, &context, &query, unsigned(r.size()));
      for (size_t i = 0; i < r.size(); ++i) count(columns.tfar[i], columns.geom[i]);
      break;
  }
  return found;
}

}  // namespace raio::core::bench
