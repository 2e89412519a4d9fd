// Transcendental functions that have the same bits on every machine.
#include "base/exact_math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace raio::core {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kLargest = std::numeric_limits<double>::max();
constexpr double kLeast = std::numeric_limits<double>::denorm_min();

// In units of the last place of the larger one.
double ulps_apart(double a, double b) {
  const double size = std::max(std::abs(a), std::abs(b));
  return std::abs(a - b) / (size - std::nextafter(size, 0));
}

// The doubles next to values from tables of more digits.
TEST(ExactMath, ValuesAreRoundedCorrectly) {
  EXPECT_EQ(exact_sin(1), 0.84147098480789650665250232163029900);
  EXPECT_EQ(exact_cos(1), 0.54030230586813971740093660744297661);
  EXPECT_EQ(exact_tan(1), 1.55740772465490223050697480745836018);
  EXPECT_EQ(exact_acos(0.25), 1.31811607165281796574566425464604047);
  EXPECT_EQ(exact_atan(3), 1.24904577239825442582991707728109012);
  EXPECT_EQ(exact_log(3), 1.09861228866810969139524523692252570);
  EXPECT_EQ(exact_log10(3), 0.47712125471966243729502790325511531);
  EXPECT_EQ(exact_pow(2, 0.5), std::numbers::sqrt2);
  EXPECT_EQ(exact_pow(10, -0.5), 0.31622776601683793319988935444327185);
  EXPECT_EQ(exact_cbrt(2), 1.25992104989487316476721060727822835);
  EXPECT_EQ(exact_acos(-1), std::numbers::pi);
  EXPECT_EQ(exact_acos(0), std::numbers::pi / 2);
  EXPECT_EQ(exact_log(std::numbers::e), 1);
}

// Near a multiple of pi, the remainder of a double is far smaller than its last bit.
TEST(ExactMath, AnglesOfAnySizeAreReduced) {
  EXPECT_EQ(exact_sin(std::numbers::pi), 1.2246467991473531772260659322749979970e-16);
  EXPECT_EQ(exact_cos(std::numbers::pi / 2), 6.123233995736765886130329661374989985e-17);
  EXPECT_EQ(exact_sin(1e22), -0.85220084976718880177270589375303);
  EXPECT_EQ(exact_cos(1e22), 0.52321478539513894549759442588437225656);
  // The double that is nearest to a multiple of pi/2, relative to its size.
  const double nearest = std::ldexp(6381956970095103, 797);
  EXPECT_EQ(exact_cos(nearest), -0x1.14ae72e6ba22fp-61);
  EXPECT_EQ(exact_sin(nearest), 1);
  for (double x = 0.3; x < 1e300; x *= -17.3) {
    const double s = exact_sin(x), c = exact_cos(x);
    EXPECT_NEAR(s * s + c * c, 1, 4e-16) << x;
    EXPECT_LE(ulps_apart(exact_tan(x), s / c), 2) << x;
    EXPECT_EQ(exact_sin(-x), -s);
    EXPECT_EQ(exact_cos(-x), c);
  }
}

TEST(ExactMath, TheCLibraryIsNear) {
  for (double x = -20; x <= 20; x += 0.0173) {
    EXPECT_LE(ulps_apart(exact_sin(x), std::sin(x)), 1) << x;
    EXPECT_LE(ulps_apart(exact_cos(x), std::cos(x)), 1) << x;
    EXPECT_LE(ulps_apart(exact_tan(x), std::tan(x)), 1) << x;
    EXPECT_LE(ulps_apart(exact_atan(x), std::atan(x)), 1) << x;
    EXPECT_LE(ulps_apart(exact_acos(x / 20.1), std::acos(x / 20.1)), 1) << x;
    EXPECT_LE(ulps_apart(exact_cbrt(x), std::cbrt(x)), 2) << x;
    const double y = std::exp(17 * x);
    EXPECT_LE(ulps_apart(exact_log(y), std::log(y)), 1) << y;
    EXPECT_LE(ulps_apart(exact_log10(y), std::log10(y)), 2) << y;
    EXPECT_LE(ulps_apart(exact_pow(y, 0.37), std::pow(y, 0.37)), 1) << y;
    EXPECT_LE(ulps_apart(exact_hypot(x, y), std::hypot(x, y)), 2) << x << " " << y;
  }
}

