#include "base/executor.h"

#include <algorithm>
#include <utility>

#include "base/platform/processor.h"

#ifndef RAIO_NO_THREADS
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <optional>
#endif

namespace raio::core {
namespace {

thread_local const WorkScope* t_scope = nullptr;

template <class F>
void for_each_control(const F& f) {
  for (const WorkScope* s = t_scope; s; s = s->around)
    if (s->control) f(*s->control);
}

}  // namespace

double WorkControl::share() const {
  const double total = double(work_total);
  return total > 0 ? std::min(1.0, double(work_done) / total) : 0;
}

const WorkScope* WorkScope::current() { return t_scope; }

WorkScope::Bound::Bound(const WorkScope* scope) : before_(std::exchange(t_scope, scope)) {}
WorkScope::Bound::~Bound() { t_scope = before_; }

Executor::Executor(int threads, WorkControl* control) : threads_(threads), control_(control) {}

bool stop_requested() {
  for (const WorkScope* s = t_scope; s && !s->to_the_end; s = s->around)
    if (s->control && s->control->stop.load(std::memory_order_relaxed)) return true;
  return false;
}

void check_stop() {
  if (stop_requested()) throw Stopped();
}

void begin_stage(Stage stage, uint64_t total) {
  for_each_control([&](WorkControl& c) { c.stage = stage, c.work_done = 0, c.work_total = total; });
}

void add_work(uint64_t done) {
  for_each_control([&](WorkControl& c) { c.work_done += done; });
}

#ifdef RAIO_NO_THREADS

int max_concurrency() { return 1; }

int default_threads() { return 1; }

void Executor::enter(const std::function<void()>& work) const {
  const WorkScope scope{.control = control_, .to_the_end = false, .around = t_scope};
  const WorkScope::Bound bound(&scope);
  work();
}

#else

int max_concurrency() {
  return t_scope ? tbb::this_task_arena::max_concurrency() : default_threads();
}

int default_threads() {
  static const int threads = std::min(tbb::info::default_concurrency(), usable_cores());
  return threads;
}

void Executor::enter(const std::function<void()>& work) const {
  const WorkScope scope{.control = control_, .to_the_end = false, .around = t_scope};
  const auto bound_work = [&] {
    const WorkScope::Bound bound(&scope);
    work();
  };
  const int threads = threads_ > 0 ? threads_ : max_concurrency();
  if (threads == tbb::this_task_arena::max_concurrency()) return bound_work();
  // An arena limits its threads by itself. More threads than cores also need a higher limit for the
  // whole process.
  std::optional<tbb::global_control> more;
  if (threads > tbb::info::default_concurrency())
    more.emplace(tbb::global_control::max_allowed_parallelism, size_t(threads));
  tbb::task_arena(threads).execute(bound_work);
}

#endif

}  // namespace raio::core
