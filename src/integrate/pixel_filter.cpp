#include "integrate/pixel_filter.h"

#include <numbers>

#include "base/exact_math.h"

namespace raio::core {
namespace {

// The integral of the window from 0 to x, over that from 0 to 1: Harris 1978, "On the Use of
// Windows for Harmonic Analysis with the Discrete Fourier Transform", the one of four terms and -92
// dB.
double distribution(double x) {
  constexpr double a[] = {0.35875, 0.48829, 0.14128, 0.01168};
  const double turn = 2 * std::numbers::pi;
  return x + (-a[1] * exact_sin(turn * x) + a[2] / 2 * exact_sin(2 * turn * x) -
              a[3] / 3 * exact_sin(3 * turn * x)) /
                 (turn * a[0]);
}

double place_of(double part) {
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (distribution(middle) < part ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace

const std::array<float, kFilterSteps + 1>& filter_places() {
  static const auto kPlaces = [] {
    std::array<float, kFilterSteps + 1> out{};
    for (int i = 0; i <= kFilterSteps / 2; ++i) {
      const double at = kFilterSide * place_of(double(i) / kFilterSteps);
      out[size_t(i)] = float(at - (kFilterSide - 1) / 2);
      out[size_t(kFilterSteps - i)] = float((kFilterSide + 1) / 2 - at);
    }
    return out;
  }();
  return kPlaces;
}

}  // namespace raio::core
