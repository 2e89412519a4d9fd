// Random rays and measurements for tests of single shapes.
#pragma once

#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>

#include "base/ray.h"
#include "shape/kinds.h"

namespace raio::core::tests {

class Random {
 public:
  explicit Random(uint32_t seed) : engine_(seed) {}
  double uniform(double lo = 0, double hi = 1) {
    return std::uniform_real_distribution<double>(lo, hi)(engine_);
  }
  double log_uniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
  Vec3d direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi),
                 s = std::sqrt(1 - z * z);
    return {s * std::cos(angle), s * std::sin(angle), z};
  }
  Vec3d in_cube() { return {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)}; }
  template <class T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[size_t(uniform(0, double(values.size())))];
  }

 private:
  std::mt19937 engine_;
};

/// The area that a shape, at most 1 from its centre, shows to rays of unit direction `dir`.
template <class Baked>
double seen_area(const Baked& shape, Vec3d center, Vec3d dir) {
  const Frame<double> frame(dir);
  constexpr int kSide = 400;
  int hits = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto at = [](int i) { return 2.0 * (i + 0.5) / kSide - 1; };
      const Vec3d from = center + frame.u * at(x) + frame.v * at(y) - dir * 7.0;
      hits += first_hit(shape, {Vec3f(from), Vec3f(dir)}, Sides::both).has_value();
    }
  return hits * 4.0 / (kSide * kSide);
}

}  // namespace raio::core::tests
