#include "base/exact_math.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>

namespace raio::core {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = 0x1p-28;  // below it sin x, tan x and atan x round to x, cos x to 1

// The sum of two doubles: `lo` is at most half an ulp of `hi`, so the sum has about 106 bits.
// Arithmetic of Dekker 1971, "A floating-point technique for extending the available precision",
// Numerische Mathematik 18.
struct Twin {
  double hi = 0, lo = 0;

  constexpr Twin() = default;
  constexpr Twin(double high, double low = 0) : hi(high), lo(low) {}
  constexpr Twin operator-() const { return {-hi, -lo}; }
  constexpr double rounded() const { return hi + lo; }
};

// a + b, where a is the larger one or 0.
constexpr Twin ordered_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

constexpr Twin exact_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

// The halves have 26 bits each, so that their products are exact.
constexpr Twin exact_product(double a, double b) {
  const double a_shifted = 0x8000001p0 * a, b_shifted = 0x8000001p0 * b;
  const double a_high = a_shifted - (a_shifted - a), b_high = b_shifted - (b_shifted - b);
  const double a_low = a - a_high, b_low = b - b_high, product = a * b;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

constexpr Twin operator+(Twin a, Twin b) {
  const Twin high = exact_sum(a.hi, b.hi), low = exact_sum(a.lo, b.lo);
  const Twin sum = ordered_sum(high.hi, high.lo + low.hi);
  return ordered_sum(sum.hi, sum.lo + low.lo);
}

constexpr Twin operator-(Twin a, Twin b) { return a + -b; }

constexpr Twin operator*(Twin a, Twin b) {
  const Twin product = exact_product(a.hi, b.hi);
  return ordered_sum(product.hi, product.lo + (a.hi * b.lo + a.lo * b.hi));
}

constexpr Twin operator/(Twin a, Twin b) {
  const double first = a.hi / b.hi;
  const double second = (a - b * first).hi / b.hi;
  return ordered_sum(first, second);
}

Twin root(Twin a) {
  const double first = std::sqrt(a.hi);
  return first > 0 ? ordered_sum(first, (a - exact_product(first, first)).hi / (2 * first)) : a;
}

constexpr Twin kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
constexpr Twin kLn2 = {std::numbers::ln2, 0x1.abc9e3b39803fp-56};
constexpr Twin kLn10 = {std::numbers::ln10, -0x1.f48ad494ea3e9p-53};

// The first coefficients of a power series.
template <size_t count>
constexpr auto series(Twin (*coefficient)(int)) {
  std::array<Twin, count> out;
  for (size_t n = 0; n < count; ++n) out[n] = coefficient(int(n));
  return out;
}

constexpr Twin alternating(int n, Twin x) { return n % 2 ? -x : x; }

constexpr Twin inverse_factorial(int n) {
  Twin out = 1;
  for (int i = 2; i <= n; ++i) out = out / i;
  return out;
}

// For the arguments used below, the omitted terms are less than 2^-80 of the value.
constexpr auto kSine =  // of x^2: sin x / x
    series<13>([](int n) { return alternating(n, inverse_factorial(2 * n + 1)); });
constexpr auto kCosine = series<13>([](int n) { return alternating(n, inverse_factorial(2 * n)); });
constexpr auto kExponential = series<12>([](int n) { return inverse_factorial(n); });
constexpr auto kAreaTangent =  // of x^2: artanh x / x
    series<17>([](int n) { return Twin(1) / (2 * n + 1); });
constexpr auto kArcTangent =  // of x^2: arctan x / x
    series<13>([](int n) { return alternating(n, Twin(1) / (2 * n + 1)); });

// From term `twins` on, the low parts are too small to matter.
template <size_t count>
Twin evaluate(const std::array<Twin, count>& series, Twin x, size_t twins) {
  double small = 0;
  for (size_t n = count; n > twins; --n) small = small * x.hi + series[n - 1].hi;
  Twin sum = small;
  for (size_t n = twins; n > 0; --n) {  // each exceeds the sum after it
    const Twin rest = sum * x, high = ordered_sum(series[n - 1].hi, rest.hi);
    sum = ordered_sum(high.hi, high.lo + (series[n - 1].lo + rest.lo));
  }
  return sum;
}

// The digits of 2 / pi after the point, in base 2^24; enough for the largest double.
constexpr std::array<uint32_t, 52> kTwoOverPi = {
    0xa2f983, 0x6e4e44, 0x1529fc, 0x2757d1, 0xf534dd, 0xc0db62, 0x95993c, 0x439041, 0xfe5163,
    0xabdebb, 0xc561b7, 0x246e3a, 0x424dd2, 0xe00649, 0x2eea09, 0xd1921c, 0xfe1deb, 0x1cb129,
    0xa73ee8, 0x8235f5, 0x2ebb44, 0x84e99c, 0x7026b4, 0x5f7e41, 0x3991d6, 0x398353, 0x39f49c,
    0x845f8b, 0xbdf928, 0x3b1ff8, 0x97ffde, 0x05980f, 0xef2f11, 0x8b5a0a, 0x6d1f6d, 0x367ecf,
    0x27cb09, 0xb74f46, 0x3f669e, 0x5fea2d, 0x7527ba, 0xc7ebe5, 0xf17b3d, 0x0739f7, 0x8a5292,
    0xea6bfb, 0x5fb11f, 0x8d5d08, 0x560330, 0x46fc7b, 0x6babf0, 0xcfbc20};

struct Angle {
  unsigned quarters;  // modulo 4
  Twin rest;          // from -pi/4 to pi/4
};

// x = quarters pi/2 + rest, for finite x >= 0. Multiplies x by 2 / pi, modulo 4, digit by digit
// (Payne and Hanek 1983, "Radian reduction for trigonometric functions", SIGNUM Newsletter 18).
Angle reduced(double x) {
  if (x < std::numbers::pi / 4) return {0, x};
  constexpr int kBits = 24, kDigits = 9;
  constexpr uint64_t kMask = (1u << kBits) - 1;
  int exponent = 0;
  const auto mantissa = uint64_t(std::ldexp(std::frexp(x, &exponent), 53));
  exponent -= 53;
  // x = 2^(24 place) times a number of four digits.
  const int place = (exponent + 4 * kBits) / kBits - 4, shift = exponent - place * kBits;
  const std::array<uint64_t, 4> digits = {
      mantissa << shift & kMask, mantissa >> (kBits - shift) & kMask,
      mantissa >> (2 * kBits - shift) & kMask, mantissa >> (2 * kBits - shift) >> kBits};
  std::array<uint64_t, kDigits + 1> product{};  // the first one before the point
  uint64_t carry = 0;
  for (int at = kDigits; at >= 0; --at) {
    for (int i = 0; i < 4; ++i)
      if (const int other = i + place + at - 1; other >= 0)
        carry += digits[size_t(i)] * kTwoOverPi[size_t(other)];
    product[size_t(at)] = carry & kMask;
    carry >>= kBits;
  }
  const bool up = product[1] >> (kBits - 1);
  Twin rest = up ? -1 : 0;
  double unit = 1;
  for (size_t at = 1; at <= kDigits; ++at)
    rest = rest + double(product[at]) * (unit *= 1.0 / (1 << kBits));
  return {unsigned(product[0] + up) % 4, rest * kHalfPi};
}

struct SineCosine {
  Twin sine, cosine;
};

SineCosine sine_cosine(double x) {
  const auto [quarters, rest] = reduced(std::abs(x));
  const Twin square = rest * rest;
  Twin sine = rest * evaluate(kSine, square, 6), cosine = evaluate(kCosine, square, 6);
  if (quarters % 2) sine = std::exchange(cosine, -sine);
  if (quarters >= 2) sine = -sine, cosine = -cosine;
  return {x < 0 ? -sine : sine, cosine};
}

// For t from -1 to 1. Halves the angle three times: the tangent of half the angle is t / (1 +
// root(1 + t^2)).
Twin arc_tangent(Twin t) {
  for (int i = 0; i < 3; ++i) t = t / (Twin(1) + root(Twin(1) + t * t));
  return Twin(8) * t * evaluate(kArcTangent, t * t, 5);
}

// The angle of the direction (x, y), with y >= 0, and not both 0.
Twin angle(Twin y, Twin x) {
  if (y.hi > std::abs(x.hi)) return kHalfPi - arc_tangent(x / y);
  return x.hi > 0 ? arc_tangent(y / x) : Twin(2) * kHalfPi + arc_tangent(y / x);
}

// For finite x > 0: splits off a power of two, which leaves a number from root(1/2) to root(2).
Twin logarithm(double x) {
  int exponent = 0;
  double part = std::frexp(x, &exponent);
  if (part < std::numbers::sqrt2 / 2) part *= 2, --exponent;
  const Twin z = exact_sum(part, -1) / exact_sum(part, 1);
  return Twin(exponent) * kLn2 + Twin(2) * z * evaluate(kAreaTangent, z * z, 6);
}

// exp(x / 16) to the 16th power.
double exponential(Twin x) {
  if (x.hi > 800) return kInfinity;
  if (x.hi < -800) return 0;
  const double whole = std::floor(x.hi / std::numbers::ln2 + 0.5);
  Twin power = evaluate(kExponential, (x - Twin(whole) * kLn2) * Twin(1.0 / 16), 5);
  for (int i = 0; i < 4; ++i) power = power * power;
  return std::ldexp(power.rounded(), int(whole));
}

}  // namespace

// The series of artanh about sqrt(1/2)..sqrt(2), where its argument is at most 0.172.
double exact_log2(double x) {
  const auto bits = std::bit_cast<uint64_t>(x);
  int exponent = int(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0x000fffffffffffff) | 0x3ff0000000000000);
  if (m > std::numbers::sqrt2) m *= 0.5, ++exponent;
  const double z = (m - 1) / (m + 1), z2 = z * z;
  double series = 0;
  for (int n = 21; n >= 1; n -= 2) series = series * z2 + 1.0 / n;
  return exponent + 2 / std::numbers::ln2 * z * series;
}

