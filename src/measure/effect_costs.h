// What each effect costs a picture: the picture is rendered with and without it, in turns, on the
// same pixels and with all samples, until the ratio of their times is known closely. Rays, tests
// and steps of both are counted exactly.
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <vector>

#include "accel/accel.h"
#include "integrate/control.h"
#include "integrate/film.h"
#include "measure/effects.h"
#include "measure/timed_share.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio {

struct EffectCost {
  Effect effect = Effect::antialiasing;
  bool on = false;  // in the options
  enum Presence : uint8_t {
    in_picture,
    not_in_scene,    // is_in_scene() says so
    not_in_picture,  // no ray of this picture has to do with it
  } presence = in_picture;

  int rounds = 0;           // that were measured; 0: nothing of what follows is known yet
  bool finished = false;    // no more will be
  MedianInterval factor{};  // seconds with it by seconds without it, round by round

  struct Side {
    double seconds = 0;      // of the whole picture; median
    RayCounts rays;          // of `pixels`
    bool has_steps = false;  // the rays' tests and steps are counted
  };
  Side with{}, without{};
  uint64_t pixels = 0;  // whose rays were counted; `seconds` are scaled to the picture
};

struct EffectCosts {
  int width = 0, height = 0;
  std::vector<EffectCost> effects;  // in the order of kEffects
  bool finished = false;
  double done = 0, left_s = 0;  // 0 to 1, and what it will take at least until that is 1
};

/// Measures the costs of all effects for a picture with `options`, whose view, channels and numbers
/// of samples do not count: samples are those of the benchmark, 9 a pixel with antialiasing, 3 with
/// depth of field, 27 with both. `accel` is the structure that the options ask for.
///
/// Each round renders the picture as it is, and then with each effect switched, in an order that
/// is turned round every other time, on as many threads as a render; an effect drops out when the
/// interval of its ratio is as close to the median as `effort` says, or when time is up. Of
/// pictures that take long, every nth tile is rendered, the same in all rounds; brute force, which
/// takes longest, renders fewer tiles than the structure that it is compared with, and its seconds
/// are scaled by the numbers of rays. Tests and steps are those of a structure with
/// AccelOptions::counters.
///
/// `on_news` gets what is known so far, after each round and now and then between two runs, outside
/// of what is timed. Told to stop by `control` it ends soon, without `finished`. Errors: those of
/// make_film() and build_accel().
std::expected<EffectCosts, Error> measure_effects(
    const Scene& scene, const Accel& accel, const RenderOptions& options, RenderControl& control,
    const std::function<void(const EffectCosts&)>& on_news = {},
    const MeasuringEffort& effort = {});

}  // namespace raio
