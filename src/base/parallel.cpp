#include "base/parallel.h"

#ifndef RAIO_NO_THREADS
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>
#endif

namespace raio {

#ifdef RAIO_NO_THREADS

int max_concurrency() { return 1; }

void on_threads(int /*threads*/, const std::function<void()>& work) { work(); }

Ticker::Ticker(double, std::function<void()>) {}

#else

int max_concurrency() { return tbb::this_task_arena::max_concurrency(); }

void on_threads(int threads, const std::function<void()>& work) {
  if (threads == 0) return work();
  // An arena limits threads by itself; only more threads than cores need the limit of the whole
  // process raised.
  std::optional<tbb::global_control> more;
  if (threads > tbb::info::default_concurrency())
    more.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
  tbb::task_arena(threads).execute(work);
}

Ticker::Ticker(double interval_s, std::function<void()> work)
    : thread_([interval_s, work = std::move(work)](const std::stop_token& done) {
        const std::chrono::duration<double> interval(interval_s);
        std::mutex mutex;
        std::condition_variable_any wake;
        std::unique_lock lock(mutex);
        while (!wake.wait_for(lock, done, interval, [&] { return done.stop_requested(); })) work();
      }) {}

#endif

}  // namespace raio
