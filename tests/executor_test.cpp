// Executors: their threads, and how reading and building end when they are stopped.
#include "base/executor.h"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "accel/accel.h"
#include "base/parallel.h"
#include "io/scene_file.h"
#include "render/job.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using tests::random_scene;

TEST(Executor, IsSharedByWorkerThreads) {
  WorkControl control;
  Executor(3, &control).run([&] {
    begin_stage(Stage::building, 1000);
    parallel_for(size_t(100), [](size_t) { add_work(1); });
    for_each_index(100 * kLoopChunk, [](size_t i) {
      if (i % kLoopChunk == 0) add_work(1);
    });
    parallel_invoke([] { add_work(10); }, [] { add_work(20); });
    TaskGroup tasks;
    for (int i = 0; i < 7; ++i) tasks.run([] { add_work(10); });
    tasks.wait();
    deal(50, [](size_t) { add_work(2); });
  });
  EXPECT_EQ(control.stage, Stage::building);
  EXPECT_EQ(control.work_done, 400u);
  EXPECT_EQ(control.share(), 0.4);
  add_work(1);  // of nobody
  EXPECT_EQ(control.work_done, 400u);
}

TEST(Executor, StopsNestedLoopsAndTasks) {
  WorkControl outer, inner;
  const std::function<void()> works[] = {[] { parallel_for(size_t(10), [](size_t) {}); },
                                         [] { for_each_index(3 * kLoopChunk, [](size_t) {}); },
                                         [] {
                                           TaskGroup tasks;
                                           tasks.run([] {});
                                           tasks.wait();
                                         },
                                         [] {
                                           StopCheck look;
                                           for (int i = 0; i < 1024; ++i) look();
                                         }};
  for (const auto& work : works) {
    outer.stop = inner.stop = false;
    const auto run = [&] { Executor(2, &outer).run([&] { Executor(0, &inner).run(work); }); };
    EXPECT_NO_THROW(run());
    inner.stop = true;
    EXPECT_THROW(run(), Stopped);
    inner.stop = false, outer.stop = true;
    EXPECT_THROW(run(), Stopped);
    EXPECT_NO_THROW(Executor(2, &inner).run(work));
    Executor(2, &outer).run([&] {
      EXPECT_TRUE(stop_requested());
      EXPECT_NO_THROW(run_to_the_end(work));
      EXPECT_THROW(work(), Stopped);
    });
  }
  EXPECT_FALSE(stop_requested());
}

TEST(Executor, ReturnsTheResultOfTheWork) {
  EXPECT_EQ(*Executor(2).run([] { return std::make_unique<int>(7); }), 7);
  EXPECT_EQ(Executor(3).run([] { return max_concurrency(); }), 3);
  // One within another has as many threads unless it says otherwise.
  EXPECT_EQ(Executor(3).run([] { return Executor().run([] { return max_concurrency(); }); }), 3);
  EXPECT_EQ(Executor().run([] { return max_concurrency(); }), default_threads());
}

TEST(Executor, DealsInOrderEvenWhenStopped) {
  WorkControl control;
  control.stop = true;
  std::vector<size_t> order;
  Executor(1, &control).run([&] { deal(100, [&](size_t i) { order.push_back(i); }); });
  std::vector<size_t> all(100);
  for (size_t i = 0; i < all.size(); ++i) all[i] = i;
  EXPECT_EQ(order, all);
  // Many threads take each once.
  std::vector<std::atomic<int>> taken(1000);
  Executor(4).run([&] { deal(taken.size(), [&](size_t i) { ++taken[i]; }); });
  for (const auto& times : taken) ASSERT_EQ(times, 1);
}

// Repeats work and stops it at random points of its progress; counts how often the stop came in
// time. The caller checks the results of work().
template <class Work>
int stopped_at_random(const Work& work) {
  std::mt19937 random(7);
  int stopped = 0;
  for (int round = 0; round < 24; ++round) {
    WorkControl control;
    std::atomic<bool> done = false;
    const double share = std::uniform_real_distribution(0.0, 0.9)(random);
    std::thread watcher([&] {
      while (!done && control.stage != Stage::building) std::this_thread::yield();
      while (!done && control.share() < share) std::this_thread::yield();
      control.stop = true;
    });
    stopped += Executor(2, &control).run(work);
    done = true;
    watcher.join();
  }
  return stopped;
}

Scene large_scene(AccelKind kind) {
  Scene scene = random_scene(kind == AccelKind::grid ? 4000 : 20000, 5);
  const Object object = scene;
  scene.prototypes.push_back(object);
  scene.instances.push_back({.prototype = 0, .matrix = {1, 0, 0, 9, 0, 1, 0, 0, 0, 0, 1, 0}});
  return scene;
}

TEST(StoppedBuild, EndsWithAnErrorAtAnyTime) {
  for (const AccelKind kind : {AccelKind::bvh, AccelKind::grid}) {
    const Scene scene = large_scene(kind);
    const AccelInfo whole = (*build_accel(scene, {.kind = kind}))->info();
    const int stopped = stopped_at_random([&] {
      const auto accel = build_accel(scene, {.kind = kind});
      if (accel) {
        EXPECT_EQ((*accel)->info().bytes, whole.bytes);
        EXPECT_EQ((*accel)->info().references, whole.references);
        return 0;
      }
      EXPECT_EQ(accel.error().kind, ErrorKind::stopped);
      return 1;
    });
    EXPECT_GT(stopped, 0);
  }
}

