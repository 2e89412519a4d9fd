#include <fmt/format.h>

#include <filesystem>

#include "app/commands.h"
#include "app/output.h"
#include "app/statistics.h"
#include "app/terminal.h"
#include "app/warnings.h"

namespace raio::app {
namespace {

std::string picture_path(const RenderCommand& command) {
  if (!command.output.empty()) return command.output;
  const std::string& named = command.scene.empty() ? command.repeat : command.scene;
  return (named == "-" ? "stdin" : std::filesystem::path(named).stem().string()) + ".png";
}

// Where the statistics cannot go is better known before the work than after it; the exit status.
int check_stats(const RenderCommand& command, const std::string& output) {
  const std::string& stats = command.stats;
  if (stats.empty()) return kDone;
  if (const auto writable = check_writable(stats); !writable) return fail(writable.error());
  const auto both = [](std::string_view what, std::string_view file) {
    return bad_input(
        fmt::format("{} and --stats cannot both go to {}; give one of them another name", what,
                    is_standard_output(file) ? "standard output" : file));
  };
  if (stats == command.checkpoint) return both("--checkpoint", stats);
  if (stats == output || (is_standard_output(stats) && is_standard_output(output)))
    return both("the picture", output);
  return kDone;
}

// The picture or part, the statistics, the line that says so; the exit status.
int write_results(RenderJob& job, const RenderCommand& command, const std::string& output) {
  if (const auto written = job.write(); !written) return fail(written.error());
  const RenderFigures figures = job.figures();
  if (!command.stats.empty())
    if (const int status = deliver(command.stats, json_text(statistics(figures)))) return status;
  if (!command.quiet) print_line(summary(output, figures));
  return kDone;
}

}  // namespace

int run(const RenderCommand& command) {
  JobRequest request = command;  // NOLINT(cppcoreguidelines-slicing): the rest is the program's
  const std::string output = request.output = picture_path(command);
  bool broken_scene = false;
  const JobEvents events = {
      .scene_read =
          [&](const Diagnostics& said) {
            broken_scene = said.front().severity == Severity::error;
            if (!command.quiet || broken_scene) print_diagnostics(said);
          },
      .warning = [](const Error& what) { print_line("raio: warning: " + text_of(what)); }};
  RenderJob job(std::move(request), events);
  StopOnSignal stop(&job.control());
  if (const int status = check_stats(command, output)) return status;
  if (const auto ready = job.prepare(); !ready)
    return broken_scene ? status_of(ready.error()) : fail(ready.error());
  if (!command.quiet)
    if (const std::string what = unrendered(job.scene()); !what.empty())
      print_line(fmt::format("raio: warning: not shown yet: {}", what));
  if (!command.quiet)
    for (const std::string& line : warning_lines(job.scene(), job.settings(), &job.accel()))
      print_line("raio: warning: " + line);
  if (!command.checkpoint.empty()) stop.be_patient();
  std::expected<void, Error> done;
  {
    const ProgressLine progress(job.control(), command.quiet ? "off" : command.progress);
    done = job.run();
  }
  if (!done) return fail(done.error());
  const int status = write_results(job, command, output);
  return job.kept() ? status : fail(job.kept().error());
}

}  // namespace raio::app
