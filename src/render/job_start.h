// The start of a RenderJob: reads a picture to repeat or a part file, and checks that it fits.
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <optional>

#include "render/job.h"

namespace raio::core {

/// Why the fields of the request contradict each other (bad_option), or nothing. Conflicts of
/// options are found by option_conflict().
std::optional<Error> request_conflict(const JobRequest& request);

struct JobStart {
  JobRequest request;           // with the options and the scene of the picture or part
  Metadata settings;            // of that picture or part; empty: none
  uint32_t samples = 0;         // per pixel, if not as many as the options say
  std::unique_ptr<Film> film;   // of a part
  std::string film_name = {};   // of that part, for messages
  Metadata film_settings = {};  // of that part, if `settings` are a picture's
};
/// `begun`: a part to continue, instead of the checkpoint.
std::expected<JobStart, Error> find_start(const JobRequest& request,
                                          std::optional<NamedPart> begun);

/// The start of a request with `repeat`, by that picture's settings.
std::expected<JobStart, Error> start_by_repeat(const JobRequest& request);

/// The film to work on: that of `start`, if it belongs to this picture, or an empty one. `settings`
/// are settings_of() the scene and `used`.
std::expected<std::unique_ptr<Film>, Error> film_of(
    JobStart& start, const Scene& scene, const RenderSettings& used, const Metadata& settings,
    const std::function<void(const Error&)>& warning);

}  // namespace raio::core
