#include "render/job_start.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <string_view>
#include <utility>

#include "io/scene_file.h"
#include "render/render.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;

Error refused(std::string_view file, std::string why) {
  return {ErrorKind::bad_input, std::string(file), std::move(why)};
}

/// Whether samples are a prefix of Sobol's sequence, which can be extended.
bool is_extensible(int samples) { return samples > 0; }

// In the picture's folder, unless the request names one.
std::string scene_of(const JobRequest& request, const Metadata& settings) {
  if (!request.scene.empty()) return request.scene;
  const fs::path name = fs::path(setting(settings, "scene")).filename();
  const std::string path = (fs::path(request.repeat).parent_path() / name).string();
  std::error_code ignored;
  for (const std::string_view suffix : scene_suffixes())
    if (std::string file = fmt::format("{}.{}", path, suffix); fs::exists(file, ignored))
      return file;
  return path + ".nff";
}

// Options without effect on the picture stay as in the request.
void take_picture_options(JobRequest& request, RenderOptions options) {
  options.threads = request.options.threads;
  options.accel.counters = request.options.accel.counters;
  request.options = options;
}

// Takes the number of samples in `settings` over if a film with the settings `before` can be
// extended to it: any number of Sobol's sequence, or less noise, since a tile that needs more
// samples than it has needed these first.
void allow_more_samples(Metadata& before, const Metadata& settings) {
  const auto had = options_from(before, false), now = options_from(settings, false);
  if (!had || !now) return;
  for (auto& [key, text] : before)
    if ((key == "samples" && is_extensible(now->samples)) ||
        (key == "noise" && now->noise > 0 && now->noise <= had->noise) ||
        (key == "max_samples" && now->max_samples >= had->max_samples))
      text = setting(settings, key);
}

// For a picture ended by a time limit: its number of samples, or 0 if it has none.
uint32_t samples_done(std::string_view text) {
  uint32_t samples = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, samples);
  return error == std::errc() && end == text_end ? samples : 0;
}

// Adds samples to a finished part; returns an error or nothing.
std::optional<std::string> add_samples(const Part& part, JobRequest& request) {
  auto options = options_from(part.header.settings);
  if (!options) return options.error().message;
  const SampleCounts has = samples_of(part);
  if (options->noise > 0)
    return "its tiles have as many samples as `noise` asks for; `resume` it with a smaller `noise`";
  if (!is_extensible(options->samples))
    return "its samples are cells of `aa` and `lens-samples`, so none can be added; pictures made "
           "with `samples` can be extended";
  if (has.fewest != has.most)
    return fmt::format(
        "it is not finished: its tiles have {} to {} samples per pixel; `resume` it first",
        has.fewest, has.most);
  if (has.samples != SampleSet({0, has.most}) || !has.alike)
    return fmt::format("some tiles have only the samples {}; `resume` it first",
                       text_of(has.samples));
  if (has.most + uint64_t(request.add_samples) > uint64_t(kMaxSamples))
    return fmt::format("at most {} samples per pixel are possible; choose a smaller `add-samples`",
                       kMaxSamples);
  options->samples = int(has.most) + request.add_samples;
  take_picture_options(request, *options);
  return std::nullopt;
}

std::expected<JobStart, Error> start_by_part(const JobRequest& request, NamedPart begun) {
  auto& [name, part] = begun;
  const PartHeader& header = part.header;
  if (header.shard != request.shard || header.shards != request.shards) {
    const std::string is = fmt::format("{}/{}", header.shard + 1, header.shards);
    return std::unexpected(refused(
        name, header.shards > 1 ? fmt::format("it is shard {} of a picture; add `shard` {}", is, is)
                                : "it is not a shard; leave out `shard`"));
  }
  if (header.samples != request.sample_range) {
    const std::string is = text_of(header.samples);
    return std::unexpected(refused(
        name, is.empty() ? "it has all samples; leave out `sample-range`"
                         : fmt::format("it has the samples {}; add `sample-range` {}", is, is)));
  }
  JobStart start{request, header.settings, 0, nullptr};
  if (request.add_samples > 0)
    if (auto why = add_samples(part, start.request))
      return std::unexpected(refused(name, std::move(*why)));
  start.film = std::move(part.film), start.film_name = std::move(name);
  return start;
}

}  // namespace

std::expected<JobStart, Error> start_by_repeat(const JobRequest& request) {
  auto settings = read_metadata(request.repeat);
  if (!settings) return std::unexpected(std::move(settings.error()));
  const auto options = options_from(*settings);
  if (!options) return std::unexpected(refused(request.repeat, options.error().message));
  JobStart start{request, std::move(*settings), 0, nullptr};
  take_picture_options(start.request, *options);
  start.request.scene = scene_of(request, start.settings);
  if (!request.reads_as_given) {
    auto read = read_options_from(start.settings);
    if (!read) return std::unexpected(refused(request.repeat, read.error().message));
    start.request.read = *std::move(read);
  }
  if (const auto done = setting(start.settings, "samples_done"); !done.empty()) {
    start.samples = samples_done(done);
    if (start.samples == 0 || start.samples > uint32_t(options->samples_per_pixel()))
      return std::unexpected(refused(
          request.repeat, fmt::format("it has only {} samples and cannot be repeated", done)));
  }
  return start;
}