// Taylor series of the exponential, up to half a power of two on either side.
double exact_exp2(double x) {
  const double whole = std::floor(x + 0.5), f = (x - whole) * std::numbers::ln2;
  double series = 1;
  for (int n = 14; n >= 1; --n) series = series * f / n + 1;
  return series * std::bit_cast<double>(uint64_t(int64_t(whole) + 1023) << 52);
}

double exact_sin(double x) {
  if (std::abs(x) < kTiny) return x;
  return std::isfinite(x) ? sine_cosine(x).sine.rounded() : kNaN;
}

double exact_cos(double x) {
  if (std::abs(x) < kTiny) return 1;
  return std::isfinite(x) ? sine_cosine(x).cosine.rounded() : kNaN;
}

double exact_tan(double x) {
  if (std::abs(x) < kTiny) return x;
  if (!std::isfinite(x)) return kNaN;
  const auto [sine, cosine] = sine_cosine(x);
  return (sine / cosine).rounded();
}

double exact_acos(double x) {
  if (!(std::abs(x) <= 1)) return kNaN;
  return angle(root(exact_sum(1, -x) * exact_sum(1, x)), x).rounded();
}

double exact_atan(double x) {
  const double size = std::abs(x);
  if (size < kTiny || std::isnan(x)) return x;
  return std::copysign(size < 1 / kTiny / kTiny ? angle(size, 1).rounded() : kHalfPi.hi, x);
}

