// The public interface (include/raio/raio.h): plain values in and out, failures as exceptions,
// nothing else. Scenes are in scene.cpp, structures in accel.cpp.
#include "library/library.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/clock.h"
#include "base/parallel.h"
#include "io/image/image.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "render/render.h"

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

namespace raio::v1 {

using namespace core;           // NOLINT(google-build-using-namespace)
using namespace core::library;  // NOLINT(google-build-using-namespace)

namespace {

const OptionSpec& spec_of(std::string_view name) {
  for (const OptionSpec& spec : render_option_table())
    if (spec.name == name) return spec;
  refuse(fmt::format("unknown setting '{}'", name));
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
  guarded([&] {
    const OptionSpec& spec = spec_of(name);
    if (spec.is_switch() && value != "true" && value != "false")
      refuse(fmt::format("{}: expected true or false, found '{}'", name, value));
    if (const auto done = set_option(data_->options, spec, value); !done) fail(done.error());
  });
  return *this;
}

std::string Settings::get(std::string_view name) const {
  return spec_of(name).text(data_->options);
}

std::vector<Settings::Option> Settings::options() {
  std::vector<Option> all;
  const auto strings = [](const auto& views) {
    return std::vector<std::string>(views.begin(), views.end());
  };
  for (const OptionSpec& spec : render_option_table()) {
    Option& option = all.emplace_back();
    option.name = spec.name, option.value_name = spec.value_name;
    option.help = with_settings(option_help(spec), {});
    option.words = strings(spec.words);
    option.type = kOptionTypes[size_t(spec.type())], option.unit = spec.unit;
    option.default_value = default_value(spec);
    if (spec.least < spec.most) option.minimum = spec.least, option.maximum = spec.most;
    option.integrators = strings(names_of(spec.integrators));
    option.excludes = strings(excluded_by(spec));
  }
  return all;
}

struct Film::Data {
  Picture picture;
  Metadata settings;
  uint64_t nan_samples;
  int threads;  // of the job

