// Where a RenderJob starts: what a picture to be repeated or a part file brings, and whether it
// fits.
#pragma once

#include <expected>
#include <functional>
#include <memory>
#include <optional>

#include "render/job.h"

namespace raio {

/// Why the fields of the request do not go together (bad_option), or nothing. The options' own
/// conflicts are option_conflict()'s.
std::optional<Error> request_conflict(const JobRequest& request);

struct JobStart {
  JobRequest request;           // with the options and the scene that a picture or a part brought
  Metadata settings;            // of that picture or part; empty: none
  uint32_t samples = 0;         // of a pixel, when not all that the options say
  std::unique_ptr<Film> film;   // of a part
  Metadata film_settings = {};  // of that part, where `settings` are a picture's
};
std::expected<JobStart, Error> find_start(const JobRequest& request);

/// The start of a request with `repeat`, by the settings of that picture.
std::expected<JobStart, Error> start_by_repeat(const JobRequest& request);

/// The film to work on: the one that `start` brought, if it is of this picture, or an empty one.
/// `settings` are settings_of() the scene and what is `used`.
std::expected<std::unique_ptr<Film>, Error> film_of(
    JobStart& start, const Scene& scene, const RenderSettings& used, const Metadata& settings,
    const std::function<void(const Error&)>& warning);

}  // namespace raio
