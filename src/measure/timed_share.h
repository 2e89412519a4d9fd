// Repeated renders of parts of a picture, for effect_costs.h and grid_curve.h.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>

#include "accel/accel.h"
#include "base/error.h"
#include "base/executor.h"
#include "base/median.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core {

/// The precision of measured costs.
struct MeasuringEffort {
  double close_enough = 0.03;  // half the interval of a ratio, relative to the median
  double least_run_s = 0.02;   // shorter runs are repeated to exceed the noise of the clock
};

/// The options with the benchmark's samples: 9 per pixel with antialiasing, 3 with depth of field,
/// 27 with both; for the picture itself, without view and channels.
RenderOptions timed_options(const RenderOptions& options, const Scene& scene);

struct TimedRun {
  double seconds =
      0;  // for a part of the picture, the threads' working time divided by their number
  RayCounts rays;
  uint64_t pixels = 0;  // that were rendered
};

/// The options of the picture itself, without view and channels.
RenderOptions sampled_options(RenderOptions options);

/// Renders every `share`th tile, with so many samples per pixel (0: all); nothing if stopped. The
/// error is make_film()'s.
std::expected<std::optional<TimedRun>, Error> render_share(const Scene& scene, const Accel& accel,
                                                           const RenderSettings& settings,
                                                           uint32_t share, WorkControl& control,
                                                           uint32_t samples = 0);

/// Enough tiles per thread for all threads to end at about the same time.
inline constexpr size_t kTilesPerThread = 8;

/// Chooses n for rendering every nth tile if all take `seconds`: short runs, but with `per_thread`
/// tiles for each thread, and not all in the same columns.
uint32_t share_for(const Scene& scene, const RenderSettings& settings, double seconds,
                   size_t per_thread);

}  // namespace raio::core
