// The public interface (include/raio/raio.h): plain values in and out, failures as exceptions,
// nothing else. Scenes are in scene.cpp, structures in accel.cpp, films in film.cpp.
#include "library/library.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <span>
#include <utility>

#include "base/clock.h"
#include "base/parallel.h"
#include "base/srgb.h"
#include "draw/marks.h"
#include "integrate/color_text.h"
#include "io/colormaps.h"
#include "render/job_options.h"
#include "render/picture_options.h"
#include "render/read_options.h"

namespace raio::core::library {
namespace {

v1::ErrorKind kind_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_input:
    case ErrorKind::bad_option:
    case ErrorKind::cannot_read:
      return v1::ErrorKind::bad_input;
    case ErrorKind::cannot_write:
      return v1::ErrorKind::cannot_write;
    case ErrorKind::no_resource:
      return v1::ErrorKind::no_resource;
    case ErrorKind::stopped:
      break;
  }
  return v1::ErrorKind::cancelled;
}

}  // namespace

void refuse(const std::string& message) { throw v1::Error(v1::ErrorKind::bad_input, message); }

void fail(const Error& error) {
  if (error.kind == ErrorKind::stopped)
    throw v1::Error(v1::ErrorKind::cancelled, "the work was cancelled");
  throw v1::Error(kind_of(error.kind), error.text(), {}, error.place.line, error.place.column);
}

std::optional<std::array<v1::Triple, 2>> bounds_of(const Scene& scene) {
  const Box3f box = bounds(scene);
  if (box.empty()) return std::nullopt;
  return std::array{triple(scene.origin + Vec3d(box.lo)), triple(scene.origin + Vec3d(box.hi))};
}

}  // namespace raio::core::library

namespace raio::inline v1 {

using namespace core;           // NOLINT(google-build-using-namespace)
using namespace core::library;  // NOLINT(google-build-using-namespace)

namespace {

const OptionSpec& spec_of(std::string_view name) {
  for (const OptionSpec& spec : render_option_table())
    if (spec.name == name) return spec;
  refuse(fmt::format("unknown setting '{}'", name));
}

// Calls use(entry) for the option of that name, of the picture, the job or the reader.
template <class F>
auto with_entry(std::string_view name, const F& use) {
  for (const JobOptionSpec& spec : job_option_table())
    if (spec.name == name) return use(spec);
  for (const ReadOptionSpec& spec : read_option_table())
    if (spec.name == name) return use(spec);
  return use(spec_of(name));
}

}  // namespace

Error::Error(ErrorKind kind, const std::string& message, std::string file, int line, int column)
    : std::runtime_error(message),
      kind_(kind),
      file_(std::move(file)),
      line_(line),
      column_(column) {}

Settings::Settings() : data_(std::make_unique<Data>()) {}
Settings::Settings(const Settings& other) : data_(std::make_unique<Data>(*other.data_)) {}
Settings& Settings::operator=(const Settings& other) {
  data_ = std::make_unique<Data>(*other.data_);
  return *this;
}
Settings::~Settings() = default;

Settings& Settings::set(std::string_view name, std::string_view value) {
  struct Set {
    JobRequest& request;
    std::string_view value;

    auto operator()(const OptionSpec& spec) const { return spec.set(request.options, value); }
    auto operator()(const JobOptionSpec& spec) const { return spec.set(request, value); }
    auto operator()(const ReadOptionSpec& spec) const { return spec.set(request.read, value); }
  };
  guarded([&] {
    const bool is_word = value == "true" || value == "false";
    if (with_entry(name, [](const auto& entry) { return entry.is_switch(); }) && !is_word)
      refuse(fmt::format("{}: expected true or false, found '{}'", name, value));
    if (const auto done = with_entry(name, Set{*data_, value}); !done)
      refuse(fmt::format("{}: {}", name, with_settings(done.error(), {})));
  });
  return *this;
}

Settings& Settings::set_numbers(std::string_view name, const double* values, size_t count) {
  const auto text = guarded([&] {
    const auto form = with_entry(name, [](const auto& entry) { return entry.value_name; });
    return fmt::format("{}", fmt::join(std::span(values, count),
                                       form.find('x') == std::string_view::npos ? "," : "x"));
  });
  return set(name, text);
}

std::string Settings::get(std::string_view name) const {
  struct Get {
    const JobRequest& request;

    std::string operator()(const OptionSpec& spec) const { return spec.text(request.options); }
    std::string operator()(const JobOptionSpec& spec) const { return spec.text(request); }
    std::string operator()(const ReadOptionSpec& spec) const { return spec.text(request.read); }
  };
  return with_entry(name, Get{*data_});
}

namespace {

template <class Options>
Settings::Option described(const OptionEntry<Options>& entry) {
  const auto strings = [](const auto& views) {
    return std::vector<std::string>(views.begin(), views.end());
  };
  Settings::Option option;
  option.name = entry.name, option.value_name = entry.value_name;
  option.help = with_settings(option_help(entry), {});
  option.words = strings(entry.words);
  option.type = kOptionTypes[size_t(entry.type())], option.unit = entry.unit;
  option.default_value = default_value(entry);
  if (entry.least < entry.most) option.minimum = entry.least, option.maximum = entry.most;
  option.integrators = strings(names_of(entry.integrators));
  return option;
}

}  // namespace

std::vector<Settings::Option> Settings::options() {
  std::vector<Option> all;
  for (const ReadOptionSpec& spec : read_option_table()) {
    all.push_back(described(spec));
    all.back().of_reader = true;
  }
  for (const OptionSpec& spec : render_option_table()) {
    const auto excluded = excluded_by(spec);
    all.push_back(described(spec));
    all.back().excludes.assign(excluded.begin(), excluded.end());
  }
  for (const JobOptionSpec& spec : job_option_table()) all.push_back(described(spec));
  return all;
}

struct Job::Data {
  Data(JobRequest request, std::optional<Film> begun) : job(std::move(request)) {
    std::optional<NamedPart> part;
    if (begun) {
      Film::Data& film = *begun->data_;
      part = NamedPart{film.name.empty() ? "the film" : film.name, std::move(film.part)};
    }
    if (const auto done = job.prepare(std::move(part)); !done) fail(done.error());
    header = job.part().header;
  }

