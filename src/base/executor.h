// Threads, cancellation and progress of work. An Executor is bound to the calling thread during
// run(). Loops (base/parallel.h) pass it on to their worker threads, so all calls within run() use
// it: reading, validating, building, rendering, writing.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

namespace raio::core {

/// Whether this build is multithreaded.
#ifdef RAIO_NO_THREADS
inline constexpr bool kHasThreads = false;
#else
inline constexpr bool kHasThreads = true;
#endif

/// The current stage of work.
enum class Stage : uint8_t { none, reading, building, rendering };

/// Shared by work and its observers in other threads.
struct WorkControl {
  std::atomic<bool> stop{false};  // set it to end the work soon
  std::atomic<Stage> stage{Stage::none};
  std::atomic<uint64_t> rays_done{0};
  std::atomic<uint64_t> work_done{0};  // of work_total, in this stage
  std::atomic<uint64_t> work_total{0};

  /// The finished share of the stage, 0 to 1; 0 if unknown.
  double share() const;
};

/// Thrown by cancelled work. Functions that return errors convert it to ErrorKind::stopped. It is
/// not a std::exception, because many readers catch those as failures of their libraries.
struct Stopped {};

class Executor {
 public:
  /// `threads` includes the calling thread. 0: the number of the enclosing executor, else
  /// default_threads(). With RAIO_NO_THREADS it is always 1. `control` can stop the work and
  /// receives its progress, as do the controls of enclosing executors; it must outlive run().
  explicit Executor(int threads = 0, WorkControl* control = nullptr);

  /// Calls `work`, and returns its result or throws its exception.
  template <class F>
  auto run(const F& work) const {
    using Result = std::invoke_result_t<const F&>;
    if constexpr (std::is_void_v<Result>) {
      enter(work);
    } else {
      std::optional<Result> result;
      enter([&] { result.emplace(work()); });
      return std::move(*result);
    }
  }

 private:
  void enter(const std::function<void()>& work) const;

  int threads_;
  WorkControl* control_;
};

/// The number of threads that loops of the caller use.
int max_concurrency();

/// The number of cores that this process may use, within its container's limit.
int default_threads();

/// Whether the caller's work was cancelled.
bool stop_requested();

/// Throws Stopped if the work was cancelled.
void check_stop();

/// Calls check_stop() every 1024th time: for long loops of short steps.
class StopCheck {
 public:
  void operator()() {
    if (++calls_ % 1024 == 0) check_stop();
  }

 private:
  uint32_t calls_ = 0;
};

/// Reports to observers that a stage begins, and the total of its work; 0: unknown.
void begin_stage(Stage stage, uint64_t total);

/// Reports finished work of the stage.
void add_work(uint64_t done);

/// A run() of an executor, as seen by its worker threads.
struct WorkScope {
  WorkControl* control = nullptr;
  bool to_the_end = false;  // enclosing scopes cannot stop it
  const WorkScope* around = nullptr;

  /// The calling thread's scope, or null.
  static const WorkScope* current();

  /// Sets the calling thread's scope during its lifetime.
  class Bound {
   public:
    explicit Bound(const WorkScope* scope);
    ~Bound();
    Bound(const Bound&) = delete;
    Bound& operator=(const Bound&) = delete;

   private:
    const WorkScope* before_;
  };
};

/// Does work that cancellation must not interrupt, such as writing a checkpoint.
template <class F>
auto run_to_the_end(const F& work) {
  const WorkScope scope{.control = nullptr, .to_the_end = true, .around = WorkScope::current()};
  const WorkScope::Bound bound(&scope);
  return work();
}

}  // namespace raio::core
