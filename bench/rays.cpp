#include "bench/rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "bench/figures.h"
#include "integrate/camera.h"
#include "integrate/surface.h"
#include "render/options.h"
#include "render/render.h"
#include "shape/offset.h"

namespace raio::core::bench {
namespace {

constexpr int kTileSide = 32;
constexpr double kTestsToSpend = 4e9;       // of pairs of ray and primitive, to check a structure
constexpr double kGrazingOfEmbree = 0.005;  // share of rays, or of pixels

// Without smoothed normals of triangles.
Surface flat_surface(const Geometry& geometry, const Ray& ray, const Hit& hit) {
  if (hit.instance || geometry.kind_of(hit.primitive) != PrimitiveKind::triangle)
    return surface_at(geometry, ray, hit);
  const uint32_t i = geometry.index_of(PrimitiveKind::triangle, hit.primitive);
  const Triangle t = geometry.triangle(i);
  const Vec3f ab = t.b - t.a, ac = t.c - t.a;
  const float longest = std::max(max_component(abs(ab)), max_component(abs(ac)));
  return {{t.a + ab * hit.u + ac * hit.v, geometry.facet(i).normal, 2 * longest}, 0};
}

class Recorder {
 public:
  Recorder(const Scene& scene, const Accel& accel) : scene_(scene), accel_(accel) {}

  void tile(const EyeRays& eye, int x0, int y0, int x1, int y1) {
    RayBatch rays;
    const auto bit = [](int i, int from, int to) { return (i >> from & 1) << to; };
    for (int i = 0; i < kTileSide * kTileSide; ++i) {  // as the renderer
      const int x = x0 + (i & 3) + bit(i, 4, 2) + bit(i, 6, 3) + bit(i, 7, 4);
      const int y = y0 + bit(i, 2, 0) + bit(i, 3, 1) + bit(i, 5, 2) + bit(i, 8, 3) + bit(i, 9, 4);
      if (x < x1 && y < y1) rays.push(eye.pinhole(float(x) + 0.5f, float(y) + 0.5f));
    }
    accel_.closest(rays, hits_, context_);
    shadow_.assign(scene_.lights.size(), {}), reflection_ = {}, random_ = {};
    for (size_t i = 0; i < rays.size(); ++i)
      if (hits_[i].found()) leave_surface(rays[i], hits_[i]);
    keep(RayKind::eye, rays);
    for (const RayBatch& light : shadow_) keep(RayKind::shadow, light);
    keep(RayKind::reflection, reflection_);
    keep(RayKind::random, random_);
  }

  Recording recording;

 private:
  void keep(RayKind kind, const RayBatch& rays) {
    if (rays.size() > 0) recording.batches[size_t(kind)].push_back(rays);
  }

  void leave_surface(const Ray& ray, const Hit& hit) {
    const Surface surface = flat_surface(accel_.geometry(), ray, hit);
    const Vec3f normal = dot(surface.normal, ray.dir) < 0 ? surface.normal : -surface.normal;
    const float scale = max_component(abs(surface.point)) + surface.extent;
    const Vec3f origin = offset_origin(surface.point, normal, scale, true);

    for (size_t l = 0; l < scene_.lights.size(); ++l) {
      const Vec3f to_light = scene_.lights[l].position - origin;
      const float distance = length(to_light);
      const Vec3f dir = to_light * (1 / distance);
      if (dot(normal, dir) > 0) shadow_[l].push({origin, dir, distance * (1 - 0x1p-21f)});
    }

    reflection_.push({origin, normalize(ray.dir - normal * (2 * dot(ray.dir, normal)))});

    const float radius = std::sqrt(unit_(rng_)), turn = 2 * std::numbers::pi_v<float> * unit_(rng_);
    const Frame<float> frame(normal);
    const float up = std::sqrt(1 - radius * radius);
    random_.push({origin, normalize(frame.u * (radius * std::cos(turn)) +
                                    frame.v * (radius * std::sin(turn)) + normal * up)});
  }