  RenderJob job;
  PartHeader header;  // as run() finds it
  std::function<void(const Progress&)> on_progress = {};
  std::mutex mutex = {};  // guards the following, and the job's film
  bool is_done = false;   // run() has taken the film

  Film::Data film(Part part) const {
    const RenderSettings& settings = job.settings();
    return {.part = std::move(part),
            .shards = header.shards,
            .threads = settings.threads,
            .pixels_per_unit = core::pixels_per_unit(settings)};
  }
};

namespace {

// Options of a picture with the given structure.
RenderOptions options_with(const Accel::Data& built, RenderOptions options) {
  for (const auto name : {"accel", "grid-factor", "grid-resolution", "one-sided", "opacity"}) {
    const OptionSpec& spec = spec_of(name);
    const std::string asked = spec.text(options), is = spec.text(built.options);
    if (asked != is && spec.is_given(options))
      refuse(
          fmt::format("{} is {}, but the structure was built with{}; leave it out, or build "
                      "another structure",
                      name, asked, is.empty() ? "out it" : " " + is));
  }
  const bool counters = options.accel.counters;
  options.accel = built.options.accel;
  options.accel.counters |= counters;
  options.one_sided = built.options.one_sided;
  options.opacity = built.options.opacity;
  return options;
}

// The picture's settings tell how its scene was read.
void take_read(ReadOptions& read, const ReadOptions& of_scene) {
  for (const ReadOptionSpec& spec : read_option_table())
    if (const std::string asked = spec.text(read);
        asked != spec.text(kForPictures) && asked != spec.text(of_scene))
      refuse(fmt::format("{} is for reading a file; give it where the scene is read", spec.name));
  read = of_scene;
}

// A background that lights the scene has an effect only if the scene was read with it.
void take_environment(JobRequest& request, const ReadOptions& of_scene) {
  ReadOptions& read = request.read;
  if (!read.sky && read.environment.empty())
    read.sky = of_scene.sky, read.environment = of_scene.environment;
  if (auto why = read_background(request.options, read)) fail(*why);
}

// Data files get the background of the style, unless another was set.
void take_background(RenderOptions& options, const core::Scene& scene, bool has_background) {
  const bool shows_light =
      options.view == View::picture && options.integrator != IntegratorKind::views;
  if (has_background && shows_light && scene.dialect == Dialect::data && !options.background)
    options.background = WrittenColor{.color = scene.background};
}

}  // namespace

Job::Job(const Scene& scene, const Settings& settings, std::optional<Film> begun) {
  guarded_work(settings.data().options.threads, [&] {
    JobRequest request = settings.data();
    request.loaded = std::make_shared<const core::Scene>(scene.data().scene);
    if (const auto problems = validate(*request.loaded); !problems.empty())
      refuse(problems.front());
    take_environment(request, scene.data().read);
    take_read(request.read, scene.data().read);
    take_background(request.options, *request.loaded, scene.data().has_background);
    data_ = std::make_unique<Data>(std::move(request), std::move(begun));
  });
}

Job::Job(const Accel& accel, const Settings& settings, std::optional<Film> begun) {
  guarded_work(settings.data().options.threads, [&] {
    const std::shared_ptr<const Accel::Data>& built = accel.data_;
    JobRequest request = settings.data();
    request.options = options_with(*built, std::move(request.options));
    request.loaded = {built, &built->scene};
    request.built = {built, built->accel.get()};
    request.scene_hash = built->hash();
    take_environment(request, built->read);
    take_read(request.read, built->read);
    take_background(request.options, built->scene, built->has_background);
    data_ = std::make_unique<Data>(std::move(request), std::move(begun));
    if (data_->job.settings().accel.counters && !built->options.accel.counters)
      refuse("these settings need a structure that was built with counters");
  });
}

Job::~Job() = default;

void Job::on_progress(std::function<void(const Progress&)> callback) {
  data_->on_progress = std::move(callback);
}

namespace {

// Reports the progress of work until it is finished. An exception from the callback stops the work.
class ProgressReporter {
 public:
  ProgressReporter(WorkControl& control, const std::function<void(const Progress&)>& tell) {
    if (!tell) return;
    ticker_ = Ticker(0.1, [&, start = Clock::now()] {
      if (thrown_) return;
      try {
        tell({control.share(), control.rays_done, seconds_since(start), stage_of(control)});
      } catch (...) {
        thrown_ = std::current_exception();
        control.stop = true;
      }
    });
  }
  // Rethrows the callback's exception.
  void finish() {
    ticker_ = {};
    if (thrown_) std::rethrow_exception(thrown_);
  }

