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

/// The samples to add to a film.
struct RenderTask {
  uint32_t samples = 0;            // the target per pixel; 0: as the options say, also by `noise`
  uint32_t first_sample = 0;       // skip the samples before this one
  uint32_t shard = 0, shards = 1;  // only tiles with number = `shard` modulo `shards`
  double seconds = 0;              // approximate limit; 0: none
  // Called from a rendering thread, between samples, if this much time has passed since the last
  // call. An exception ends the work and is rethrown.
  double interval_s = 0;
  std::function<void()> at_interval = {};  // NOLINT(readability-redundant-member-init)
};

struct RenderResult {
  bool finished = false;  // the whole task is done: not stopped, and time sufficed
  double seconds = 0;
  double busy_s = 0;  // of all threads together, without waiting for the last tiles
};

/// Why a picture of this many pixels, or one of its shards, is impossible, or nothing: not enough
/// memory (no_resource). Lets callers find out before they build a structure.
std::optional<Error> picture_problem(int width, int height, const PlainOptions& options = {},
                                     uint32_t shards = 1);

/// An empty film for the rendered part of a picture, or one of its shards, or picture_problem().
std::expected<std::unique_ptr<Film>, Error> make_film(const Scene& scene,
                                                      const RenderSettings& settings,
                                                      uint32_t shards = 1);

/// Adds the missing samples to the film. If stopped, by its control or its executor, it returns
/// soon and leaves its samples in the film; the same call continues from there, to the same bytes.
/// A film can be extended beyond its planned samples if the sampler does not depend on their number
/// (SamplerKind::sobol).
///
/// With a time limit it renders all tiles pass by pass and drops an unfinished pass, so all tiles
/// have the same number of samples. They differ only if the first pass, or one begun by an earlier
/// call, is unfinished. With `noise`, each tile keeps what it has.
RenderResult render(const Scene& scene, const Accel& accel, const RenderSettings& settings,
                    Film& film, WorkControl& control, const RenderTask& task = {});

/// The film's picture, or for View::samples heat_color() of the samples per pixel.
Image picture_of(const Film& film, View view = View::picture);

}  // namespace raio::core
