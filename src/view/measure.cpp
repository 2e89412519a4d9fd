#include "view/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <utility>

#include "base/parallel.h"
#include "measure/timed_share.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

// For drawing: nothing is timed meanwhile.
constexpr std::chrono::milliseconds kDrawTime(40);
constexpr std::chrono::milliseconds kPollTime(2);

// The options of the state, including those of disabled effects.
RenderOptions options_of(const ViewState& state, int width, int height) {
  RenderOptions o = state.options;
  set_camera(o, state.shown_camera(width, height), *state.scene);
  o.width = width, o.height = height;
  if (o.samples == 0 && state.endless()) o.samples = kRefineSamples;
  return o;
}

// For a curve over all grids.
RenderOptions options_without_grid(const ViewState& state, int width, int height) {
  RenderOptions o = options_of(state, width, height);
  o.accel = {};
  return o;
}

}  // namespace

Effect effect_of(Command effect) {
  switch (effect) {
    case Command::soft_shadows:
      return Effect::soft_shadows;
    case Command::depth_of_field:
      return Effect::depth_of_field;
    case Command::structure:
      return Effect::structure;
    case Command::reflection:
      return Effect::reflection;
    case Command::refraction:
      return Effect::refraction;
    case Command::gloss:
      return Effect::gloss;
    case Command::translucency:
      return Effect::translucency;
    case Command::motion:
      return Effect::motion;
    default:
      return Effect::antialiasing;
  }
}

Command command_of(Effect effect) {
  for (const Command c :
       {Command::soft_shadows, Command::depth_of_field, Command::structure, Command::reflection,
        Command::refraction, Command::gloss, Command::translucency, Command::motion})
    if (effect_of(c) == effect) return c;
  return Command::antialiasing;
}

void Measuring::start(Work work, int threads, std::function<std::string()> measure) {
  work_ = work;
  done_ = false;
  control_.stop = false;
  error_.clear();
  {
    const std::lock_guard lock(mutex_);
    found_.progress = {};
  }
  news_ = true;
  thread_ = std::thread([this, threads, measure = std::move(measure)] {
    started_ = Clock::now(), given_s_ = 0;
    take_machine();
    try {
      error_ = Executor(threads).run(measure);
    } catch (const std::bad_alloc&) {
      error_ = "out of memory";
    }
    others_.hold(false);
    done_ = true;
    on_news_();
  });
}

Measuring::~Measuring() {
  cancel();
  if (thread_.joinable()) thread_.join();
}

// The last picture of the sessions is drawn before anything is timed.
void Measuring::take_machine() {
  others_.hold(true);
  while (!others_.are_idle() && !control_.stop) std::this_thread::sleep_for(kPollTime);
  std::this_thread::sleep_for(kDrawTime);
  taken_ = Clock::now();
}

// The sessions get as much time as the measurement has had; if they are at rest, only the news is
// drawn.
void Measuring::give_machine() {
  const auto given = Clock::now();
  const auto end = given + std::max<Clock::duration>(given - taken_, kDrawTime);
  others_.hold(false);
  std::this_thread::sleep_for(kDrawTime);
  while (Clock::now() < end && !others_.are_idle() && !control_.stop)
    std::this_thread::sleep_for(kPollTime);
  take_machine();
  given_s_ += std::chrono::duration<double>(taken_ - given).count();
}

// Called from the measuring thread. What is left takes longer by the others' share.
template <class Change>
void Measuring::show(Change&& change) {
  {
    const std::lock_guard lock(mutex_);
    if (control_.stop) return;
    change(found_);
    const double passed_s = seconds_since(started_);
    found_.progress.left_s *= passed_s / std::max(passed_s - given_s_, 0.1 * passed_s);
  }
  news_ = true;
  on_news_();
  give_machine();
}

std::optional<std::string> Measuring::poll() {
  if (!busy() || !done_) return std::nullopt;
  thread_.join();
  news_ = true;
  const Work work = std::exchange(work_, Work::none);
  if (!error_.empty()) return std::exchange(error_, {});
  if (work == Work::costs) {
    if (control_.stop) forget_costs();
    return "";
  }
  if (control_.stop) return tr("stopped; the results so far are kept");
  return work == Work::table ? tr("measured the table") : tr("measured the curve");
}

