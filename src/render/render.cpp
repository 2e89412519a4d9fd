#include "render/render.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <limits>
#include <vector>

#include "base/memory.h"
#include "render/classic.h"

namespace raio {
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

std::expected<std::unique_ptr<Film>, std::string> make_film(const Scene& scene,
                                                            const RenderOptions& options) {
  if (std::string why = picture_problem(options.width, options.height); !why.empty())
    return std::unexpected(std::move(why));
  return std::make_unique<Film>(options.width, options.height,
                                radiance_bound(scene, options.depth));
}

RenderResult render(const Scene& scene, const Accel& accel, const RenderOptions& options,
                    Film& film, RenderControl& control, const RenderTask& task) {
  const auto start = std::chrono::steady_clock::now();
  const ClassicScene classic(scene, accel, options);
  const uint32_t target = task.samples > 0 ? task.samples : classic.sampler.samples;

  std::vector<size_t> tiles;
  uint64_t work = 0;
  for (size_t t = task.shard; t < film.tiles(); t += task.shards)
    if (const uint32_t done = film.samples(t); done < target)
      tiles.push_back(t), work += target - done;
  control.rays_done = 0, control.work_done = 0;
  control.work_total = work;

  tbb::enumerable_thread_specific<std::unique_ptr<ClassicTracer>> tracers(
      [&] { return make_classic_tracer(classic, control); });
  on_threads(options.threads, [&] {
    tbb::parallel_for(size_t(0), tiles.size(), [&](size_t i) {
      if (!control.stop) tracers.local()->render(tiles[i], target, film);
    });
  });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return {!control.stop, elapsed.count()};
}

}  // namespace raio