TEST(ExactMath, RepresentableResultsAreExact) {
  for (int n = -300; n <= 300; ++n) {
    const double power = exact_pow(10, n);
    EXPECT_EQ(power, std::stod("1e" + std::to_string(n)));
    EXPECT_EQ(exact_log10(power), n);
    EXPECT_EQ(exact_pow(2, n), std::ldexp(1, n));
    EXPECT_EQ(exact_cbrt(double(n) * n * n), n);
    EXPECT_EQ(exact_hypot(3 * n, 4 * n, -12 * n), 13 * std::abs(n));
  }
  EXPECT_EQ(exact_pow(1.5, 4), 5.0625);
  EXPECT_EQ(exact_pow(0.25, -1.5), 8);
  EXPECT_EQ(exact_log(1), 0);
  EXPECT_EQ(exact_cos(0), 1);
  EXPECT_EQ(exact_acos(1), 0);
}

TEST(ExactMath, SpecialValuesFollowTheStandard) {
  for (const double x : {0.0, kLeast, 1e-300, 1e-20}) {
    for (const auto f : {exact_sin, exact_tan, exact_atan}) {
      EXPECT_EQ(f(x), x);
      EXPECT_EQ(f(-x), -x);
      EXPECT_TRUE(std::signbit(f(-x)));
    }
    EXPECT_EQ(exact_cos(x), 1);
  }
  for (const auto f : {exact_sin, exact_cos, exact_tan, exact_acos})
    for (const double x : {kInfinite, -kInfinite, kNotANumber}) EXPECT_TRUE(std::isnan(f(x)));
  EXPECT_TRUE(std::isnan(exact_acos(1 + 1e-15)));
  EXPECT_EQ(exact_atan(kInfinite), std::numbers::pi / 2);
  EXPECT_EQ(exact_atan(-kLargest), -std::numbers::pi / 2);
  EXPECT_TRUE(std::isnan(exact_atan(kNotANumber)));
  for (const auto f : {exact_log, exact_log10}) {
    EXPECT_EQ(f(0), -kInfinite);
    EXPECT_EQ(f(kInfinite), kInfinite);
    EXPECT_TRUE(std::isnan(f(-1)));
    EXPECT_TRUE(std::isnan(f(kNotANumber)));
  }
  EXPECT_EQ(exact_log(kLeast), -744.44007192138126231410729844608163411);
  EXPECT_EQ(exact_pow(0, 2), 0);
  EXPECT_EQ(exact_pow(0, -2), kInfinite);
  EXPECT_EQ(exact_pow(kNotANumber, 0), 1);
  EXPECT_EQ(exact_pow(kInfinite, -1), 0);
  EXPECT_EQ(exact_pow(10, 400), kInfinite);
  EXPECT_EQ(exact_pow(10, -400), 0);
  EXPECT_EQ(exact_pow(0.5, kLargest), 0);
  EXPECT_EQ(exact_pow(10, -kInfinite), 0);
  EXPECT_TRUE(std::isnan(exact_pow(-2, 3)));
  EXPECT_TRUE(std::isnan(exact_pow(2, kNotANumber)));
  EXPECT_EQ(exact_cbrt(-kInfinite), -kInfinite);
  EXPECT_TRUE(std::signbit(exact_cbrt(-0.0)));
  EXPECT_TRUE(std::isnan(exact_cbrt(kNotANumber)));
  EXPECT_EQ(exact_cbrt(std::ldexp(27, -1071)), std::ldexp(3, -357));
  EXPECT_EQ(exact_hypot(0, -0.0), 0);
  EXPECT_EQ(exact_hypot(3e300, -4e300), 5e300);
  EXPECT_EQ(exact_hypot(3 * kLeast, 4 * kLeast), 5 * kLeast);
  EXPECT_EQ(exact_hypot(kNotANumber, -kInfinite), kInfinite);
  EXPECT_TRUE(std::isnan(exact_hypot(kNotANumber, 1)));
}

}  // namespace
}  // namespace raio::core
