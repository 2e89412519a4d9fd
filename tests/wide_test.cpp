// The functions of base/wide-inl.h, with every instruction set of this machine.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "../tests/wide_test.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "base/wide-inl.h"
#include "sanitized.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// How many of x / n are not as division has them, for whole vectors of x.
size_t wrong_quotients(const std::vector<float>& x, uint32_t n) {
  const hn::CappedTag<float, 16> d;
  const size_t lanes = hn::MaxLanes(d);
  size_t wrong = 0;
  for (size_t i = 0; i + lanes <= x.size(); i += lanes) {
    const auto v = hn::LoadU(d, &x[i]);
    wrong += lanes - hn::CountTrue(d, hn::Eq(divide(d, v, n), hn::Div(v, hn::Set(d, float(n)))));
  }
  return wrong;
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {
namespace {

HWY_EXPORT(wrong_quotients);

// How a quotient is rounded does not depend on the exponent of x.
TEST(Wide, QuotientsMatchDivisionForEveryMantissa) {
  constexpr uint32_t kStep = tests::if_sanitized(1009, 1);
  std::vector<float> x(16);  // with zeroes
  for (uint32_t mantissa = 0; mantissa < 1u << 23; mantissa += kStep)
    x.push_back(1 + float(mantissa) * 0x1p-23f);
  std::vector<uint32_t> numbers = {3, 5, 7, 9, 12, 25, 49, 1000, 65535, 65536, 65537, 1u << 24};
  std::mt19937 rng(8);
  for (int i = 0; i < 12; ++i) numbers.push_back(1 + rng() % 65536);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    for (const uint32_t n : numbers)
      EXPECT_EQ(HWY_DYNAMIC_DISPATCH(wrong_quotients)(x, n), 0u)
          << hwy::TargetName(target) << ", divided by " << n;
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace raio::core
#endif
