// The functions of base/wide-inl.h, with every instruction set of this machine.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
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

// The largest error of on_circle() at `turns`, and, of its angle, by turns_of(), in radians.
std::array<double, 2> errors_of_angles(const std::vector<float>& turns) {
  const hn::CappedTag<float, 16> d;
  std::array<double, 2> most{};
  for (const float turn : turns) {
    const auto at = on_circle(d, hn::Set(d, turn));
    const double angle = 2 * std::numbers::pi * double(turn);
    most[0] = std::max({most[0], std::abs(double(hn::GetLane(at.x)) - std::cos(angle)),
                        std::abs(double(hn::GetLane(at.y)) - std::sin(angle))});
    const auto x = float(3 * std::cos(angle)), y = float(3 * std::sin(angle));
    const double found =
        2 * std::numbers::pi * double(hn::GetLane(turns_of(d, hn::Set(d, y), hn::Set(d, x))));
    const double exact = std::atan2(double(y), double(x));
    most[1] = std::max(most[1], std::abs(found - exact));
  }
  return most;
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {
namespace {

HWY_EXPORT(wrong_quotients);
HWY_EXPORT(errors_of_angles);

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

TEST(Wide, AnglesAreExactToAFewUnits) {
  std::vector<float> turns;
  for (int i = -4000; i <= 4000; ++i) turns.push_back(float(i) / 8000);
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    const auto [circle, angle] = HWY_DYNAMIC_DISPATCH(errors_of_angles)(turns);
    EXPECT_LT(circle, 3e-7) << hwy::TargetName(target);
    EXPECT_LT(angle, 5e-7) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace raio::core
#endif
