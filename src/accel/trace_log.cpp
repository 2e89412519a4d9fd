#include "accel/trace_log.h"

#include <algorithm>

#include "accel/intersect.h"

namespace raio::core {

uint64_t TraceLog::count_steps() const {
  return uint64_t(std::ranges::count_if(steps, [](const Step& s) { return !s.leaf; }));
}

uint64_t TraceLog::count_tests() const {
  return unlisted + uint64_t(std::ranges::count_if(tests, [](auto& t) { return !t.repeated; }));
}

void judge_tests(TraceLog& log, const Geometry& geometry, const Ray& ray) {
  RayQuery nearest(ray);
  for (TraceLog::Test& test : log.tests) {
    RayQuery alone(ray);
    if (test.repeated || !test_primitive(geometry, test.primitive, alone)) continue;
    test.t = alone.best.t;
    test.nearest = nearest.offer(alone.best.t, test.primitive);
  }
}

}  // namespace raio::core
