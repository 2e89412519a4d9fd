#include "base/exact_math.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace raio {

// The series of atanh about sqrt(1/2)..sqrt(2), where its argument is at most 0.172.
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

// Taylor's series of the exponential on half a power of two to either side.
double exact_exp2(double x) {
  const double whole = std::floor(x + 0.5), f = (x - whole) * std::numbers::ln2;
  double series = 1;
  for (int n = 14; n >= 1; --n) series = series * f / n + 1;
  return series * std::bit_cast<double>(uint64_t(int64_t(whole) + 1023) << 52);
}

}  // namespace raio
