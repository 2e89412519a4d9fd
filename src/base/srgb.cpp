#include "base/srgb.h"

#include <algorithm>

#include "base/exact_math.h"

namespace raio::core {
namespace {

double power(double x, double y) { return x > 0 ? exact_exp2(y * exact_log2(x)) : 0; }

// NaN gives 0.
double unit(double x) { return x > 0 ? std::min(x, 1.0) : 0; }

}  // namespace

float srgb_from_linear(float linear) {
  const double x = unit(linear);
  return float(x <= 0.0031308 ? 12.92 * x : unit(1.055 * power(x, 1 / 2.4) - 0.055));
}

float linear_from_srgb(float encoded) {
  const double x = unit(encoded);
  return float(x <= 0.04045 ? x / 12.92 : unit(power((x + 0.055) / 1.055, 2.4)));
}

Rgb linear_from_srgb(Rgb encoded) {
  return {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
}

const std::array<float, 256>& linear_from_srgb_bytes() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> all{};
    for (size_t i = 0; i < all.size(); ++i) all[i] = linear_from_srgb(float(i) / 255);
    return all;
  }();
  return table;
}

Rgb linear_from_srgb(uint32_t rrggbb) {
  const auto part = [&](int shift) { return linear_from_srgb(float(rrggbb >> shift & 255) / 255); };
  return {part(16), part(8), part(0)};
}

}  // namespace raio::core