 private:
  static Progress::Stage stage_of(const WorkControl& control) {
    switch (control.stage.load()) {
      case core::Stage::none:
      case core::Stage::reading:
        return Progress::Stage::reading;
      case core::Stage::building:
        return Progress::Stage::building;
      case core::Stage::rendering:
        break;
    }
    return Progress::Stage::rendering;
  }

  std::exception_ptr thrown_;
  Ticker ticker_;
};

// Does the work and reports its progress to the callback.
template <class F>
void reported(WorkControl& control, const std::function<void(const Progress&)>& tell,
              const F& work) {
  ProgressReporter reporter(control, tell);
  try {
    work();
  } catch (...) {
    reporter.finish();  // rethrows the callback's exception, if that ended the work
    throw;
  }
  reporter.finish();
}

}  // namespace

Film Job::run() {
  RenderJob& job = data_->job;
  reported(job.control(), data_->on_progress, [&] {
    guarded([&] {
      if (data_->is_done) refuse("this job has run; make another");
      if (const auto done = job.run(); !done) fail(done.error());
      if (!job.kept()) fail(job.kept().error());
    });
  });
  return guarded([&] {
    const std::lock_guard lock(data_->mutex);
    data_->is_done = true;
    return Film(std::make_unique<Film::Data>(data_->film(job.take_part())));
  });
}

Film Job::film() const {
  return guarded([&] {
    const std::lock_guard lock(data_->mutex);
    if (data_->is_done) refuse("run() has returned the film");
    return Film(std::make_unique<Film::Data>(
        data_->film({data_->header, copy_of(*data_->job.part().film)})));
  });
}

void Job::cancel() { data_->job.control().stop = true; }

struct Executor::Data {
  int threads;
  WorkControl control;
  std::function<void(const Progress&)> on_progress;
};

Executor::Executor(int threads) {
  if (threads < 0) refuse(fmt::format("expected a number of threads from 0 on, found {}", threads));
  data_ = std::make_unique<Data>(threads);
}
Executor::~Executor() = default;

void Executor::on_progress(std::function<void(const Progress&)> callback) {
  data_->on_progress = std::move(callback);
}

void Executor::run(const std::function<void()>& work) {
  reported(data_->control, data_->on_progress,
           [&] { core::Executor(data_->threads, &data_->control).run(work); });
}

void Executor::cancel() { data_->control.stop = true; }

Triple parse_color(std::string_view text) {
  return guarded([&] {
    const auto color = core::parse_color(text, {.transparent = false});
    if (!color) refuse(color.error());
    return triple(Vec3d(color->encoded ? linear_from_srgb(color->color) : color->color));
  });
}

void to_linear(float* values, size_t count) {
  guarded_work(0, [&] {
    for_each_index(count, [&](size_t i) { values[i] = linear_from_srgb(values[i]); });
  });
}

std::vector<float> colormap(std::string_view name) {
  return guarded([&] {
    std::vector<float> colors;
    for (int i = 0; i < kMapColors; ++i) {
      const auto color = map_color(name, float(i) / float(kMapColors - 1));
      if (!color)
        refuse(
            fmt::format("unknown colour map '{}', expected {}", name, fmt::join(kColormaps, ", ")));
      colors.insert(colors.end(), {color->x, color->y, color->z});
    }
    return colors;
  });
}

std::string version() { return RAIO_VERSION; }

}  // namespace raio::inline v1
