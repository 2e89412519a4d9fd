// What a render says of itself when it is done: --stats (docs/statistics.md) and the line on
// standard error.
#pragma once

#include <string>

#include "accel/accel.h"
#include "app/json.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio::app {

struct Times {
  double load = 0, build = 0, render = 0, write = 0, total = 0;
};

/// What was made, and what it cost. Rays are those of the whole picture; without those that a film
/// had before, they are the work of this run.
struct Made {
  const Scene& scene;
  RenderSettings settings;
  AccelInfo accel;
  Times times;
  RayCounts rays;
  uint64_t rays_before = 0;
  uint32_t samples = 0;  // of a pixel
};

Json statistics(const Made& made);

/// "balls.png: 512x512, 1 sample a pixel, bvh: load 1 ms, ...".
std::string summary(const std::string& output, const Made& made);

}  // namespace raio::app
