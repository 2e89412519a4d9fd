// Renders a scene with its structure to a film: eye rays, shading, tiles on all cores.
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <optional>

#include "accel/accel.h"
#include "base/executor.h"
#include "base/parallel.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio::core {

/// What to add to a film.
struct RenderTask {
  uint32_t samples = 0;            // the target per pixel; 0: as many as the options say
  uint32_t first_sample = 0;       // skip the samples before this one
  uint32_t shard = 0, shards = 1;  // only tiles with number = `shard` modulo `shards`
  double seconds = 0;              // approximate limit; 0: none
  // Called by one of the threads that render, when it has finished some samples and so much time
  // has passed since the last call. What it throws ends the work and is thrown again.
  double interval_s = 0;
  std::function<void()> at_interval = {};  // NOLINT(readability-redundant-member-init)
};

struct RenderResult {
  bool finished = false;  // the whole task is done: not stopped, and time sufficed
  double seconds = 0;
  double busy_s = 0;  // of all threads together, without waiting for the last tiles
};

/// Why a picture of this many pixels is impossible, or nothing: not enough memory (no_resource).
/// Lets callers find out before they build a structure.
std::optional<Error> picture_problem(int width, int height, ChannelSet channels = {});

/// An empty film for the rendered part of a picture, or picture_problem().
std::expected<std::unique_ptr<Film>, Error> make_film(const Scene& scene,
                                                      const RenderSettings& settings);

/// Adds what the film lacks. Told to stop, by its control or its executor, it ends soon, and what
/// it has done by then is in the film: the same call goes on from there, to the same bytes. More
/// samples than a film has can be added where the sampler deals them without regard to their number
/// (SamplerKind::sobol).
///
/// With a time limit it goes over all tiles pass by pass, and the film ends with whole passes: all
/// tiles have the same number of samples, unless not even the first pass, or one begun earlier,
/// could be finished.
RenderResult render(const Scene& scene, const Accel& accel, const RenderSettings& settings,
                    Film& film, WorkControl& control, const RenderTask& task = {});

/// The film's picture, or for View::samples heat_color() of the samples per pixel.
Image picture_of(const Film& film, View view = View::picture);

}  // namespace raio::core
