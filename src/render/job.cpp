#include "render/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "io/scene_file.h"
#include "render/job_start.h"
#include "render/picture.h"
#include "render/render.h"
#include "render/warnings.h"

namespace raio::core {
namespace {

// Turns Stopped into an error.
template <class F>
std::expected<void, Error> stoppable(const F& work) try {
  return work();
} catch (const Stopped&) {
  return std::unexpected(stopped_error());
}

}  // namespace

RenderJob::RenderJob(JobRequest request, JobEvents events, WorkControl* control)
    : request_(std::move(request)),
      events_(std::move(events)),
      control_(control ? *control : own_control_) {
  // Resets the counts of the previous job.
  control_.rays_done = control_.work_done = control_.work_total = 0;
}

RenderJob::~RenderJob() = default;

std::expected<void, Error> RenderJob::prepare(std::optional<NamedPart> begun) {
  const double start = seconds();
  auto prepared = stoppable([&] {
    return Executor(request_.options.threads, &control_).run([&] {
      return find_and_load(std::move(begun));
    });
  });
  prepare_s_ = seconds() - start;
  return prepared;
}

std::expected<void, Error> RenderJob::find_and_load(std::optional<NamedPart> begun) {
  if (auto why = request_conflict(request_)) return std::unexpected(std::move(*why));
  if (auto why = option_conflict(request_.options)) return std::unexpected(std::move(*why));
  const auto check_output = [this]() -> std::optional<Error> {
    if (request_.output.empty()) return std::nullopt;
    return output_problem(request_.output, channels_of(request_.options));
  };
  if (auto why = check_output()) return std::unexpected(std::move(*why));
  if (!request_.checkpoint.empty())
    if (auto writable = check_writable(request_.checkpoint); !writable) return writable;

  const bool continues = begun.has_value();
  auto start = find_start(request_, std::move(begun));
  if (!start) return std::unexpected(std::move(start.error()));
  request_ = start->request;
  samples_ = start->samples;
  if (auto why = denoiser_problem(request_.options.denoise))
    return std::unexpected(std::move(*why));
  if (auto why = check_output())
    return std::unexpected(std::move(*why));  // which the start determined
  if (auto loaded = load(); !loaded) return loaded;

  const bool from_file = continues || !request_.repeat.empty() || request_.add_samples > 0;
  if (auto why = option_conflict(request_.options, scene_.get(), from_file))
    return std::unexpected(std::move(*why));
  settings_ = resolve_options(request_.options, *scene_);
  const Crop frame = settings_.frame();
  if (auto why = picture_problem(frame.width(), frame.height(), settings_, request_.shards))
    return std::unexpected(std::move(*why));
  if (const uint32_t samples = samples_ > 0 ? samples_ : uint32_t(settings_.samples_per_pixel());
      request_.sample_range.end > samples)
    return std::unexpected(bad_option(
        "sample-range",
        fmt::format("exceeds the {} samples per pixel; expected A:B with B at most {}, found "
                    "{}",
                    samples, samples, text_of(request_.sample_range))));
  part_.header = {settings_of(*scene_, settings_, request_.read, request_.scene_hash),
                  request_.shard, request_.shards, request_.sample_range};
  auto film = film_of(*start, *scene_, settings_, part_.header.settings, events_.warning);
  if (!film) return std::unexpected(std::move(film.error()));
  part_.film = std::move(*film);
  rays_before_ = part_.film->rays().total();
  check_stop();
  return {};
}

std::expected<void, Error> RenderJob::load() {
  const double start = seconds();
  if (request_.loaded) {
    scene_ = request_.loaded;
  } else {
    request_.read.instances = true;
    auto read = read_scene(request_.scene, request_.read);
    check_stop();
    const Diagnostics& said = read ? read->notices : read.error();
    if (events_.scene_read && !said.empty()) events_.scene_read(said);
    if (!read) return std::unexpected(error_of(said.front()));
    scene_ = std::make_shared<const Scene>(std::move(read->scene));
  }
  times_.load = seconds() - start;
  return {};
}

std::expected<void, Error> RenderJob::build() {
  const double start = seconds();
  auto built = stoppable([&] {
    return Executor(settings_.threads, &control_).run([&]() -> std::expected<void, Error> {
      if (request_.built) {
        accel_ = request_.built;
      } else {
        auto accel = build_accel(*scene_, settings_.accel, settings_.one_sided);
        if (!accel) return std::unexpected(std::move(accel.error()));
        accel_ = std::move(*accel);
      }
      check_stop();
      return {};
    });
  });
  times_.build = seconds() - start;
  return built;
}

std::expected<void, Error> RenderJob::run() {
  if (!accel_)
    if (auto built = build(); !built) return built;
  return stoppable(
      [&] { return Executor(settings_.threads).run([&] { return render_and_keep(); }); });
}

// Writes the film to the part file. Reports a failure once; rendering continues.
void RenderJob::write_checkpoint() {
  auto written = write_part(request_.checkpoint, part_.header, *part_.film);
  if (!written && kept_ && events_.warning) {
    written.error().message += "; rendering continues";
    events_.warning(written.error());
  }
  kept_ = std::move(written);
}

std::expected<void, Error> RenderJob::render_and_keep() {
  const SampleSpan range = request_.sample_range;
  RenderTask task{.samples = range.empty() ? samples_ : range.end,
                  .first_sample = range.first,
                  .shard = request_.shard,
                  .shards = request_.shards};
  if (const double limit = request_.time_limit_s; limit > 0)
    task.seconds = std::max(limit - prepare_s_ - times_.build, 1e-3);
  if (!request_.checkpoint.empty()) {
    task.interval_s = request_.checkpoint_interval_s;
    task.at_interval = [this] { write_checkpoint(); };
  }
  const RenderResult done = render(*scene_, *accel_, settings_, *part_.film, control_, task);
  times_.render = done.seconds;
  const bool was_stopped = !done.finished && (control_.stop || stop_requested());
  return run_to_the_end([&] { return conclude(done.finished, was_stopped); });
}

// Stores the film and reports its state.
std::expected<void, Error> RenderJob::conclude(bool finished, bool was_stopped) {
  const bool has_checkpoint = !request_.checkpoint.empty();
  if (has_checkpoint) kept_ = write_part(request_.checkpoint, part_.header, *part_.film);
  const bool is_kept = has_checkpoint && kept_;
  if (was_stopped) {
    if (!kept_) return kept_;
    Error error = stopped_error();
    if (is_kept)
      error.message = fmt::format(
          "interrupted; the samples so far are in {}, and `resume` continues", request_.checkpoint);
    return std::unexpected(std::move(error));
  }
  const SampleCounts samples = samples_of(part_);
  if (!finished && samples.fewest == 0)
    return std::unexpected(
        Error{ErrorKind::no_resource, "",
              fmt::format("{} s were too short for one sample per pixel; {}", request_.time_limit_s,
                          is_kept ? "the samples so far are in " + request_.checkpoint
                                  : "nothing was written")});
  describe(samples, finished);
  if (!events_.warning) return {};
  if (finished && !request_.is_partial())
    if (const auto why = blank_warning(*part_.film, settings_, *accel_))
      events_.warning(Error{ErrorKind::bad_input, "", *why});
  for (const std::string& why : fault_warnings(*part_.film, settings_.crop))
    events_.warning(Error{ErrorKind::bad_input, "", why});
  return {};
}

// A time limit may allow only some of the samples. The first samples of Sobol's sequence are a
// complete picture with fewer samples; for other samplers the settings list the samples.
void RenderJob::describe(const SampleCounts& samples, bool finished) {
  const auto wanted = uint32_t(settings_.samples_per_pixel());
  if (request_.is_partial() || samples.fewest == wanted || samples.most == 0) return;
  if (finished && settings_.noise > 0) return;
  const bool are_first = samples.alike && samples.samples == SampleSet({0, samples.most});
  const bool is_prefix = are_first && settings_.samples > 0 && settings_.noise == 0;
  if (is_prefix) settings_.samples = int(samples.most);
  Metadata& kept = part_.header.settings;
  kept = settings_of(*scene_, settings_, request_.read, request_.scene_hash);
  if (is_prefix) return;
  kept.emplace_back("samples_done", are_first ? fmt::format("{}", samples.most)
                                    : samples.alike
                                        ? text_of(samples.samples)
                                        : fmt::format("{} to {}", samples.fewest, samples.most));
}

std::expected<void, Error> RenderJob::write() {
  if (request_.output.empty()) return {};
  const double start = seconds();
  auto written = Executor(settings_.threads).run([&] {
    return run_to_the_end([&] { return write_result(request_.output, part_, request_.overlay); });
  });
  times_.write = seconds() - start;
  if (!written) return std::unexpected(std::move(written.error()));
  notes_ = *std::move(written);
  return {};
}

RenderFigures RenderJob::figures() const {
  const SampleCounts samples = samples_of(part_);
  RenderFigures figures{
      scene_,
      settings_,
      accel_->info(),
      times_,
      part_.film->rays(),
      rays_before_,
      samples.fewest,
      samples.mean,
      settings_.noise > 0 ? share_with(uint32_t(settings_.max_samples), part_) : 0,
      part_.film->faults()};
  const Crop frame = settings_.frame();
  for (CountedSamples* some : {&figures.faults.nans, &figures.faults.clamped})
    if (some->count > 0) some->x += uint32_t(frame.x0), some->y += uint32_t(frame.y0);
  figures.times.total = seconds();
  return figures;
}

}  // namespace raio::core