std::optional<Error> request_conflict(const JobRequest& r) {
  if (r.scene.empty() && !r.loaded && r.repeat.empty())
    return bad_option("scene", "is missing; give a scene file, or a picture to `repeat`");
  if (r.checkpoint.empty() && (r.resume || r.add_samples > 0)) {
    const std::string_view field = r.resume ? "resume" : "add-samples";
    return bad_option(
        field, fmt::format("has no effect without `checkpoint`; add `checkpoint` or leave `{}` out",
                           field));
  }
  if (const bool repeats = !r.repeat.empty();
      (repeats || r.add_samples > 0) && !r.of_picture.empty())
    return bad_option(repeats ? "repeat" : "add-samples",
                      fmt::format("it takes the options from the picture's file; leave out `{}`",
                                  r.of_picture.front()));
  if (!r.repeat.empty() && r.add_samples > 0)
    return bad_option("", "`repeat` and `add-samples` make different pictures; give one of them");
  const std::string_view partial = r.shards > 1 ? "shard" : "sample-range";
  if (r.is_partial() && !r.output.empty() && !is_part_path(r.output))
    return bad_option(
        partial,
        "it renders a part of a picture; choose a name that ends in .raio, as in part1.raio");
  if (r.is_partial() && r.time_limit_s > 0)
    return bad_option("", fmt::format("parts by `{}` with `time-limit` would have different "
                                      "numbers of samples; leave one of them out",
                                      partial));
  if (!r.sample_range.empty() && r.options.noise > 0)
    return bad_option(
        "sample-range",
        "has no effect with `noise`, which determines the samples of each tile; leave "
        "one of them out, or split the picture with `shard`");
  if (!r.sample_range.empty() && r.add_samples > 0)
    return bad_option("",
                      "`sample-range` says which samples to render, and `add-samples` how many "
                      "more; leave one of them out");
  if (!r.checkpoint.empty() && r.checkpoint == r.output && !is_part_path(r.output))
    return bad_option(
        "", fmt::format("`checkpoint` and the picture cannot both be {}; rename one of them",
                        r.checkpoint));
  return std::nullopt;
}

std::expected<JobStart, Error> find_start(const JobRequest& request,
                                          std::optional<NamedPart> begun) {
  std::error_code ignored;
  const bool is_there = !request.checkpoint.empty() && fs::exists(request.checkpoint, ignored);
  if (is_there && !request.resume && request.add_samples == 0)
    return std::unexpected(refused(request.checkpoint,
                                   "it already exists; add `resume` to continue it, else remove it "
                                   "or choose another name for `checkpoint`"));
  if (begun && request.resume)
    return std::unexpected(bad_option("resume",
                                      "continues from `checkpoint`, but there is a film to "
                                      "continue; leave one of them out"));
  if (is_there || request.add_samples > 0) {
    auto part = read_part(request.checkpoint);
    if (!part) return std::unexpected(std::move(part.error()));
    begun = NamedPart{request.checkpoint, std::move(*part)};
  }
  if (begun) {
    auto start = start_by_part(request, std::move(*begun));
    if (!start || request.repeat.empty()) return start;
    auto repeated = start_by_repeat(request);
    if (repeated) {
      repeated->film = std::move(start->film), repeated->film_name = std::move(start->film_name);
      repeated->film_settings = std::move(start->settings);
    }
    return repeated;
  }
  if (!request.repeat.empty()) return start_by_repeat(request);
  return JobStart{request, {}, 0, nullptr};
}

std::expected<std::unique_ptr<Film>, Error> film_of(
    JobStart& start, const Scene& scene, const RenderSettings& used, const Metadata& settings,
    const std::function<void(const Error&)>& warning) {
  const JobRequest& request = start.request;
  const bool repeats = !request.repeat.empty();
  const std::string& file = repeats ? request.repeat : start.film_name;
  if (!start.settings.empty()) {
    Metadata before = start.settings;
    if (!repeats) allow_more_samples(before, settings);
    const std::string version(setting(before, "version"));
    if (repeats && version != RAIO_VERSION) {
      if (warning)
        warning(refused(file, fmt::format("made by Raio {}, this is {}; the picture may differ",
                                          version, RAIO_VERSION)));
      for (auto& [key, text] : before)
        if (key == "version") text = RAIO_VERSION;
    }
    if (std::string why = difference(before, settings); !why.empty())
      return std::unexpected(refused(file, std::move(why)));
  }
  if (Metadata& part = start.film_settings; !part.empty()) {
    for (auto& [key, text] : part)
      if (key == "samples") text = setting(settings, "samples");
    if (std::string why = difference(part, settings); !why.empty())
      return std::unexpected(refused(start.film_name, std::move(why)));
  }
  auto film = make_film(scene, used, request.shards);
  if (!film || !start.film) return film;
  if (start.film->bound() != (*film)->bound())
    return std::unexpected(refused(file, "its film belongs to another scene"));
  for (size_t t = 0; t < start.film->tiles(); ++t)
    if (const uint32_t has = start.film->samples(t).end(); has > uint32_t(used.samples_per_pixel()))
      return std::unexpected(refused(
          file, fmt::format("it already has {} samples per pixel; request at least as many", has)));
  return std::move(start.film);
}

}  // namespace raio::core
