#include "base/parallel.h"

#ifndef RAIO_NO_THREADS
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>
#endif

namespace raio::core {

#ifdef RAIO_NO_THREADS

Ticker::Ticker(double, std::function<void()>) {}

#else

Ticker::Ticker(double interval_s, std::function<void()> work)
    : thread_([interval_s, work = std::move(work)](const std::stop_token& done) {
        const std::chrono::duration<double> interval(interval_s);
        std::mutex mutex;
        std::condition_variable_any wake;
        std::unique_lock lock(mutex);
        for (;;) {
          // libstdc++ may return false although a stop was requested.
          wake.wait_for(lock, done, interval, [&] { return done.stop_requested(); });
          if (done.stop_requested()) return;
          work();
        }
      }) {}

#endif

}  // namespace raio::core
