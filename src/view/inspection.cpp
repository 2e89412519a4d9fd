#include "view/inspection.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "base/executor.h"

namespace raio::core::view {
namespace {

// Embree does not log its steps.
RenderSettings settings_of(const InspectionRequest& request) {
  RenderOptions options = request.options;
  if (options.accel.kind == AccelKind::embree) options.accel.kind = AccelKind::bvh;
  return app::explained_settings(options, *request.scene);
}

bool fits(const std::shared_ptr<const BakedScene>& baked, const InspectionRequest& request,
          const RenderSettings& settings) {
  // A tree can log without counters.
  AccelOptions wanted = settings.accel;
  const auto same = [&] { return baked->options == wanted; };
  if (!baked || baked->scene != request.scene || baked->one_sided != settings.one_sided)
    return false;
  if (same()) return true;
  wanted.counters = false;
  return wanted.kind == AccelKind::bvh && same();
}

std::expected<std::shared_ptr<const BakedScene>, Error> bake(const InspectionRequest& request,
                                                             const RenderSettings& settings) {
  if (fits(request.baked, request, settings)) return request.baked;
  auto baked = std::make_shared<BakedScene>();
  baked->scene = request.scene, baked->options = settings.accel;
  baked->one_sided = settings.one_sided;
  auto accel = build_accel(*request.scene, settings.accel, settings.one_sided);
  if (!accel) return std::unexpected(accel.error());
  baked->accel = std::move(*accel);
  baked->info = baked->accel->info();
  return baked;
}

// Finds the nearest primitive that blocks each stopped ray.
void find_stoppers(std::vector<RegionRay>& rays, const RayBatch& stopped,
                   const std::vector<size_t>& places, const Accel& accel) {
  HitBatch hits;
  hits.reset(stopped.size());
  TraceContext context;
  accel.closest(stopped, hits, context);
  for (size_t k = 0; k < places.size(); ++k) {
    if (!hits[k].found()) continue;
    RegionRay& r = rays[places[k]];
    const Geometry& geometry = accel.geometry().object_at(hits[k].instance);
    r.hit = geometry.kind_of(hits[k].primitive);
    r.material = geometry.material_of(hits[k].primitive);
    r.to = Vec3d(stopped[k].at(hits[k].t));
  }
}

void inspect_region(Inspected& out, const std::atomic<bool>& stop) {
  const InspectionRequest& q = out.request;
  const Accel& accel = *out.baked->accel;
  const int width = q.last[0] - q.pixel[0] + 1, height = q.last[1] - q.pixel[1] + 1;
  int step = 1;
  const auto along = [&](int n) { return (n + step - 1) / step; };
  while (double(along(width)) * along(height) > kMaxRegionPixels) ++step;
  RayBatch stopped;
  std::vector<size_t> places;
  for (int y = 0; y < height; y += step)
    for (int x = 0; x < width; x += step) {
      if (stop || out.rays.size() >= kMaxRegionRays) break;
      const auto one = explain_sample(*q.scene, accel, out.settings, q.pixel[0] + x, q.pixel[1] + y,
                                      uint32_t(q.sample));
      if (!one) continue;
      ++out.pixels;
      for (const ExplainedRay& r : one->rays) {
        if (out.rays.size() >= kMaxRegionRays) break;
        RegionRay ray{kind_of(r), r.level, Vec3d(r.ray.origin),
                      app::drawn_end(r, std::nullopt, out.side_view)};
        if (r.hit.found())
          ray.hit = accel.geometry().kind_of(r.hit.primitive), ray.material = r.surface->material;
        if (ray.kind == RayKind::stopped) stopped.push(r.ray), places.push_back(out.rays.size());
        out.rays.push_back(ray);
      }
    }
  find_stoppers(out.rays, stopped, places, accel);
}

}  // namespace

RayKind kind_of(const ExplainedRay& ray) {
  switch (ray.kind) {
    case ExplainedRay::Kind::eye:
      return RayKind::eye;
    case ExplainedRay::Kind::reflection:
      return RayKind::reflected;
    case ExplainedRay::Kind::refraction:
      return RayKind::refracted;
    case ExplainedRay::Kind::shadow:
      return ray.occluded ? RayKind::stopped : RayKind::lit;
  }
  return RayKind::eye;
}

bool RayFilter::passes(const RegionRay& ray) const {
  if (!kinds[size_t(ray.kind)] || (level > 0 && ray.level != level)) return false;
  switch (hits) {
    case Hits::anything:
      return true;
    case Hits::nothing:
      return !ray.hit;
    case Hits::kind:
      return ray.hit && int(*ray.hit) == number;
    case Hits::material:
      return ray.hit && int(ray.material) == number;
  }
  return true;
}

std::shared_ptr<const Inspected> inspect(const InspectionRequest& request,
                                         const std::atomic<bool>& stop) {
  auto out = std::make_shared<Inspected>();
  out->request = request;
  out->settings = settings_of(request);
  auto baked = bake(request, out->settings);
  if (!baked) {
    out->error = baked.error();
    return out;
  }
  out->baked = std::move(*baked);
  const Accel& accel = *out->baked->accel;
  // For a region: the pixel in its middle determines the side view.
  const int x = (request.pixel[0] + request.last[0]) / 2,
            y = (request.pixel[1] + request.last[1]) / 2;
  auto sample =
      explain_sample(*request.scene, accel, out->settings, x, y, uint32_t(request.sample));
  if (!sample) {
    out->error = sample.error();
    return out;
  }
  out->side_view = app::side_view(*sample, out->settings, {x, y},
                                  double(out->settings.width) / out->settings.height);
  if (request.is_region()) {
    inspect_region(*out, stop);
  } else {
    out->sample = std::move(*sample);
    out->logs = app::logs_of(out->sample, accel);
  }
  return out;
}

Inspection::~Inspection() {
  stop_ = true;
  if (working_.valid()) working_.wait();
}

void Inspection::start(InspectionRequest request) {
  stop_ = true;
  next_ = std::move(request);
  if (!working_.valid()) begin();
}

void Inspection::cancel() {
  stop_ = true;
  next_.reset();
}

void Inspection::begin() {
  stop_ = false;
  working_ = std::async(
      std::launch::async,
      [this, last = baked_, request = *std::exchange(next_, std::nullopt)]() mutable {
        std::shared_ptr<const Inspected> found;
        const auto fail = [&](std::string why) {
          auto failed = std::make_shared<Inspected>();
          failed->request = request;
          failed->error = Error{ErrorKind::no_resource, "", std::move(why)};
          found = failed;
        };
        try {
          if (std::string wrong = flatten(request); !wrong.empty()) {
            fail(std::move(wrong));
          } else {
            if (const RenderSettings settings = settings_of(request);
                !fits(request.baked, request, settings) && fits(last, request, settings))
              request.baked = last;
            found = Executor(request.options.threads).run([&] { return inspect(request, stop_); });
          }
        } catch (const std::bad_alloc&) {
          fail("not enough memory to inspect");
        }
        on_news_();
        return found;
      });
}

// The terms and steps of a ray name primitives of the scene, like `raio explain`.
std::string Inspection::flatten(InspectionRequest& request) {
  if (request.scene->instances.empty()) return {};
  if (copied_ != request.scene) {
    auto flat = std::make_shared<Scene>(*request.scene);
    if (std::string wrong = flatten_instances(*flat); !wrong.empty()) return wrong;
    copied_ = request.scene, flat_ = std::move(flat);
  }
  request.scene = flat_;
  return {};
}

std::shared_ptr<const Inspected> Inspection::poll() {
  if (!working_.valid() || working_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    return nullptr;
  auto found = working_.get();
  if (found->baked) baked_ = found->baked;
  const bool is_old = stop_;
  if (next_) begin();
  return is_old ? nullptr : found;
}

}  // namespace raio::core::view
