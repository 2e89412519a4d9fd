// Parts of a picture rendered again and again, for those who measure: effect_costs.h, grid_curve.h.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>

#include "accel/accel.h"
#include "base/error.h"
#include "base/median.h"
#include "integrate/control.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio {

/// How closely the costs are measured.
struct MeasuringEffort {
  double close_enough = 0.03;  // half of the interval of a ratio, as a part of the median
  double least_run_s = 0.02;   // shorter runs are repeated, to be above the clock's noise
};

/// The options with the samples of the benchmark: 9 a pixel with antialiasing, 3 with depth of
/// field, 27 with both; of the picture itself, without view and channels.
RenderOptions timed_options(const RenderOptions& options, const Scene& scene);

struct TimedRun {
  double seconds = 0;  // of a share those for which threads work, divided among them
  RayCounts rays;
  uint64_t pixels = 0;  // that were rendered
};

/// Renders every `share`th tile; nothing when told to stop. The error is make_film()'s.
std::expected<std::optional<TimedRun>, Error> render_share(const Scene& scene, const Accel& accel,
                                                           const RenderSettings& settings,
                                                           uint32_t share, RenderControl& control);

/// So many tiles a thread are enough that all threads end together.
inline constexpr size_t kTilesPerThread = 8;

/// Every how manieth tile is worth rendering where all of them take `seconds`: so that a run is
/// short, but leaves each thread `per_thread` tiles, and not those of the same columns.
uint32_t share_for(const Scene& scene, const RenderSettings& settings, double seconds,
                   size_t per_thread);

}  // namespace raio