  std::vector<std::string> channels() const;
  // The error names the available channels.
  const Layer& layer(std::string_view name) const;
};

Film::Film(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;
Film::~Film() = default;

int Film::width() const { return data_->picture.color.width; }
int Film::height() const { return data_->picture.color.height; }

std::vector<float> Film::rgba() const {
  return guarded([&] {
    const Picture& p = data_->picture;
    std::vector<float> out;
    out.reserve(4 * p.color.pixels.size());
    for (size_t i = 0; i < p.color.pixels.size(); ++i) {
      const Rgb& c = p.color.pixels[i];
      out.insert(out.end(), {c.x, c.y, c.z, p.alpha.empty() ? 1.0f : p.alpha[i]});
    }
    return out;
  });
}

std::vector<std::string> Film::Data::channels() const {
  std::vector<std::string> names;
  if (!picture.alpha.empty()) names.emplace_back("alpha");
  for (const Layer& layer : picture.layers) names.push_back(layer.name);
  return names;
}

std::vector<std::string> Film::channels() const { return data_->channels(); }

const Layer& Film::Data::layer(std::string_view name) const {
  const auto found = std::ranges::find(picture.layers, name, &Layer::name);
  if (found != picture.layers.end()) return *found;
  const std::vector<std::string> all = channels();
  refuse(fmt::format("the film has no channel '{}'; it has {}", name,
                     all.empty() ? "none" : fmt::format("{}", fmt::join(all, ", "))));
}

std::vector<float> Film::channel(std::string_view name, int* components) const {
  return guarded([&] {
    const core::Column<float>& alpha = data_->picture.alpha;
    const bool is_alpha = name == "alpha" && !alpha.empty();
    const Layer* const layer = is_alpha ? nullptr : &data_->layer(name);
    const auto* const values = is_alpha ? &alpha : std::get_if<core::Column<float>>(&layer->values);
    if (!values) refuse(fmt::format("channel '{}' has integers; read it with integers()", name));
    if (components) *components = layer ? int(layer->components.size()) : 1;
    return std::vector<float>(values->begin(), values->end());
  });
}

std::vector<uint32_t> Film::integers(std::string_view name) const {
  return guarded([&] {
    const bool is_alpha = name == "alpha" && !data_->picture.alpha.empty();
    const auto* const values =
        is_alpha ? nullptr : std::get_if<core::Column<uint32_t>>(&data_->layer(name).values);
    if (!values) refuse(fmt::format("channel '{}' has floats; read it with channel()", name));
    return std::vector<uint32_t>(values->begin(), values->end());
  });
}

uint64_t Film::nan_samples() const { return data_->nan_samples; }

void Film::write(const std::string& path) const {
  guarded_work(data_->threads, [&] {
    if (const auto done = write_picture(data_->picture, path, data_->settings); !done)
      fail(done.error());
  });
}

struct Job::Data {
  std::shared_ptr<const core::Scene> scene;
  std::shared_ptr<const core::Accel> accel;  // null: run() builds it
  RenderSettings settings;
  WorkControl control;
  std::function<void(const Progress&)> on_progress;
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

// Settings for a picture of the scene. Data files get the background of the style, unless another
// was set.
RenderSettings settings_of(RenderOptions options, const core::Scene& scene, bool has_background) {
  if (const auto why = option_conflict(options, &scene)) fail(*why);
  if (has_background && scene.dialect == Dialect::data && !options.background)
    options.background = WrittenColor{.color = scene.background};
  return resolve_options(options, scene);
}

}  // namespace

Job::Job(const Scene& scene, const Settings& settings) {
  guarded_work(settings.data().options.threads, [&] {
    data_ = std::make_unique<Data>();
    data_->scene = std::make_shared<const core::Scene>(scene.data().scene);
    if (const auto problems = validate(*data_->scene); !problems.empty()) refuse(problems.front());
    data_->settings =
        settings_of(settings.data().options, *data_->scene, scene.data().has_background);
  });
}

Job::Job(const Accel& accel, const Settings& settings) {
  guarded_work(settings.data().options.threads, [&] {
    const std::shared_ptr<const Accel::Data>& built = accel.data_;
    data_ = std::make_unique<Data>();
    data_->scene = {built, &built->scene};
    data_->accel = {built, built->accel.get()};
    data_->settings = settings_of(options_with(*built, settings.data().options), *data_->scene,
                                  built->has_background);
    if (data_->settings.accel.counters && !built->options.accel.counters)
      refuse("these settings need a structure that was built with counters");
  });
}

Job::~Job() = default;

void Job::on_progress(std::function<void(const Progress&)> callback) {
  data_->on_progress = std::move(callback);
}

namespace {

// Tells of work until it is finished. What the callback throws stops the work.
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
    switch (control.stage) {
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

// Does the work while the callback is told of it.
template <class F>
auto reported(WorkControl& control, const std::function<void(const Progress&)>& tell,
              const F& work) {
  ProgressReporter reporter(control, tell);
  try {
    if constexpr (std::is_void_v<std::invoke_result_t<const F&>>) {
      work();
      reporter.finish();
    } else {
      auto result = work();
      reporter.finish();
      return result;
    }
  } catch (...) {
    reporter.finish();  // what the callback threw is why the work ended
    throw;
  }
}

}  // namespace

Film Job::run() {
  const auto work = [&] {
    const core::Scene& scene = *data_->scene;
    const RenderSettings& settings = data_->settings;
    const auto film = make_film(scene, settings);
    if (!film) fail(film.error());
    std::shared_ptr<const core::Accel> accel = data_->accel;
    if (!accel) {
      auto built = build_accel(scene, settings.accel, settings.one_sided);
      if (!built) fail(built.error());
      accel = std::move(*built);
    }
    if (!render(scene, *accel, settings, **film, data_->control).finished)
      throw Error(ErrorKind::cancelled, "the render was cancelled");
    return run_to_the_end([&] {
      return Film(std::make_unique<Film::Data>(
          Film::Data{picture_of(**film, settings), settings_of(scene, settings),
                     (*film)->nans().count, settings.threads}));
    });
  };
  return reported(data_->control, data_->on_progress,
                  [&] { return guarded_work(data_->settings.threads, work, &data_->control); });
}

void Job::cancel() { data_->control.stop = true; }

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

std::string version() { return RAIO_VERSION; }

}  // namespace raio::v1
