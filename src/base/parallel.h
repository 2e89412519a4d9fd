// Loops and tasks on the threads of the caller's executor, built on oneTBB. With RAIO_NO_THREADS
// (CMake's option RAIO_THREADS) they run on the calling thread, in order, with the same results.
// Loops throw Stopped when their executor is stopped.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>

#include "base/executor.h"

#ifdef RAIO_NO_THREADS
#include <memory>
#else
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_group.h>

#include <thread>
// On Windows oneTBB includes the header of the system, which defines these names of ours.
#undef near
#undef far
#endif

namespace raio::core {

/// Calls a function at regular intervals, on its own thread, until destroyed. The destructor joins
/// the thread. Without threads it never calls. For showing progress, not for work.
class Ticker {
 public:
  Ticker() = default;
  Ticker(double interval_s, std::function<void()> work);

#ifndef RAIO_NO_THREADS
 private:
  std::jthread thread_;
#endif
};

#ifdef RAIO_NO_THREADS

template <class Index, class F>
void parallel_for(Index count, const F& f) {
  for (Index i = 0; i < count; ++i) check_stop(), f(i);
}

template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  first(), second();
}

template <class F>
void deal(size_t count, const F& f) {
  for (size_t i = 0; i < count; ++i) f(i);
}

class TaskGroup {
 public:
  template <class Work>
  void run(const Work& work) {
    check_stop();
    work();
  }
  void wait() {}
};

template <class T>
class PerThread {
 public:
  PerThread() : make_([] { return std::make_unique<T>(); }) {}
  template <class Make>
  explicit PerThread(const Make& make)
      : make_([make] { return std::unique_ptr<T>(new T(make())); }) {}

  T& local() {
    if (!value_) value_ = make_();
    return *value_;
  }

 private:
  std::function<std::unique_ptr<T>()> make_;
  std::unique_ptr<T> value_;
};

#else

/// Calls f(i) for 0 .. count - 1, in any order. The first exception ends the loop and is rethrown.
template <class Index, class F>
void parallel_for(Index count, const F& f) {
  tbb::parallel_for(Index(0), count, [&f, scope = WorkScope::current()](Index i) {
    const WorkScope::Bound bound(scope);
    check_stop();
    f(i);
  });
}

/// Calls both functions, in parallel if possible.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  const auto bound = [scope = WorkScope::current()](const auto& work) {
    return [scope, &work] {
      const WorkScope::Bound bound(scope);
      work();
    };
  };
  tbb::parallel_invoke(bound(first), bound(second));
}

/// Calls f(i) for 0 .. count - 1, started in this order: each free thread takes the next one. If
/// the last calls are short, all threads finish at about the same time. A stop does not end the
/// loop; f must check for it.
template <class F>
void deal(size_t count, const F& f) {
  std::atomic<size_t> next = 0;
  const size_t threads = std::min(count, size_t(max_concurrency()));
  tbb::parallel_for(
      size_t(0), threads,
      [&, scope = WorkScope::current()](size_t) {
        const WorkScope::Bound bound(scope);
        for (size_t i = 0; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;) f(i);
      },
      tbb::simple_partitioner());
}

/// run(work) starts a task, wait() waits for all tasks. Call wait() before the group is destroyed.
class TaskGroup {
 public:
  template <class Work>
  void run(Work work) {
    tasks_.run([work = std::move(work), scope = WorkScope::current()] {
      const WorkScope::Bound bound(scope);
      check_stop();
      work();
    });
  }
  void wait() { tasks_.wait(); }

 private:
  tbb::task_group tasks_;
};

/// local() returns the calling thread's T. The thread's first call creates it with the
/// constructor's function.
template <class T>
using PerThread = tbb::enumerable_thread_specific<T>;

#endif

/// Elements per chunk. Waking a thread takes as long as processing thousands of primitives.
inline constexpr size_t kLoopChunk = 4096;

constexpr size_t chunks_of(size_t count) { return (count + kLoopChunk - 1) / kLoopChunk; }

/// Calls f(c, first, end) for the chunks c of 0 .. count - 1. A single chunk wakes no thread.
template <class F>
void for_chunks(size_t count, const F& f) {
  const auto one = [&](size_t c) { f(c, c * kLoopChunk, std::min(count, (c + 1) * kLoopChunk)); };
  if (const size_t chunks = chunks_of(count); chunks > 1)
    parallel_for(chunks, one);
  else if (chunks == 1)
    one(0);
}

/// Calls f(i) for 0 .. count - 1, in chunks.
template <class F>
void for_each_index(size_t count, const F& f) {
  for_chunks(count, [&](size_t, size_t first, size_t end) {
    for (size_t i = first; i < end; ++i) f(i);
  });
}

}  // namespace raio::core
