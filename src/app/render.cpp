#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "app/commands.h"
#include "app/output.h"
#include "app/statistics.h"
#include "app/terminal.h"
#include "app/warnings.h"
#include "base/executor.h"
#include "draw/annotations.h"
#include "io/scene_file.h"
#include "render/job_start.h"
#include "render/turntable.h"

namespace raio::core::app {
namespace {

namespace fs = std::filesystem;

std::string picture_name(const JobRequest& request) {
  const std::string& named = request.scene.empty() ? request.repeat : request.scene;
  return (named == "-" ? "stdin" : fs::path(named).stem().string()) + ".png";
}

// The folder for the pictures, created if missing; empty if `output` names none. With one scene, a
// name without a final slash is taken for a picture.
std::expected<fs::path, Error> folder_of(const std::string& output, bool many) {
  std::error_code error;
  const bool is_folder = output.ends_with('/') || (many && fs::is_directory(output, error));
  if (!is_folder) return fs::path();
  fs::create_directories(output, error);
  if (error) return std::unexpected(write_error(output, error.message()));
  return fs::path(output) / "";
}

// The requests of the command, one per scene.
std::expected<std::vector<JobRequest>, Error> requests_of(const RenderCommand& command) {
  const auto refused = [](std::string why) {
    return std::unexpected(Error{ErrorKind::bad_input, "", std::move(why)});
  };
  JobRequest request = command;  // NOLINT(cppcoreguidelines-slicing): the rest is the program's
  std::vector<JobRequest> requests;
  for (const std::string& scene : command.scenes) {
    request.scene = scene;
    for (const JobRequest& other : requests)
      if (picture_name(other) == picture_name(request))
        return refused(fmt::format("{} and {} would both become {}; render them one by one",
                                   other.scene, scene, picture_name(request)));
    requests.push_back(request);
  }
  if (requests.empty()) requests.push_back(request);  // the scene of a picture to repeat
  const bool many = requests.size() > 1;
  const auto folder = folder_of(command.output, many);
  if (!folder) return std::unexpected(folder.error());
  if (many && folder->empty() && !command.output.empty())
    return refused(
        fmt::format("several scenes need an output folder, as in -o "
                    "pictures/; found -o {}",
                    command.output));
  for (JobRequest& one : requests)
    if (one.output.empty() || !folder->empty()) one.output = (*folder / picture_name(one)).string();
  return requests;
}

// Detects bad targets of the statistics before the work; returns the exit status.
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

// Writes the picture or part, the statistics, and the summary line; returns the exit status.
int write_results(RenderJob& job, const RenderCommand& command, const std::string& output) {
  if (const auto written = job.write(); !written) return fail(written.error());
  if (!command.quiet)
    for (const std::string& note : job.notes()) print_line("raio: " + note);
  const RenderFigures figures = job.figures();
  if (!command.stats.empty())
    if (const int status = deliver(command.stats, json_text(statistics(figures)))) return status;
  if (!command.quiet) print_line(summary(output, figures));
  return kDone;
}

/// Renders the pictures of a command in sequence; an interruption ends them all.
class Pictures {
 public:
  Pictures(const RenderCommand& command, size_t scenes)
      : command_(command),
        of_scene_(std::max(1, command.turntable)),
        scenes_(int(scenes)),
        count_(of_scene_ * scenes_) {}

  // Renders the next scene and returns the exit status. The first failure ends them.
  int render_scene(JobRequest request) try {
    return Executor(command_.options.threads, &control_).run([&] {
      return render_pictures(std::move(request));
    });
  } catch (const Stopped&) {
    return ended(stopped_error());
  }

 private:
  int render_pictures(JobRequest request) {
    if (command_.frames) return render_frames(std::move(request));
    index_ = scene_++ * of_scene_;
    if (scenes_ > 1) about_ = request.scene + ": ";
    if (command_.any_annotation())
      if (const int status = load_to_annotate(request)) return status;
    const fs::path output = request.output;
    for (int i = 0; i < of_scene_; ++i, ++index_) {
      if (command_.turntable > 0) request.output = numbered_path(output, i, of_scene_).string();
      if (i > 0) turn(request, i);
      if (const int status = render(request)) return status;
      ++written_;
    }
    return kDone;
  }

