#include "base/parallel.h"

#ifndef RAIO_NO_THREADS
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#endif

namespace raio {

#ifdef RAIO_NO_THREADS

int max_concurrency() { return 1; }

void on_threads(int /*threads*/, const std::function<void()>& work) { work(); }

#else

int max_concurrency() { return tbb::this_task_arena::max_concurrency(); }

void on_threads(int threads, const std::function<void()>& work) {
  if (threads == 0) return work();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(threads));
  tbb::task_arena(threads).execute(work);
}

#endif

}  // namespace raio
