#include "render/render.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <limits>

#include "base/memory.h"
#include "render/classic.h"

namespace raio {
RayCounts& RayCounts::operator+=(const RayCounts& b) {
  eye += b.eye, eye_hits += b.eye_hits;
  reflection += b.reflection, refraction += b.refraction;
  shadow += b.shadow, shadow_hits += b.shadow_hits;
  tests += b.tests, steps += b.steps;
  return *this;
}

void on_threads(int threads, const std::function<void()>& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  tbb::task_arena(threads).execute(work);
}

std::string picture_problem(int width, int height) {
  const size_t pixels = size_t(width) * size_t(height);
  // The film, and the pictures in float and in bytes that are made of it.
  const double bytes = double(pixels) * (3 * sizeof(int64_t) + sizeof(Rgb) + 6);
  if (const double available = double(available_memory_bytes()); bytes > 0.9 * available)
    return fmt::format(
        "a picture of {}x{} pixels needs {:.1f} GB and {:.1f} GB are free; choose a smaller --size",
        width, height, bytes * 1e-9, available * 1e-9);
  // The sampler numbers them.
  if (pixels > std::numeric_limits<uint32_t>::max())
    return fmt::format("a picture of {}x{} has more than {} pixels; choose a smaller --size", width,
                       height, std::numeric_limits<uint32_t>::max());
  return {};
}

std::expected<std::optional<RenderResult>, std::string> render(const Scene& scene,
                                                               const Accel& accel,
                                                               const RenderOptions& options,
                                                               RenderControl& control) {
  if (std::string why = picture_problem(options.width, options.height); !why.empty())
    return std::unexpected(std::move(why));
  const auto start = std::chrono::steady_clock::now();
  const ClassicScene classic(scene, accel, options);
  const uint32_t samples = classic.sampler.samples;
  Film film(options.width, options.height, radiance_bound(scene, options.depth), samples);

  const int columns = (options.width + kTileSide - 1) / kTileSide;
  const int rows = (options.height + kTileSide - 1) / kTileSide;
  const size_t tiles = size_t(columns) * size_t(rows);
  control.rays_done = 0, control.work_done = 0;
  control.work_total = tiles * samples;

  tbb::enumerable_thread_specific<std::unique_ptr<ClassicTracer>> tracers(
      [&] { return make_classic_tracer(classic, control); });
  on_threads(options.threads, [&] {
    tbb::parallel_for(size_t(0), tiles, [&](size_t t) {
      const int x = int(t % size_t(columns)) * kTileSide, y = int(t / size_t(columns)) * kTileSide;
      const Tile tile{x, y, std::min(x + kTileSide, options.width),
                      std::min(y + kTileSide, options.height)};
      if (!control.stop) tracers.local()->render(tile, film);
    });
  });
  if (control.stop) return std::nullopt;

  RenderResult result{std::move(film), {}, 0};
  for (const auto& tracer : tracers) result.rays += tracer->counts();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace raio