  // Reads the scene and the annotations of its pictures; returns the exit status.
  int load_to_annotate(JobRequest& request) {
    JobRequest whole = request;
    if (!request.repeat.empty()) {
      auto start = start_by_repeat(request);
      if (!start) return fail(start.error());
      whole = std::move(start->request);
    }
    whole.read.instances = true;
    auto read = read_scene(whole.scene, whole.read);
    if (!read) return refuse(read.error());
    if (!command_.quiet) print_diagnostics(read->notices);
    return annotate(request, whole.options, std::move(*read));
  }

  // Passes the scene and the annotations to the request; returns the exit status.
  int annotate(JobRequest& request, const RenderOptions& options, ReadScene read) const {
    if (command_.color_bar && !read.colors)
      return bad_input(about_ +
                       "--color-bar has no scale, since nothing is coloured by numbers; give "
                       "--color-by with index, bfactor, occupancy or a column of numbers");
    if (command_.legend && read.legend.empty())
      return bad_input(about_ +
                       "--legend would be empty, since colours by numbers, residues and "
                       "materials have no names; leave it out");
    if ((command_.legend || command_.color_bar) && options.view != View::picture)
      return bad_input(
          fmt::format("{}--{} cannot be combined with --view {}, which has other colours; leave "
                      "one of them out",
                      about_, command_.legend ? "legend" : "color-bar", view_name(options.view)));
    request.loaded = std::make_shared<const Scene>(std::move(read.scene));
    if (!command_.any_annotation()) return kDone;
    if (option_conflict(options, request.loaded.get(), true)) return kDone;  // the job reports it
    const RenderSettings settings = resolve_options(options, *request.loaded);
    if (command_.legend && !has_room_for_legend(settings.width, settings.height, settings.dpi))
      return bad_input(about_ +
                       fmt::format("a picture of {}x{} pixels has no room for --legend; make "
                                   "it larger or --dpi smaller, or leave one of them out",
                                   settings.width, settings.height));
    request.overlay = overlay_of(command_, read, settings);
    return kDone;
  }

  // The camera relative to an origin shifted by `by`.
  static Camera moved(Camera camera, Vec3d by) {
    if (by == Vec3d()) return camera;
    camera.from = Vec3f(Vec3d(camera.from) + by), camera.at = Vec3f(Vec3d(camera.at) + by);
    return camera;
  }

  // Renders pictures of frames, all with the camera of the first.
  int render_frames(JobRequest request) {
    const FrameRange& range = *command_.frames;
    const fs::path output = request.output;
    std::optional<Camera> camera;
    Vec3d origin;  // of the camera
    request.read.frame = range.first.value_or(0);
    request.read.instances = true;
    SceneFrames frames(request.scene);
    do {
      auto read = frames.read(request.read);
      if (!read)
        return read.error().front().message == kStopped ? ended(stopped_error())
                                                        : refuse(read.error());
      if (!command_.quiet && index_ == 0) print_diagnostics(read->notices);
      if (!camera) {
        const auto count = frames_in(read->frames, request.read.frame);
        if (!count) return bad_input(request.scene + ": " + count.error());
        count_ = *count, camera = resolve_options(command_.options, read->scene).camera;
        origin = read->scene.origin;
      }
      set_camera(request.options, moved(*camera, origin - read->scene.origin), read->scene);
      if (const int status = annotate(request, request.options, std::move(*read))) return status;
      request.built = nullptr;
      request.output = numbered_path(output, index_, count_).string();
      if (const int status = render(request)) return status;
      request.read.frame += range.step;
      ++written_;
    } while (++index_ < count_);
    return kDone;
  }

  // The number of frames in the range, or an error. Sets `first` to the number of the first one.
  std::expected<int, std::string> frames_in(size_t of_file, int& first) const {
    const FrameRange& range = *command_.frames;
    const auto all = int64_t(of_file);
    if (all == 0) return std::unexpected("`frame` has no effect on this file; leave it out");
    const int64_t from = first < 0 ? all + first : first;
    int64_t to = range.last.value_or(int(std::min<int64_t>(all, INT_MAX)));
    to = std::min(to < 0 ? all + to : to, all);
    if (to <= from)
      return std::unexpected(fmt::format("this range contains no frame; the file has {}", of_file));
    const int64_t count = (to - from + range.step - 1) / range.step;
    if (count > kMaxPictures)
      return std::unexpected(
          fmt::format("{} pictures are too many; expected at most {}", count, kMaxPictures));
    first = int(from);
    return int(count);
  }