double exact_log(double x) {
  if (!(x > 0)) return x == 0 ? -kInfinity : kNaN;
  return x < kInfinity ? logarithm(x).rounded() : x;
}

double exact_log10(double x) {
  if (!(x > 0)) return x == 0 ? -kInfinity : kNaN;
  return x < kInfinity ? (logarithm(x) / kLn10).rounded() : x;
}

double exact_pow(double x, double y) {
  if (x == 1 || y == 0) return 1;
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  if (!(x > 0)) return x < 0 ? kNaN : y > 0 ? 0 : kInfinity;
  if (x == kInfinity) return y > 0 ? x : 0;
  const Twin log = logarithm(x);
  const double about = y * log.hi;
  return std::abs(about) < 1000 ? exponential(Twin(y) * log) : exponential(about);
}

// Newton's method. The last step uses twins, for correct rounding.
double exact_cbrt(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  int exponent = 0;
  double part = std::frexp(std::abs(x), &exponent);
  const int third = (exponent + 3000) / 3 - 1000;
  part = std::ldexp(part, exponent - 3 * third);  // from 1/2 to 4
  double root = 0.6 + 0.3 * part;
  for (int i = 0; i < 5; ++i) root -= (root - part / (root * root)) * (1.0 / 3);
  const Twin error = exact_product(root, root) * root - part;
  root -= error.hi / (3 * root * root);
  return std::copysign(std::ldexp(root, third), x);
}

double exact_hypot(double x, double y, double z) {
  const double largest = std::max({std::abs(x), std::abs(y), std::abs(z)});
  const double square = x * x + y * y + z * z;
  if (largest > 0x1p-480 && largest < 0x1p+500) return std::sqrt(square);
  if (std::isinf(x) || std::isinf(y) || std::isinf(z)) return kInfinity;
  if (largest == 0 || std::isnan(square)) return square;
  const int exponent = std::ilogb(largest);
  x = std::ldexp(x, -exponent), y = std::ldexp(y, -exponent), z = std::ldexp(z, -exponent);
  return std::ldexp(std::sqrt(x * x + y * y + z * z), exponent);
}

}  // namespace raio::core
