// The cost of each eye ray. Included once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_COSTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_COSTS_INL_H_
#undef RAIO_INTEGRATE_COSTS_INL_H_
#else
#define RAIO_INTEGRATE_COSTS_INL_H_
#endif

#include <vector>

#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// Steps and tests of the last traced rays.
class RayCosts {
 public:
  // Traces rays one by one, so that each one's cost is known.
  void trace(const Accel& accel, const RayBatch& rays, HitBatch& hits, TraceContext& context) {
    const size_t n = rays.size();
    hits.reset(n);
    steps_.resize(n), tests_.resize(n);
    if (rays.has_time() && !ray_.has_time()) ray_.add_time();
    for (size_t i = 0; i < n; ++i) {
      const uint64_t steps = context.steps, tests = context.tests;
      ray_.clear();
      ray_.push(rays[i]);
      accel.closest(ray_, hit_, context);
      hits.set(i, hit_[0]);
      steps_[i] = uint32_t(context.steps - steps);
      tests_[i] = uint32_t(context.tests - tests);
    }
  }
  // Adds them to the requested channels.
  void add(TileSums& sums, const Column<uint32_t>& pixels) const {
    const auto add = [&](Channel channel, const std::vector<uint32_t>& counts) {
      if (!sums.layout().has(channel)) return;
      for (size_t i = 0; i < counts.size(); ++i) sums.add_mean(channel, counts[i], pixels[i]);
    };
    add(Channel::steps, steps_);
    add(Channel::tests, tests_);
  }

  uint32_t steps(size_t i) const { return steps_[i]; }
  uint32_t tests(size_t i) const { return tests_[i]; }

 private:
  std::vector<uint32_t> steps_, tests_;
  RayBatch ray_;
  HitBatch hit_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