  void turn(JobRequest& request, int index) const {
    const Camera camera = resolve_options(command_.options, *request.loaded).camera;
    set_camera(request.options, turntable_camera(camera, index, of_scene_), *request.loaded);
  }

  // Renders one picture. Leaves data for the scene's next picture in the request.
  int render(JobRequest& request) {
    bool broken_scene = false;
    const bool is_first = command_.frames ? index_ == 0 : !request.built;
    const JobEvents events = {.scene_read =
                                  [&](const Diagnostics& said) {
                                    broken_scene = said.front().severity == Severity::error;
                                    if (!command_.quiet || broken_scene) print_diagnostics(said);
                                  },
                              .warning = [&](const Error& what) { warn(text_of(what)); }};
    RenderJob job(request, events, &control_);
    if (const int status = check_stats(command_, request.output)) return status;
    const auto watched = [&](const auto& work) {
      const std::string label =
          count_ > 1 ? fmt::format("{}/{}", index_ + 1, count_) : std::string();
      const ProgressLine progress(control_, command_.quiet ? "off" : command_.progress, label);
      return work();
    };
    const auto prepare = [&] {
      auto prepared = job.prepare();
      return prepared ? job.build() : prepared;
    };
    if (const auto ready = watched(prepare); !ready)
      return broken_scene ? status_of(ready.error()) : ended(ready.error());
    request.loaded = job.loaded(), request.built = job.built();
    if (!command_.quiet && is_first) print_warnings(job);
    if (!command_.checkpoint.empty()) stop_.be_patient();
    const auto done = watched([&] { return job.run(); });
    if (!done) return ended(done.error());
    const int status = write_results(job, command_, request.output);
    return job.kept() ? status : fail(job.kept().error());
  }

  void warn(const std::string& what) const { print_line("raio: warning: " + about_ + what); }

  void print_warnings(const RenderJob& job) const {
    if (command_.repeat.empty())  // its camera is in the picture
      for (const std::string& line : camera_warnings(command_.options, job.scene())) warn(line);
    for (const std::string& line : warning_lines(job.scene(), job.settings(), &job.accel(), true))
      warn(line);
  }

  // Says why, and how many pictures were written; returns the exit status.
  int ended(const Error& why) const {
    if (why.kind == ErrorKind::stopped) {
      if (written_ == 0) return fail(why);
      print_line(
          fmt::format("raio: interrupted; {} of {} pictures were written", written_, count_));
      return kInterrupted;
    }
    print_error(about_ + text_of(why));
    return status_of(why);
  }

  const RenderCommand& command_;
  int of_scene_, scenes_, count_;  // pictures of a scene, scenes, total pictures
  int scene_ = 0, index_ = 0, written_ = 0;
  std::string about_;  // prefix of messages if there are several scenes
  WorkControl control_;
  StopOnSignal stop_{&control_};
};

// Why the pictures cannot be annotated, or nothing. Checked before the work.
std::string annotation_problem(const RenderCommand& command, const std::vector<JobRequest>& all) {
  if (const auto can = check_drawing(); !can) return can.error();
  if (command.color_bar && command.frames && !command.read.color_range)
    return "frames need a common scale for --color-bar; give "
           "--color-range LO,HI";
  const std::string_view option = command.color_bar ? "--color-bar"
                                  : command.legend  ? "--legend"
                                                    : "--scale-bar";
  for (const JobRequest& request : all) {
    if (is_part_path(request.output))
      return fmt::format(
          "{} is drawn on pictures, not on part files; give it when the whole part "
          "becomes a picture (docs/cluster.md)",
          option);
  }
  return {};
}

}  // namespace

int run(const RenderCommand& command) {
  auto requests = requests_of(command);
  if (!requests) return fail(requests.error());
  if (command.any_annotation())
    if (const std::string why = annotation_problem(command, *requests); !why.empty())
      return bad_input(why);
  Pictures pictures(command, requests->size());
  int status = kDone;
  for (JobRequest& request : *requests) {
    const int of_scene = pictures.render_scene(std::move(request));
    if (of_scene == kInterrupted) return of_scene;
    if (status == kDone) status = of_scene;
  }
  return status;
}

}  // namespace raio::core::app
