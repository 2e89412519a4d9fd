// The five functions of Highway's library that its headers call, defined here instead of linked:
// loading the library measures the speed of a timer (its benchmarks want it), which takes several
// milliseconds of every start.
#include <hwy/targets.h>

#include <cstdlib>

namespace hwy {
namespace {

std::atomic<int64_t> disabled{0}, for_test{0};

// What the processor and the system can do, of the sets that are compiled
// (hwy/ops/set_macros-inl.h says what each of them takes).
int64_t detect() {
  int64_t targets = HWY_STATIC_TARGET;
#if HWY_ARCH_X86_64
  const auto all = [](auto... has) { return (... && (has != 0)); };
  const bool sse4 = all(__builtin_cpu_supports("ssse3"), __builtin_cpu_supports("sse4.1"),
                        __builtin_cpu_supports("sse4.2"), __builtin_cpu_supports("pclmul"),
                        __builtin_cpu_supports("aes"));
  const bool avx2 = sse4 && all(__builtin_cpu_supports("avx"), __builtin_cpu_supports("avx2"),
                                __builtin_cpu_supports("bmi"), __builtin_cpu_supports("bmi2"),
                                __builtin_cpu_supports("fma"), __builtin_cpu_supports("f16c"));
  const bool avx3 =
      avx2 && all(__builtin_cpu_supports("avx512f"), __builtin_cpu_supports("avx512vl"),
                  __builtin_cpu_supports("avx512dq"), __builtin_cpu_supports("avx512bw"));
  if (sse4) targets |= HWY_SSE4;
  if (avx2) targets |= HWY_AVX2;
  if (avx3) targets |= HWY_AVX3;
#endif
  return targets;
}

}  // namespace

int64_t SupportedTargets() {
  static const int64_t detected = detect();
  const int64_t mock = for_test;
  const int64_t targets = (mock ? mock : detected) & ~disabled;
  return targets ? targets : HWY_STATIC_TARGET;
}

void DisableTargets(int64_t targets) {
  disabled = targets;
  GetChosenTarget().DeInit();
}

void SetSupportedTargetsForTest(int64_t targets) {
  for_test = targets;
  GetChosenTarget().DeInit();
}

// Called where Highway is used against its rules.
void Abort(const char*, int, const char*, ...) { std::abort(); }

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
