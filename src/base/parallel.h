// Work on all threads: everything that Raio uses of oneTBB. With RAIO_NO_THREADS (CMake's option
// RAIO_THREADS) all of it runs on the thread that asks, in the order of the indices, with the same
// results.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#ifdef RAIO_NO_THREADS
#include <memory>
#else
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_group.h>

#include <thread>
#endif

namespace raio {

/// Whether this build has threads beside the one that main() runs on.
#ifdef RAIO_NO_THREADS
inline constexpr bool kHasThreads = false;
#else
inline constexpr bool kHasThreads = true;
#endif

/// How many threads the loops of the caller may use.
int max_concurrency();

/// Runs `work`, and all that it runs in parallel (reading, building, rendering), on so many
/// threads; 0: as many as there are. There is never more than one with RAIO_NO_THREADS.
void on_threads(int threads, const std::function<void()>& work);

/// Calls a function again and again while it lives, on a thread of its own, which the destructor
/// waits for; never without threads.
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
  for (Index i = 0; i < count; ++i) f(i);
}

template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  first(), second();
}

class TaskGroup {
 public:
  template <class Work>
  void run(const Work& work) {
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
  tbb::parallel_for(Index(0), count, f);
}

/// Calls both.
template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  tbb::parallel_invoke(first, second);
}

/// run(work) begins it, wait() waits for all that was begun, which must come before the end of
/// the group.
using TaskGroup = tbb::task_group;

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

}  // namespace raio
