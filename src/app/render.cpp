#include <fmt/core.h>

#include <chrono>
#include <filesystem>

#include "app/commands.h"
#include "app/long_render.h"
#include "app/output.h"
#include "app/statistics.h"
#include "app/terminal.h"
#include "io/image/image.h"
#include "render/part.h"

namespace raio::app {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string picture_path(const RenderCommand& command) {
  if (!command.output.empty()) return command.output;
  const std::string& named = command.scene.empty() ? command.repeat : command.scene;
  return (named == "-" ? "stdin" : std::filesystem::path(named).stem().string()) + ".png";
}

// What cannot be written is better known before the work than after it; the exit status.
int check_targets(const RenderCommand& command, const std::string& output) {
  const std::string& stats = command.stats;
  if (const auto format = image_format(output); !is_part_path(output) && !format)
    return fail(format.error());
  if (const auto writable = check_writable(output); !writable) return fail(writable.error());
  if (const std::string& kept = command.checkpoint; !kept.empty()) {
    if (const auto writable = check_writable(kept); !writable) return fail(writable.error());
    if (kept == stats || (kept == output && !is_part_path(output)))
      return bad_input(fmt::format("--checkpoint and {} cannot both be {}; give one another name",
                                   kept == stats ? "--stats" : "the picture", kept));
  }
  if (stats.empty()) return kDone;
  if (const auto writable = check_writable(stats); !writable) return fail(writable.error());
  if (stats == output || (is_standard_output(stats) && is_standard_output(output)))
    return bad_input("the picture and --stats cannot both go to " +
                     (is_standard_output(output) ? "standard output" : output) +
                     "; give one of them another name");
  return kDone;
}

// What is kept of a render that ended before its time; the exit status.
int put_away(const RenderCommand& command, Checkpoint& checkpoint) {
  if (command.checkpoint.empty()) return interrupted();
  if (const auto kept = checkpoint.finish(); !kept) return fail(kept.error());
  print_line(fmt::format("raio: interrupted; what was rendered is kept in {}, and --resume goes on",
                         command.checkpoint));
  return kInterrupted;
}

/// All that a render works on.
struct Job {
  Scene scene;
  RenderSettings settings;
  std::unique_ptr<Accel> accel;
  Part part;
  uint64_t rays_before = 0;
  Times times;
};

// Loads and builds; the exit status.
int prepare(RenderStart& start, const RenderControl& control, Job& job) {
  const RenderCommand& command = start.command;
  const auto load_start = Clock::now();
  auto scene = load_scene(command.scene, command.quiet);
  if (!scene) return scene.error();
  if (const std::string what = unrendered(*scene); !what.empty() && !command.quiet)
    print_line(fmt::format("{}: warning: not shown yet: {}", command.scene, what));
  job.scene = std::move(*scene);
  job.times.load = seconds_since(load_start);
  if (control.stop) return interrupted();

  if (const auto why = option_conflict(command.options, &job.scene); !why.empty())
    return bad_input(why);
  job.settings = resolve_options(command.options, job.scene);
  const RenderSettings& settings = job.settings;
  if (const auto why = picture_problem(settings.width, settings.height, settings.channels);
      !why.empty())
    return no_resource(why);
  job.part.header = {settings_of(job.scene, settings), command.shard, command.shards};
  auto film = film_of(start, job.scene, settings, job.part.header.settings);
  if (!film) return film.error();
  job.part.film = std::move(*film);
  job.rays_before = job.part.film->rays().total();

  const auto build_start = Clock::now();
  std::expected<std::unique_ptr<Accel>, std::string> accel;
  on_threads(settings.threads,
             [&] { accel = build_accel(job.scene, settings.accel, settings.one_sided); });
  if (!accel) return no_resource(accel.error());
  job.accel = std::move(*accel);
  job.times.build = seconds_since(build_start);
  return control.stop ? interrupted() : kDone;
}

// The time may have sufficed for some samples only. Of samples by Sobol's sequence the first are a
// picture of their own, and the settings say so; of others they say how many there are.
void describe(Job& job, const SampleRange& samples) {
  const auto wanted = uint32_t(job.settings.samples_per_pixel());
  if (samples.fewest == wanted || samples.most == 0) return;
  const bool even = samples.fewest == samples.most;
  if (even && job.settings.samples > 0) job.settings.samples = int(samples.fewest);
  Metadata& settings = job.part.header.settings;
  settings = settings_of(job.scene, job.settings);
  if (!even)
    settings.emplace_back("samples_done", fmt::format("{} to {}", samples.fewest, samples.most));
  else if (job.settings.samples == 0)
    settings.emplace_back("samples_done", fmt::format("{}", samples.fewest));
}

// The picture or part, the statistics, the line that says so; the exit status.
int write_results(Job& job, const RenderCommand& command, const std::string& output,
                  Clock::time_point begin) {
  const SampleRange samples = samples_of(job.part);
  describe(job, samples);
  const auto write_start = Clock::now();
  const Part& part = job.part;
  const auto written = is_part_path(output) ? write_part(output, part.header, *part.film)
                                            : write_image(picture_of(*part.film, job.settings.view),
                                                          output, part.header.settings);
  if (!written) return fail(written.error());
  job.times.write = seconds_since(write_start);
  job.times.total = seconds_since(begin);
  const Made made{job.scene,         job.settings,    job.accel->info(), job.times,
                  part.film->rays(), job.rays_before, samples.fewest};
  if (!command.stats.empty())
    if (const int status = deliver(command.stats, json_text(statistics(made)))) return status;
  if (!command.quiet) print_line(summary(output, made));
  return kDone;
}

}  // namespace

int run(const RenderCommand& given) {
  const auto begin = Clock::now();
  RenderControl control;
  StopOnSignal stop(&control);
  const std::string output = picture_path(given);
  if (const int status = check_targets(given, output)) return status;
  auto start = find_start(given);
  if (!start) return start.error();
  const RenderCommand& command = start->command;
  Job job;
  if (const int status = prepare(*start, control, job)) return status;

  RenderTask task{start->samples, command.shard, command.shards, 0};
  if (command.time_limit_s > 0)
    task.seconds = std::max(command.time_limit_s - seconds_since(begin), 1e-3);
  Checkpoint checkpoint(command, job.part.header, *job.part.film);
  if (!command.checkpoint.empty()) stop.be_patient();
  RenderResult done;
  {
    const ProgressLine progress(control, command.quiet ? "off" : command.progress);
    done = render(job.scene, *job.accel, job.settings, *job.part.film, control, task);
  }
  if (!done.finished && control.stop) return put_away(command, checkpoint);
  job.times.render = done.seconds;
  const auto kept = checkpoint.finish();
  if (!done.finished && samples_of(job.part).fewest == 0)
    return no_resource(fmt::format(
        "{} s were too short for one sample of every pixel; {}", command.time_limit_s,
        command.checkpoint.empty() || !kept ? "nothing was written"
                                            : "what there is is kept in " + command.checkpoint));
  const int status = write_results(job, command, output, begin);
  return kept ? status : fail(kept.error());
}

}  // namespace raio::app
