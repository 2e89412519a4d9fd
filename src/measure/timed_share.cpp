#include "measure/timed_share.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "measure/effects.h"
#include "render/render.h"

namespace raio::core {
namespace {

constexpr double kMaxRunSeconds = 0.6;  // expected of the slowest run

}  // namespace

RenderOptions sampled_options(RenderOptions o) {
  o.view = View::picture, o.channels = {};
  if (o.integrator == IntegratorKind::views) o.integrator.reset();
  return o;
}

RenderOptions timed_options(const RenderOptions& options, const Scene& scene) {
  RenderOptions o = sampled_options(options);
  o.samples = 0, o.sampler = SamplerKind::jitter;
  for (const Effect e : {Effect::antialiasing, Effect::depth_of_field})
    o = with_effect(o, e, is_on(e, options, scene), scene);
  return o;
}

std::expected<std::optional<TimedRun>, Error> render_share(const Scene& scene, const Accel& accel,
                                                           const RenderSettings& settings,
                                                           uint32_t share, WorkControl& control,
                                                           uint32_t samples) {
  const auto film = make_film(scene, settings);
  if (!film) return std::unexpected(film.error());
  const RenderResult done =
      render(scene, accel, settings, **film, control, {.samples = samples, .shards = share});
  if (!done.finished) return std::nullopt;
  // With few tiles, some threads finish long before others; their waiting does not count.
  const size_t tiles = ((*film)->tiles() + share - 1) / share;
  const auto at_work = double(std::min(size_t(std::max(1, settings.threads)), tiles));
  TimedRun run{share > 1 ? done.busy_s / at_work : done.seconds, (*film)->rays(), 0};
  run.pixels = run.rays.eye / uint64_t(samples > 0 ? int(samples) : settings.samples_per_pixel());
  return run;
}

uint32_t share_for(const Scene& scene, const RenderSettings& settings, double seconds,
                   size_t per_thread) {
  const auto film = make_film(scene, settings);
  if (!film) return 1;
  const size_t tiles = (*film)->tiles(), threads = size_t(std::max(1, settings.threads));
  const auto most = uint32_t(std::clamp(tiles / (per_thread * threads), size_t(1), tiles));
  auto share = uint32_t(std::clamp(std::ceil(seconds / kMaxRunSeconds), 1.0, double(most)));
  size_t columns = 0;
  while (columns < tiles && (*film)->tile(columns).y0 == 0) ++columns;
  while (share > 1 && std::gcd(size_t(share), columns) > 1) --share;
  return share;
}

}  // namespace raio::core
