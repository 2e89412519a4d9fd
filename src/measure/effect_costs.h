// The cost of each effect in a picture: the picture is rendered with and without it, alternately,
// on the same pixels and with all samples, until the ratio of times is known precisely. Rays, tests
// and steps of both are counted exactly.
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <vector>

#include "accel/accel.h"
#include "base/executor.h"
#include "integrate/film.h"
#include "measure/effects.h"
#include "measure/timed_share.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core {

/// The timed work: one sample of each pixel of the picture that the options describe; or the whole
/// picture with the samples of the 2018 report, as the benchmark does: 9 per pixel with
/// antialiasing, 3 with depth of field, 27 with both.
enum class CostOf : uint8_t { sample, report };

struct EffectCost {
  Effect effect = Effect::antialiasing;
  bool on = false;  // in the options
  enum Presence : uint8_t {
    in_picture,
    not_in_scene,    // is_in_scene() says so
    not_in_picture,  // no ray of this picture is affected
    too_slow,        // brute force on these primitives cannot be timed in seconds
  } presence = in_picture;

  int rounds = 0;         // measured rounds; 0: the following is unknown
  bool finished = false;  // no more rounds follow
  /// The ratio of times with and without it, per round; of the structure, without and with it: how
  /// many times as fast the picture is.
  MedianInterval factor{};

  struct Side {
    double seconds = 0;      // scaled to all pixels; that of both sides have the ratio `factor`
    RayCounts rays;          // of `pixels`
    bool has_steps = false;  // the rays' tests and steps are counted
  };
  Side with{}, without{};
  uint64_t pixels = 0;  // with counted rays
};

struct EffectCosts {
  CostOf of = CostOf::sample;
  int width = 0, height = 0;
  std::vector<EffectCost> effects;  // in the order of kEffects
  bool finished = false;
  double done = 0, left_s = 0;  // 0 to 1, and the minimum remaining time
};

/// Measures the costs of all effects for a picture with `options`, ignoring view, channels and
/// numbers of samples. `accel` is the structure selected by the options.
///
/// Each round renders the picture as it is, and then with each effect switched, reversing the order
/// every other time, with as many threads as a render. An effect is finished when the interval of
/// its ratio is as close to the median as `effort` requires, or when time is up. For slow pictures
/// every nth tile is rendered, the same in all rounds. Brute force renders fewer tiles than the
/// structure, and its seconds are scaled by the numbers of rays. Tests and steps are those of a
/// structure with AccelOptions::counters.
///
/// `on_news` gets the results so far, after each round and occasionally between two runs, outside
/// of the timed part. If stopped by `control`, it ends soon, without `finished`. Errors: those of
/// make_film() and build_accel().
std::expected<EffectCosts, Error> measure_effects(
    const Scene& scene, const Accel& accel, const RenderOptions& options, CostOf what,
    WorkControl& control, const std::function<void(const EffectCosts&)>& on_news = {},
    const MeasuringEffort& effort = {});

}  // namespace raio::core