TEST(StoppedBuild, ReportsProgress) {
  for (const AccelKind kind : {AccelKind::bvh, AccelKind::grid}) {
    WorkControl control;
    const Scene scene = large_scene(kind);
    ASSERT_TRUE(Executor(2, &control).run([&] { return build_accel(scene, {.kind = kind}); }));
    EXPECT_EQ(control.stage, Stage::building);
    EXPECT_GT(control.share(), 0.8);
  }
}

// Embree does not say how far it is, but asks whether to go on.
TEST(StoppedBuild, EmbreeEndsWithAnError) {
  const Scene scene = random_scene(20000, 5);
  const auto embree = [&] { return build_accel(scene, {.kind = AccelKind::embree}); };
  if (!embree()) GTEST_SKIP() << "this build or machine has no Embree";
  int stopped = 0;
  for (int round = 0; round < 12; ++round) {
    WorkControl control;
    const std::jthread watcher([&] {
      while (control.stage != Stage::building) std::this_thread::yield();
      std::this_thread::sleep_for(std::chrono::milliseconds(2 * round));
      control.stop = true;
    });
    const auto accel = Executor(2, &control).run(embree);
    if (accel) continue;
    EXPECT_EQ(accel.error().kind, ErrorKind::stopped);
    ++stopped;
  }
  EXPECT_GT(stopped, 0);
}

constexpr std::string_view kView =
    "v\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 24 16\nl 3 -4 5\n";

// Before the rows of another table.
constexpr std::string_view kCrystal =
    "data_x\n_cell_length_a 9\n_cell_length_b 9\n_cell_length_c 9\n_cell_angle_alpha 90\n"
    "_cell_angle_beta 90\n_cell_angle_gamma 90\nloop_\n_atom_site_label\n_atom_site_fract_x\n"
    "_atom_site_fract_y\n_atom_site_fract_z\nC1 0.1 0.2 0.3\nloop_\n_other_value\n";

class StoppedReading : public TemporaryFolder {
 protected:
  std::string text_file(std::string_view name, std::string_view start, std::string_view line,
                        int count) {
    std::ofstream out(file(name));
    out << start;
    for (int i = 0; i < count; ++i) out << line;
    return file(name).string();
  }
};

TEST_F(StoppedReading, HasItsOwnErrorKind) {
  std::string numbered = "OFF\n3 20000 0\n0 0 0\n1 0 0\n0 1 0\n";
  for (const std::string& path :
       {text_file("a.nff", kView, "s 0 0 0 1\n", 20000),
        text_file("b.xyz", "20000\n\n", "C 1 2 3\n", 20000),
        text_file("c.off", numbered, "3 0 1 2\n", 20000),
        text_file("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "f 1 2 3\n", 20000),
        text_file("e.cif", kCrystal, "1\n", 20000)}) {
    ASSERT_TRUE(read_scene(path)) << path;
    WorkControl control;
    control.stop = true;
    const auto read = Executor(2, &control).run([&] { return read_scene(path); });
    ASSERT_FALSE(read) << path;
    EXPECT_EQ(read.error().front().message, kStopped);
    EXPECT_EQ(error_of(read.error().front()).kind, ErrorKind::stopped);
    const std::string text = get(path);
    const auto parsed = Executor(2, &control).run([&] { return parse_scene(text, path); });
    EXPECT_FALSE(parsed) << path;  // looked at within the reader itself
  }
}

TEST_F(StoppedReading, EndsAJobWithoutDiagnostics) {
  JobRequest request;
  request.scene = text_file("a.nff", kView, "s 0 0 0 1\n", 20000);
  bool told = false;
  RenderJob job(request, {.scene_read = [&](const Diagnostics&) { told = true; }});
  job.control().stop = true;
  const auto ready = job.prepare();
  ASSERT_FALSE(ready);
  EXPECT_EQ(ready.error().kind, ErrorKind::stopped);
  EXPECT_FALSE(told);
}

// A rendering thread writes the checkpoint, so warnings come from that thread.
TEST_F(StoppedReading, RenderingThreadsWriteCheckpoints) {
  JobRequest request;
  request.scene = text_file("a.nff", kView, "s 0 0 0 1\n", 10);
  request.options.width = request.options.height = 40, request.options.samples = 100;
  request.options.threads = 1;
  request.checkpoint = file("kept/c.raio").string();
  std::filesystem::create_directory(file("kept"));
  request.checkpoint_interval_s = 1e-9;
  std::vector<std::thread::id> who;
  RenderJob job(request,
                {.warning = [&](const Error&) { who.push_back(std::this_thread::get_id()); }});
  ASSERT_TRUE(job.prepare());
  std::filesystem::remove_all(file("kept"));
  ASSERT_TRUE(job.run());
  EXPECT_FALSE(job.kept());
  EXPECT_THAT(who, testing::Each(std::this_thread::get_id()));
  EXPECT_FALSE(who.empty());
}

}  // namespace
}  // namespace raio::core
