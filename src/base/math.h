// The few transcendental functions of the hot path, from +, -, *, / alone: the system's own differ
// in the last bits between machines, and pictures must not. Everyone may use it.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/vec.h"

namespace raio {

inline constexpr double kPi = std::numbers::pi;

/// x^y for 0 <= x <= 1 and y >= 0, to a relative error below 1e-6 for y up to 1e5.
/// log2 by the series of atanh about sqrt(1/2)..sqrt(2), exp2 by the Taylor series on -1/2..1/2.
inline float pow_unit(float x, float y) {
  if (!(x > 0)) return y == 0 ? 1.0f : 0.0f;
  if (x >= 1) return 1;
  const uint64_t bits = std::bit_cast<uint64_t>(double(x));
  int exponent = int(bits >> 52) - 1023;
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  if (m > std::numbers::sqrt2) m *= 0.5, ++exponent;
  const double z = (m - 1) / (m + 1), z2 = z * z;
  const double series =
      1 + z2 * (1.0 / 3 + z2 * (1.0 / 5 + z2 * (1.0 / 7 + z2 * (1.0 / 9 + z2 * (1.0 / 11)))));
  const double log2_x = exponent + 2.8853900817779268 * z * series;  // 2 / ln 2
  const double p = double(y) * log2_x;
  if (p < -126) return 0;
  const int whole = int(p - 0.5);  // nearest, for p <= 0
  const double f = (p - whole) * std::numbers::ln2;
  const double e =
      1 + f * (1 + f / 2 * (1 + f / 3 * (1 + f / 4 * (1 + f / 5 * (1 + f / 6 * (1 + f / 7))))));
  return float(e * std::bit_cast<double>(uint64_t(1023 + whole) << 52));
}

/// sin and cos of x for |x| <= pi/4, to a float's precision, by their Taylor series.
inline void sin_cos_octant(double x, double& sine, double& cosine) {
  const double x2 = x * x;
  sine = x * (1 - x2 / 6 * (1 - x2 / 20 * (1 - x2 / 42 * (1 - x2 / 72))));
  cosine = 1 - x2 / 2 * (1 - x2 / 12 * (1 - x2 / 30 * (1 - x2 / 56 * (1 - x2 / 90))));
}

struct Point2 {
  float x = 0, y = 0;
};

/// The unit square onto the unit disc, keeping areas (uniform in, uniform out) and neighbourhoods.
/// Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square", JGT 2(3).
inline Point2 square_to_disc(float u, float v) {
  const double a = 2.0 * u - 1, b = 2.0 * v - 1;
  if (a == 0 && b == 0) return {};
  double sine = 0, cosine = 0;
  if (std::abs(a) > std::abs(b)) {
    sin_cos_octant(kPi / 4 * (b / a), sine, cosine);
    return {float(a * cosine), float(a * sine)};
  }
  sin_cos_octant(kPi / 4 * (a / b), sine, cosine);
  return {float(b * sine), float(b * cosine)};
}

}  // namespace raio
