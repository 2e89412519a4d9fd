// What effects cost, measured in a thread of its own while the window goes on.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "render/benchmark.h"
#include "render/session.h"
#include "view/state.h"

namespace raio::view {

/// Seconds of a picture with and without an effect, the others as they are. Samples are counted as
/// in the report: 9 a pixel with antialiasing, 3 with depth of field, 27 with both, else 1.
struct EffectCost {
  Command effect = Command::antialiasing;
  bool on = false;
  double with_s = 0, without_s = 0;
};

class Measuring {
 public:
  /// `on_done` is called from the measuring thread.
  explicit Measuring(std::function<void()> on_done) : on_done_(std::move(on_done)) {}
  ~Measuring();
  Measuring(const Measuring&) = delete;
  Measuring& operator=(const Measuring&) = delete;

  /// Only when not busy().
  void start_costs(const ViewState& state, std::shared_ptr<const BakedScene> baked, int width,
                   int height);
  void start_table(const ViewState& state, int width, int height);
  /// Asks to end soon; does not wait.
  void cancel() { control_.stop = true; }

  enum class Work { none, costs, table };
  /// What is being measured, until poll() has told of its end.
  Work work() const { return work_; }
  bool busy() const { return work_ != Work::none; }
  /// The end of the work, once: a line to be said, empty where there is nothing to say.
  std::optional<std::string> poll();

  /// What was measured last.
  const std::vector<EffectCost>& costs() const { return result_.costs; }
  const std::optional<BenchmarkTable>& table() const { return result_.table; }
  /// Of another scene.
  void forget() { result_ = {}; }

 private:
  struct Measured {
    std::vector<EffectCost> costs;
    std::optional<BenchmarkTable> table;
    std::string error;
  };
  void start(Work work, std::function<Measured(RenderControl&)> measure);

  std::function<void()> on_done_;
  RenderControl control_;
  std::atomic<bool> done_ = false;
  Work work_ = Work::none;
  Measured found_;  // the thread's, until done_
  Measured result_;
  std::thread thread_;
};

}  // namespace raio::view
