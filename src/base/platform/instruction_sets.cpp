// The five functions of Highway's library that its headers call, defined here instead of linked.
// The library measures the speed of a timer for its benchmarks when it is loaded, which would add
// several milliseconds to every start.
#include <hwy/targets.h>

#include <cstdlib>
#if HWY_ARCH_X86_64
#include <cpuid.h>
#endif

namespace hwy {
namespace {

std::atomic<int64_t> disabled{0}, for_test{0};

#if HWY_ARCH_X86_64
// The parts of the processor's state that the system saves for each program, one bit each.
uint64_t saved_state() {
  uint32_t low = 0, high = 0;
  asm("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
  return uint64_t(high) << 32 | low;
}
#endif

// The compiled instruction sets that processor and system support; hwy/ops/set_macros-inl.h lists
// the requirements of each. Asks the processor directly, because __builtin_cpu_supports does not
// know AVX in all compilers. The bits are in Intel's "Software Developer's Manual", CPUID and
// XGETBV.
int64_t detect() {
  int64_t targets = HWY_STATIC_TARGET;
#if HWY_ARCH_X86_64
  uint32_t eax = 0, ebx = 0, ecx = 0, edx = 0;
  const auto all = [](uint64_t word, auto... bits) { return (... && (word >> bits & 1)); };
  if (!__get_cpuid(1, &eax, &ebx, &ecx, &edx)) return targets;
  // ssse3, sse4.1, sse4.2
  const bool sse4 = all(ecx, 9, 19, 20);
  // fma, osxsave, avx, f16c
  const bool avx = sse4 && all(ecx, 12, 27, 28, 29);
  const uint64_t saved = avx ? saved_state() : 0;
  if (!__get_cpuid_count(7, 0, &eax, &ebx, &ecx, &edx)) ebx = 0;
  // sse and avx registers; bmi, avx2, bmi2
  const bool avx2 = all(saved, 1, 2) && all(ebx, 3, 5, 8);
  // masks and the rest of the registers; avx512f, avx512dq, avx512bw, avx512vl
  const bool avx3 = avx2 && all(saved, 5, 6, 7) && all(ebx, 16, 17, 30, 31);
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

// Called when Highway is misused.
void Abort(const char*, int, const char*, ...) { std::abort(); }

ChosenTarget& GetChosenTarget() {
  static ChosenTarget chosen;
  return chosen;
}

}  // namespace hwy
