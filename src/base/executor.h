// Who does the work: how many threads, who may stop it and who watches. An Executor is bound to the
// calling thread while run() lasts, and loops (base/parallel.h) hand it on to the threads that
// help, so whatever is called within keeps to it: reading, validating, building, rendering,
// writing.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

namespace raio {

/// Whether this build has threads beside the one that main() runs on.
#ifdef RAIO_NO_THREADS
inline constexpr bool kHasThreads = false;
#else
inline constexpr bool kHasThreads = true;
#endif

/// What is being done.
enum class Stage : uint8_t { none, reading, building, rendering };

/// What work shares with whoever watches it from another thread.
struct WorkControl {
  std::atomic<bool> stop{false};  // set it to end the work soon
  std::atomic<Stage> stage{Stage::none};
  std::atomic<uint64_t> rays_done{0};
  std::atomic<uint64_t> work_done{0};  // of work_total; of the stage
  std::atomic<uint64_t> work_total{0};

  /// Of the stage, 0 to 1; 0 where nobody knows.
  double share() const;
};

/// Thrown by work that was told to stop, through all that it consists of. Whoever hands out errors
/// makes ErrorKind::stopped of it. No std::exception: many readers take those for failures of the
/// libraries that they use.
struct Stopped {};

class Executor {
 public:
  /// So many threads, the calling one among them; 0: those of the executor around, else
  /// default_threads(). There is never more than one with RAIO_NO_THREADS. `control` stops the work
  /// and sees its progress, beside the controls of executors around; it must live until run() ends.
  explicit Executor(int threads = 0, WorkControl* control = nullptr);

  /// Does the work, returns what it returns and throws what it throws.
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

/// How many threads the loops of the caller use.
int max_concurrency();

/// As many as the cores that the system, or the limit of a container, lets this process have.
int default_threads();

/// Was the caller's work told to stop?
bool stop_requested();

/// Throws Stopped if so.
void check_stop();

/// Does so at every 1024th call: for long loops of short steps.
class StopCheck {
 public:
  void operator()() {
    if (++calls_ % 1024 == 0) check_stop();
  }

 private:
  uint32_t calls_ = 0;
};

/// Tells those who watch what the caller begins, and how much it is; 0: nobody knows.
void begin_stage(Stage stage, uint64_t total);

/// Tells that so much of it was done.
void add_work(uint64_t done);

/// An executor's run(), as the threads see it that work for it.
struct WorkScope {
  WorkControl* control = nullptr;
  bool to_the_end = false;  // what is around cannot stop it
  const WorkScope* around = nullptr;

  /// That of the calling thread.
  static const WorkScope* current();

  /// Makes it that of the calling thread while this lives.
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

/// Does work that must be done whoever was told to stop, such as to put away what there is.
template <class F>
auto run_to_the_end(const F& work) {
  const WorkScope scope{.control = nullptr, .to_the_end = true, .around = WorkScope::current()};
  const WorkScope::Bound bound(&scope);
  return work();
}

}  // namespace raio
