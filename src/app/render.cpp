#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "app/commands.h"
#include "app/output.h"
#include "app/statistics.h"
#include "app/terminal.h"
#include "app/warnings.h"
#include "render/turntable.h"

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

// Which of the command's pictures it is.
struct Turn {
  int index = 0, count = 1;
};

// What the job says when it is told to stop, with what there is of other pictures.
Error ended_at(Error why, const Turn& turn) {
  if (why.kind == ErrorKind::stopped && turn.index > 0)
    why.message =
        fmt::format("interrupted; {} of {} pictures were written", turn.index, turn.count);
  return why;
}

void print_warnings(const RenderJob& job) {
  if (const std::string what = unrendered(job.scene()); !what.empty())
    print_line(fmt::format("raio: warning: not shown yet: {}", what));
  for (const std::string& line : warning_lines(job.scene(), job.settings(), &job.accel()))
    print_line("raio: warning: " + line);
}

/// The pictures of a command, one after another; what asks it to end, ends all of them.
class Pictures {
 public:
  explicit Pictures(const RenderCommand& command) : command_(command) {}

  // Of one scene; the exit status. The first failure ends them.
  int render_scene(JobRequest request) {
    if (command_.turntable == 0) return render(request, {});
    const std::filesystem::path output = request.output;
    for (int i = 0; i < command_.turntable; ++i) {
      request.output = numbered_path(output, i, command_.turntable).string();
      if (i > 0) turn(request, i);
      if (const int status = render(request, {i, command_.turntable})) return status;
    }
    return kDone;
  }

 private:
  void turn(JobRequest& request, int index) const {
    const Camera camera = camera_of(*request.loaded, command_.options);
    set_camera(request.options, turntable_camera(camera, index, command_.turntable),
               *request.loaded);
  }

  // One picture. Leaves in the request what the next one of the scene starts from.
  int render(JobRequest& request, const Turn& turn) {
    bool broken_scene = false;
    const bool is_first = !request.loaded;
    const JobEvents events = {
        .scene_read =
            [&](const Diagnostics& said) {
              broken_scene = said.front().severity == Severity::error;
              if (!command_.quiet || broken_scene) print_diagnostics(said);
            },
        .warning = [](const Error& what) { print_line("raio: warning: " + text_of(what)); }};
    RenderJob job(request, events, &control_);
    if (const int status = check_stats(command_, request.output)) return status;
    if (const auto ready = job.prepare(); !ready)
      return broken_scene ? status_of(ready.error()) : fail(ended_at(ready.error(), turn));
    request.loaded = job.loaded(), request.built = job.built();
    if (!command_.quiet && is_first) print_warnings(job);
    if (!command_.checkpoint.empty()) stop_.be_patient();
    std::expected<void, Error> done;
    {
      const std::string label =
          turn.count > 1 ? fmt::format("{}/{}", turn.index + 1, turn.count) : std::string();
      const ProgressLine progress(control_, command_.quiet ? "off" : command_.progress, label);
      done = job.run();
    }
    if (!done) return fail(ended_at(done.error(), turn));
    const int status = write_results(job, command_, request.output);
    return job.kept() ? status : fail(job.kept().error());
  }

  const RenderCommand& command_;
  RenderControl control_;
  StopOnSignal stop_{&control_};
};

}  // namespace

int run(const RenderCommand& command) {
  JobRequest request = command;  // NOLINT(cppcoreguidelines-slicing): the rest is the program's
  request.output = picture_path(command);
  return Pictures(command).render_scene(std::move(request));
}

}  // namespace raio::app
