// Measures the costs of effects in a separate thread. The sessions and the measurement take turns:
// nothing else works while a run is timed, and the picture refines in between.
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

namespace raio::core::view {

Effect effect_of(Command effect);
Command command_of(Effect effect);

/// The progress of a measurement.
struct MeasuringProgress {
  double done = 0;    // 0 to 1
  double left_s = 0;  // at least; 0: unknown
  std::string what;   // currently timed: "3 of 24: grid AA"
};

class Measuring {
 public:
  /// The sessions, for the measuring thread.
  struct Others {
    std::function<void(bool)> hold;  // makes them pause, or go on
    std::function<bool()> are_idle;
  };
  /// `on_news` is called from the measuring thread when there is something to show, at a moment
  /// when nothing is timed.
  Measuring(Others others, std::function<void()> on_news)
      : others_(std::move(others)), on_news_(std::move(on_news)) {}
  ~Measuring();
  Measuring(const Measuring&) = delete;
  Measuring& operator=(const Measuring&) = delete;

  /// Only if not busy().
  void start_costs(const ViewState& state, std::shared_ptr<const BakedScene> baked, int width,
                   int height);
  void start_table(const ViewState& state, int width, int height);
  void start_curve(const ViewState& state, int width, int height);
  /// Asks to end soon; does not wait.
  void cancel() { control_.stop = true; }

  enum class Work { none, costs, table, curve };
  /// The current work, until poll() has reported its end.
  Work work() const { return work_; }
  bool busy() const { return work_ != Work::none; }
  /// The end of the work, once: a line to display, or empty.
  std::optional<std::string> poll();

  /// Whether the following have changed since the last call.
  bool has_news() { return news_.exchange(false); }
  MeasuringProgress progress() const;
  /// The results so far; initially without effects.
  EffectCosts costs() const;
  std::optional<BenchmarkTable> table() const;
  GridCurve curve() const;
  /// Whether the curve belongs to this picture, whatever its grid.
  bool is_curve_of(const ViewState& state, int width, int height) const;
  /// Drops everything for a new scene. Cancels, too.
  void forget();

 private:
  struct Found {
    EffectCosts costs;
    std::optional<BenchmarkTable> table;
    GridCurve curve;
    MeasuringProgress progress;
  };

  // `measure` returns the error.
  void start(Work work, int threads, std::function<std::string()> measure);
  template <class Change>
  void show(Change&& change);
  void show_step(const BenchmarkStep& step);
  void forget_costs();
  // Called from the measuring thread.
  void take_machine();
  void give_machine();

  Others others_;
  std::function<void()> on_news_;
  WorkControl control_;
  std::atomic<bool> done_ = false, news_ = false;
  Work work_ = Work::none;
  RenderOptions curve_options_;
  std::shared_ptr<const Scene> curve_scene_;
  std::string error_;  // the thread's, until done_
  // The thread's: when it took the machine, and how long it has left it to the sessions.
  Clock::time_point taken_, started_;
  double given_s_ = 0;
  // The thread's, for a table: the start of the step, what it is, and the time per sample with its
  // structure.
  Clock::time_point step_start_;
  BenchmarkStep step_;
  std::array<double, 8> sample_s_{};
  mutable std::mutex mutex_;
  Found found_;  // guarded by mutex_
  std::thread thread_;
};

}  // namespace raio::core::view
