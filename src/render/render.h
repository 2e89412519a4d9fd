// From a scene and its structure to a film: eye rays, shading, tiles on all cores.
#pragma once

#include <expected>
#include <memory>
#include <optional>

#include "accel/accel.h"
#include "base/parallel.h"
#include "integrate/control.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio {

/// What to do to a film.
struct RenderTask {
  uint32_t samples = 0;            // each pixel shall have so many; 0: all that the options say
  uint32_t first_sample = 0;       // of these, only from this one on
  uint32_t shard = 0, shards = 1;  // only the tiles whose number is `shard` modulo `shards`
  double seconds = 0;              // not much longer than this; 0: as long as it takes
};

struct RenderResult {
  bool finished = false;  // all of the task is done: nobody said stop, and the time sufficed
  double seconds = 0;
  double busy_s = 0;  // of all threads together, without those that wait for the last tiles
};

/// Why there cannot be a picture of these many pixels, or nothing: memory that would not suffice
/// (no_resource). For callers that want to know it before they build a structure.
std::optional<Error> picture_problem(int width, int height, ChannelSet channels = {});

/// An empty film for the part of a picture that is rendered, or picture_problem().
std::expected<std::unique_ptr<Film>, Error> make_film(const Scene& scene,
                                                      const RenderSettings& settings);

/// Adds what the film lacks. Told to stop it ends soon, and what it has done by then is in the
/// film: the same call goes on from there, to the same bytes. More samples than a film has can be
/// added where the sampler deals them without regard to their number (SamplerKind::sobol).
///
/// With a limit of time it goes over all tiles pass by pass, and what is in the film at the end is
/// whole passes: all tiles have the same number of samples, unless not even the first of them, or
/// what the film had before, could be finished.
RenderResult render(const Scene& scene, const Accel& accel, const RenderSettings& settings,
                    Film& film, RenderControl& control, const RenderTask& task = {});

/// What the film shows: its picture, or for View::samples heat_color() of the samples of each
/// pixel.
Image picture_of(const Film& film, View view = View::picture);

}  // namespace raio
