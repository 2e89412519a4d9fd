// The parts of oneTBB that Raio uses, implemented with std::thread, for the build under the thread
// sanitizer only.
//
// The sanitizer sees only the synchronisation of code that it was compiled into. In Debian's libtbb
// it sees none, and reports every task made by another thread as a race; suppressing those would
// hide the races of Raio's own loops, which all run below TBB. With this replacement it sees how
// each loop starts and ends. The headers in tbb/ precede the system's; no source file knows of it.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace tbb {

namespace stand_in {

inline const int kThreads = std::max(4, int(std::thread::hardware_concurrency()));
/// The number of threads for work started by this one; nested loops stay on their thread.
inline thread_local int concurrency = kThreads;

/// Threads that are joined together; join() rethrows the first exception of any.
class Threads {
 public:
  ~Threads() { wait(); }

  void start(std::function<void()> work) {
    threads_.emplace_back([this, work = std::move(work)] {
      concurrency = 1;
      try {
        work();
      } catch (...) {
        const std::lock_guard lock(mutex_);
        if (!error_) error_ = std::current_exception();
      }
    });
  }
  void join() {
    wait();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  void wait() {
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace stand_in

template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body) {
  if (last <= first) return;
  const Index count = std::min(last - first, Index(stand_in::concurrency));
  if (count < 2) {
    for (; first < last; ++first) body(first);
    return;
  }
  std::atomic<Index> next = first;
  stand_in::Threads threads;
  for (Index t = 0; t < count; ++t)
    threads.start([&] {
      // Relaxed, so that taking an index orders nothing that the loop itself must order.
      for (Index i; (i = next.fetch_add(1, std::memory_order_relaxed)) < last;) body(i);
    });
  threads.join();
}

struct simple_partitioner {};
template <class Index, class Body>
void parallel_for(Index first, Index last, const Body& body, simple_partitioner) {
  parallel_for(first, last, body);
}

template <class First, class Second>
void parallel_invoke(const First& first, const Second& second) {
  parallel_for(0, 2, [&](int i) { i == 0 ? first() : second(); });
}

template <class Index>
class blocked_range {
 public:
  blocked_range(Index first, Index last, size_t /*grain*/ = 1) : first_(first), last_(last) {}
  Index begin() const { return first_; }
  Index end() const { return last_; }

 private:
  Index first_, last_;
};

template <class Index, class T, class Part, class Join>
T parallel_reduce(const blocked_range<Index>& all, const T& zero, const Part& part,
                  const Join& join) {
  const Index count = Index(stand_in::concurrency), size = all.end() - all.begin();
  std::vector<T> sums(count, zero);
  parallel_for(Index(0), count, [&](Index i) {
    sums[i] = part(
        blocked_range<Index>(all.begin() + size * i / count, all.begin() + size * (i + 1) / count),
        zero);
  });
  for (Index i = 1; i < count; ++i) sums[0] = join(sums[0], sums[i]);
  return sums[0];
}

class task_group {
 public:
  template <class Work>
  void run(Work work) {
    if (stand_in::concurrency > 1)
      threads_.start(std::move(work));
    else
      work();
  }
  void wait() { threads_.join(); }

 private:
  stand_in::Threads threads_;
};

class task_arena {
 public:
  explicit task_arena(int threads) : threads_(threads) {}
  template <class Work>
  void execute(const Work& work) {
    struct Restore {
      int before;
      ~Restore() { stand_in::concurrency = before; }
    } const restore{std::exchange(stand_in::concurrency, threads_)};
    work();
  }

 private:
  int threads_;
};

namespace this_task_arena {
inline int max_concurrency() { return stand_in::concurrency; }
}  // namespace this_task_arena

/// Without effect: the arena decides.
class global_control {
 public:
  enum parameter { max_allowed_parallelism };
  global_control(parameter, size_t value) : before_(active_.exchange(value)) {}
  ~global_control() { active_ = before_; }
  static size_t active_value(parameter) { return active_; }

 private:
  static inline std::atomic<size_t> active_ = stand_in::kThreads;
  size_t before_;
};

template <class T>
class enumerable_thread_specific {
 public:
  enumerable_thread_specific() : add_([this]() -> T& { return all_.emplace_back(); }) {}
  template <class Make>
  explicit enumerable_thread_specific(Make make)
      : add_([this, make]() -> T& { return all_.emplace_back(make()); }) {}

  T& local() {
    const std::lock_guard lock(mutex_);
    T*& mine = of_thread_[std::this_thread::get_id()];
    if (!mine) mine = &add_();
    return *mine;
  }
  auto begin() { return all_.begin(); }
  auto end() { return all_.end(); }

 private:
  std::function<T&()> add_;
  std::mutex mutex_;
  std::list<T> all_;
  std::map<std::thread::id, T*> of_thread_;
};

}  // namespace tbb
