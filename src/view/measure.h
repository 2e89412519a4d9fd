// What effects cost, measured in a thread of its own. Sessions rest meanwhile: whoever starts a
// measurement has paused them and waited until they are idle.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "base/clock.h"
#include "measure/benchmark.h"
#include "measure/effect_costs.h"
#include "measure/grid_curve.h"
#include "render/session.h"
#include "view/state.h"

namespace raio::view {

Effect effect_of(Command effect);
Command command_of(Effect effect);

/// How far a measurement is.
struct MeasuringProgress {
  double done = 0;    // 0 to 1
  double left_s = 0;  // at least; 0: unknown
  std::string what;   // that is being timed: "3 of 24: grid AA"
};

class Measuring {
 public:
  /// `on_news` is called from the measuring thread when there is something to show; it has a moment
  /// then in which nothing is timed.
  explicit Measuring(std::function<void()> on_news) : on_news_(std::move(on_news)) {}
  ~Measuring();
  Measuring(const Measuring&) = delete;
  Measuring& operator=(const Measuring&) = delete;

  /// Only when not busy().
  void start_costs(const ViewState& state, std::shared_ptr<const BakedScene> baked, int width,
                   int height);
  void start_table(const ViewState& state, int width, int height);
  void start_curve(const ViewState& state, int width, int height);
  /// Asks to end soon; does not wait.
  void cancel() { control_.stop = true; }

  enum class Work { none, costs, table, curve };
  /// What is being measured, until poll() has told of its end.
  Work work() const { return work_; }
  bool busy() const { return work_ != Work::none; }
  /// The end of the work, once: a line to be said, empty where there is nothing to say.
  std::optional<std::string> poll();

  /// Whether what follows has changed since the last call.
  bool has_news() { return news_.exchange(false); }
  MeasuringProgress progress() const;
  /// What is known by now; without effects, and nothing, before there was anything.
  EffectCosts costs() const;
  std::optional<BenchmarkTable> table() const;
  GridCurve curve() const;
  /// Is the curve one of this picture, whatever its grid?
  bool is_curve_of(const ViewState& state, int width, int height) const;
  /// All of it is of another scene now. Cancels, too.
  void forget();

 private:
  struct Found {
    EffectCosts costs;
    std::optional<BenchmarkTable> table;
    GridCurve curve;
    MeasuringProgress progress;
  };

  // `measure` returns what went wrong.
  void start(Work work, std::function<std::string()> measure);
  template <class Change>
  void show(Change&& change);
  void show_step(const BenchmarkStep& step);
  void forget_costs();

  std::function<void()> on_news_;
  RenderControl control_;
  std::atomic<bool> done_ = false, news_ = false;
  Work work_ = Work::none;
  RenderOptions curve_options_;
  std::shared_ptr<const Scene> curve_scene_;
  std::string error_;  // the thread's, until done_
  // The thread's, of a table: when the step began, what it is, and what a sample takes with its
  // structure.
  Clock::time_point step_start_;
  BenchmarkStep step_;
  std::array<double, 8> sample_s_{};
  mutable std::mutex mutex_;
  Found found_;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace raio::view