void Measuring::start_costs(const ViewState& state, std::shared_ptr<const BakedScene> baked,
                            int width, int height) {
  start(Work::costs, state.options.threads,
        [this, what = state.costs_of, scene = state.scene,
         options = options_of(state, width, height), baked = std::move(baked)] {
          const auto take = [this](const EffectCosts& costs) {
            show([&](Found& found) {
              found.costs = costs;
              found.progress = {.done = costs.done, .left_s = costs.left_s, .what = {}};
            });
          };
          // A view of steps has a structure that counts them, which takes longer.
          std::shared_ptr<const Accel> accel = baked->accel;
          const RenderSettings s = resolve_options(
              what == CostOf::report ? timed_options(options, *scene) : sampled_options(options),
              *scene);
          if (baked->options.counters && !s.accel.counters) {
            auto built = Executor(s.threads, &control_).run([&] {
              return build_accel(*scene, s.accel, s.one_sided);
            });
            if (control_.stop) return std::string();
            if (!built) return with_settings(built.error().message, "");
            accel = std::move(*built);
          }
          const auto costs = measure_effects(*scene, *accel, options, what, control_, take);
          return costs ? std::string() : with_settings(costs.error().message, "");
        });
}

// Steps start one after the other: the time of the last one predicts the others.
void Measuring::show_step(const BenchmarkStep& step) {
  const auto now = Clock::now();
  const double passed = std::chrono::duration<double>(now - step_start_).count();
  if (const Combination& last = step_.combination; step_.so_far)
    sample_s_[size_t(last.accel)] = passed / samples_per_pixel(last.effects);
  BenchmarkTable table = *step.so_far;
  double done_s = 0, left_s = 0;
  for (const BenchmarkRow& row : table.rows) {
    const double row_s =
        samples_per_pixel(row.combination.effects) * sample_s_[size_t(row.combination.accel)];
    (row.runs_s.empty() ? left_s : done_s) += row_s;
  }
  std::erase_if(table.rows, [](const BenchmarkRow& row) { return row.runs_s.empty(); });
  show([&](Found& found) {
    found.progress = {.done = step.number == 0 ? 0 : done_s / std::max(done_s + left_s, 1e-9),
                      .left_s = step.number == 0 ? 0 : left_s,
                      .what = step.number == 0
                                  ? fmt::format("compares {}", short_label(step.combination))
                                  : fmt::format("{} of {}: {}", step.number, step.count,
                                                short_label(step.combination))};
    if (!table.rows.empty()) found.table = std::move(table);
  });
  step_ = step;
  step_start_ = Clock::now();
}

void Measuring::start_table(const ViewState& state, int width, int height) {
  step_ = {}, sample_s_ = {};
  ViewState shown = state;
  shown.show(View::picture);
  start(Work::table, state.options.threads,
        [this, scene = state.scene, options = shown.request(width, height)] {
          auto table = measure_benchmark(*scene, BenchmarkRequest{.options = options}, control_,
                                         [this](const BenchmarkStep& step) { show_step(step); });
          if (!table) return with_settings(table.error().message, "");
          show([&](Found& found) { found.table = std::move(*table); });
          return std::string();
        });
}

void Measuring::start_curve(const ViewState& state, int width, int height) {
  curve_options_ = options_without_grid(state, width, height), curve_scene_ = state.scene;
  start(Work::curve, state.options.threads, [this, scene = state.scene, options = curve_options_] {
    const auto take = [this](const GridCurve& curve) {
      show([&](Found& found) {
        found.curve = curve;
        found.progress = {.done = curve.done, .left_s = curve.left_s, .what = {}};
      });
    };
    const auto curve = measure_grid_curve(*scene, options, control_, take);
    return curve ? std::string() : with_settings(curve.error().message, "");
  });
}

bool Measuring::is_curve_of(const ViewState& state, int width, int height) const {
  return state.scene == curve_scene_ &&
         options_without_grid(state, width, height) == curve_options_;
}

GridCurve Measuring::curve() const {
  const std::lock_guard lock(mutex_);
  return found_.curve;
}

MeasuringProgress Measuring::progress() const {
  const std::lock_guard lock(mutex_);
  return found_.progress;
}

EffectCosts Measuring::costs() const {
  const std::lock_guard lock(mutex_);
  return found_.costs;
}

std::optional<BenchmarkTable> Measuring::table() const {
  const std::lock_guard lock(mutex_);
  return found_.table;
}

void Measuring::forget_costs() {
  const std::lock_guard lock(mutex_);
  found_.costs = {};
  news_ = true;
}

void Measuring::forget() {
  cancel();
  const std::lock_guard lock(mutex_);
  found_ = {};
  news_ = true;
}

}  // namespace raio::core::view
