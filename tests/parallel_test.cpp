// Work on all threads, or on one where the build has no others.
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace raio::core {
namespace {

TEST(Parallel, LoopsVisitEachIndexOnce) {
  for (const size_t count : {size_t(0), size_t(1), kLoopChunk, kLoopChunk + 1, 5 * kLoopChunk}) {
    std::vector<int> seen(count), in_chunks(count), indices(count);
    parallel_for(count, [&](size_t i) { ++seen[i]; });
    for_each_index(count, [&](size_t i) { ++indices[i]; });
    for_chunks(count, [&](size_t c, size_t first, size_t end) {
      EXPECT_EQ(first, c * kLoopChunk);
      EXPECT_LT(first, end);
      for (size_t i = first; i < end; ++i) ++in_chunks[i];
    });
    const std::vector<int> once(count, 1);
    EXPECT_EQ(seen, once);
    EXPECT_EQ(indices, once);
    EXPECT_EQ(in_chunks, once);
  }
  parallel_for(-3, [](int) { FAIL() << "a loop over nothing"; });
}

TEST(Parallel, ExceptionsReachTheCaller) {
  const auto fail = [] { throw std::runtime_error("as expected"); };
  EXPECT_THROW(parallel_for(size_t(100), [&](size_t i) { i == 50 ? fail() : void(); }),
               std::runtime_error);
  EXPECT_THROW(parallel_invoke([] {}, fail), std::runtime_error);
  EXPECT_THROW(Executor(2).run(fail), std::runtime_error);
}

TEST(Parallel, GroupsEndWhenAllTheirTasksHave) {
  // Sums 1 .. 64 by halves, each a task.
  const auto sum = [](const auto& self, int first, int end) -> int {
    if (end - first == 1) return first;
    int halves[2] = {};
    const int middle = (first + end) / 2;
    TaskGroup tasks;
    tasks.run([&] { halves[0] = self(self, first, middle); });
    tasks.run([&] { halves[1] = self(self, middle, end); });
    tasks.wait();
    return halves[0] + halves[1];
  };
  EXPECT_EQ(sum(sum, 1, 65), 64 * 65 / 2);
}

TEST(Parallel, EachThreadHasItsOwn) {
  // Immovable objects, counted when constructed.
  static std::atomic<int> made;
  struct Counted {
    explicit Counted(int start) : value(start) { ++made; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    std::atomic<int> value;
  };
  made = 0;
  std::atomic<int> most = 0, total = 0;
  Executor(3).run([&] {
    PerThread<std::unique_ptr<Counted>> counters([] { return std::make_unique<Counted>(7); });
    parallel_for(size_t(1000), [&](size_t) {
      const int now = ++counters.local()->value - 7;
      for (int before = most; before < now && !most.compare_exchange_weak(before, now);) {
      }
      ++total;
    });
  });
  EXPECT_EQ(total, 1000);
  EXPECT_GE(made, 1);
  EXPECT_LE(made, 3);
  EXPECT_GE(most * made, 1000);  // each counted what its thread did, and no other thread did
  PerThread<std::vector<int>> lists;
  lists.local().push_back(1);
  EXPECT_EQ(lists.local().size(), 1u);
}

TEST(Ticker, CallsWhileItLives) {
  std::atomic<int> ticks = 0;
  {
    Ticker ticker(0.001, [&] { ++ticks; });
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (kHasThreads && ticks < 3 && std::chrono::steady_clock::now() < patience) {
    }
    [[maybe_unused]] const Ticker moved = std::move(ticker);
  }
  const int before = ticks;
  EXPECT_EQ(before >= 3, kHasThreads);
  EXPECT_EQ(before == 0, !kHasThreads);
  const auto later = std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
  while (std::chrono::steady_clock::now() < later) {
  }
  EXPECT_EQ(ticks, before);
  // A ticker with a long interval ends at once.
  const auto start = std::chrono::steady_clock::now();
  {
    const Ticker slow(1000, [&] { ++ticks; });
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  EXPECT_EQ(ticks, before);
}

TEST(Parallel, WorkHasTheRequestedNumberOfThreads) {
  EXPECT_GE(max_concurrency(), 1);
  for (const int threads : {1, 3}) {
    int found = 0;
    Executor(threads).run([&] { found = max_concurrency(); });
    EXPECT_EQ(found, kHasThreads ? threads : 1);
  }
}

}  // namespace
}  // namespace raio::core