  const Scene& scene_;
  const Accel& accel_;
  HitBatch hits_;
  TraceContext context_{.coherent = true};
  std::vector<RayBatch> shadow_;
  RayBatch reflection_, random_;
  std::mt19937 rng_;
  std::uniform_real_distribution<float> unit_{0, 1};
};

// Traces all rays of a kind, together as when timed, and a sample of them with `none`. Returns the
// differing fraction of the sample.
double differing_rays(const Accel& accel, const Accel& none, const Recording& rays, RayKind kind,
                      size_t sample) {
  const size_t stride = std::max<size_t>(1, rays.count(kind) / sample) | 1;
  RayBatch probe;
  HitBatch hits, expected;
  std::vector<Hit> found;
  size_t next = 0;
  for (const RayBatch& batch : rays.of(kind)) {
    trace_batch(accel, batch, kind, hits);
    for (; next < batch.size(); next += stride)
      probe.push(batch[next]), found.push_back(hits[next]);
    next -= batch.size();
  }
  trace_batch(none, probe, kind, expected);
  size_t differing = 0;
  for (size_t i = 0; i < found.size(); ++i)
    differing += kind == RayKind::shadow ? found[i].found() != expected[i].found()
                                         : found[i].primitive != expected.primitive[i] ||
                                               (found[i].found() && found[i].t != expected.t[i]);
  return found.empty() ? 0 : double(differing) / double(found.size());
}

Image small_picture(const Scene& scene, const Accel& accel, int side, int threads) {
  RenderOptions request;
  request.width = request.height = side, request.threads = threads;
  const RenderSettings options = resolve_options(request, scene);
  const auto film = make_film(scene, options);
  if (!film) give_up(3, film.error().text());
  WorkControl control;
  render(scene, accel, options, **film, control);
  return (*film)->resolve();
}

}  // namespace

size_t Recording::count(RayKind kind) const {
  size_t sum = 0;
  for (const RayBatch& batch : of(kind)) sum += batch.size();
  return sum;
}

Recording record_rays(const Scene& scene, const Accel& accel, const RenderOptions& options) {
  const RenderSettings o = resolve_options(options, scene);
  const EyeRays eye(scene.camera, o.width, o.height);
  Recorder recorder(scene, accel);
  for (int y = 0; y < o.height; y += kTileSide)
    for (int x = 0; x < o.width; x += kTileSide)
      recorder.tile(eye, x, y, std::min(x + kTileSide, o.width), std::min(y + kTileSide, o.height));
  return std::move(recorder.recording);
}

size_t trace_batch(const Accel& accel, const RayBatch& rays, RayKind kind, HitBatch& hits) {
  TraceContext context{.coherent = is_coherent(kind)};
  size_t found = 0;
  if (kind == RayKind::shadow) {
    thread_local std::vector<uint8_t> hidden;
    hidden.resize(std::max(hidden.size(), padded(rays.size())));
    accel.occluded(rays, hidden.data(), context);
    hits.reset(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) hits.primitive[i] = hidden[i] ? 0 : kNoPrimitive;
  } else {
    accel.closest(rays, hits, context);
  }
  for (size_t i = 0; i < rays.size(); ++i) found += hits.primitive[i] != kNoPrimitive;
  return found;
}

void check_structure(const Scene& scene, const Accel& accel, const Recording& rays, int threads) {
  const auto none = build_accel(scene, {.kind = AccelKind::none});
  if (!none) give_up(3, none.error().text());
  const std::string name = accel.info().name;
  const double allowed = name == "embree" ? kGrazingOfEmbree : 0;
  const double affordable =
      kTestsToSpend / double(std::max<size_t>(1, scene.primitive_count())) / 8;
  for (const RayKind kind : kRayKinds) {
    const double differing =
        differing_rays(accel, **none, rays, kind, size_t(std::clamp(affordable, 16.0, 4096.0)));
    if (differing > allowed)
      give_up(
          1, fmt::format("{}: the hits of {} differ from those of none for {:.3g} % of the {} rays",
                         scene.name, name, 100 * differing, kRayKindNames[size_t(kind)]));
  }
  const int side = int(std::clamp(std::sqrt(affordable), 8.0, 64.0));
  const Image expected = small_picture(scene, **none, side, threads);
  const Image picture = small_picture(scene, accel, side, threads);
  size_t differing = 0;
  for (size_t i = 0; i < picture.pixels.size(); ++i)
    differing += !(picture.pixels[i] == expected.pixels[i]);
  if (double(differing) > allowed * double(picture.pixels.size()))
    give_up(1, fmt::format("{}: the pictures of {} and none differ in {} of {} pixels", scene.name,
                           name, differing, picture.pixels.size()));
}

}  // namespace raio::core::bench
