// Loops and tasks on the threads of the caller's executor: everything that Raio uses of oneTBB.
// With RAIO_NO_THREADS (CMake's option RAIO_THREADS) all of it runs on the thread that asks, in the
// order of the indices, with the same results. Loops throw Stopped where their executor was told to
// stop.
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
#endif

namespace raio::core {

/// Calls a function again and again while it lives, on a thread of its own, which the destructor
/// waits for; never without threads. For showing what others do, not for work.
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

/// Calls f(i) for 0 .. count - 1, in any order. An exception of any ends the loop and is thrown
/// again.
template <class Index, class F>
void parallel_for(Index count, const F& f) {
  tbb::parallel_for(Index(0), count, [&f, scope = WorkScope::current()](Index i) {
    const WorkScope::Bound bound(scope);
    check_stop();
    f(i);
  });
}

/// Calls both.
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

/// Calls f(i) for 0 .. count - 1, which begin in this order: a thread that is free takes the next.
/// So no thread waits long for the others where the last ones take little. Not ended by a stop: f
/// has to look.
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

/// run(work) begins it, wait() waits for all that was begun, which must come before the end of
/// the group.
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

/// local() is the calling thread's T, made by the function given to the constructor when the thread
/// first asks.
template <class T>
using PerThread = tbb::enumerable_thread_specific<T>;

#endif

/// To wake other threads takes as long as thousands of primitives: how many a chunk has.
inline constexpr size_t kLoopChunk = 4096;

constexpr size_t chunks_of(size_t count) { return (count + kLoopChunk - 1) / kLoopChunk; }

/// Calls f(c, first, end) for the chunks c of 0 .. count - 1; for a single one no thread is woken.
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
