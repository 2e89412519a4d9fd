#include "integrate/energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

// Points of the unit disc with weights, along Fermat's spiral: the integrands have kinks, which a
// lattice would sample badly. They are denser near the rim, from which the long tail of GGX comes.
struct DiscPoint {
  float inner;  // 1 - the square of the radius
  float cosine, sine;
  float weight;
};
template <uint32_t kPoints>
std::array<DiscPoint, kPoints> disc_points() {
  constexpr double kGolden = 0.6180339887498949, kCount = double(kPoints);
  std::array<DiscPoint, kPoints> points{};
  for (size_t i = 0; i < kPoints; ++i) {
    const double turns = double(i) * kGolden, part = (double(i) + 0.5) / kCount;
    const double azimuth = 2 * std::numbers::pi * (turns - std::floor(turns));
    points[i] = {float(part * part), float(exact_cos(azimuth)), float(exact_sin(azimuth)),
                 float(2 * part / kCount)};
  }
  return points;
}

// Of points. Total internal reflection has the hardest kink.
constexpr uint32_t kFew = 640, kMany = 2048;

// The coordinate of a column, and the cosine of a column. The former's first part resolves
// Fresnel's reflectance, the latter masking, which depends on mu / alpha near grazing angles.
double column_of(double mu, double alpha) {
  const double width = std::min(alpha, double(EnergyTables::kWidest));
  return (1.5 * mu / (mu + 0.5) + mu / std::sqrt(width * width * (1 - mu * mu) + mu * mu)) / 2;
}
double cosine_of(double column, double alpha) {
  double low = 0, high = 1;
  for (int i = 0; i < 24; ++i) {
    const double mid = (low + high) / 2;
    (column_of(mid, alpha) < column ? low : high) = mid;
  }
  return std::max(high, 1e-6);  // E has a limit at 0
}

double alpha_of(size_t row) {
  constexpr auto kRoot = double(EnergyTables::kSmoothestRoot);
  if (row == 0) return 0;
  const double root = kRoot + double(row - 1) / (EnergyTables::kRows - 2) * (1 - kRoot);
  return root * root * root * root;
}

// The cosines of each row's columns, and of the middles between them.
using Cosines = std::array<std::array<double, 2 * EnergyTables::kColumns - 1>, EnergyTables::kRows>;
Cosines all_cosines() {
  Cosines all;
  for (size_t row = 0; row < all.size(); ++row)
    for (size_t i = 0; i < all[row].size(); ++i)
      all[row][i] = cosine_of(double(i) / double(all[row].size() - 1), alpha_of(row));
  return all;
}

using Row = std::array<float, EnergyTables::kColumns>;

// Fresnel's equations for unpolarised light. `behind`: the cosine of the refracted ray, 0 at total
// internal reflection.
inline float reflectance(float cosine, float eta, float behind) {
  const float across = eta * behind, along = eta * cosine;
  const float parallel = (along - behind) * (cosine + across);
  const float perpendicular = (cosine - across) * (along + behind);
  const float both = (along + behind) * (cosine + across);
  return (parallel * parallel + perpendicular * perpendicular) / (2 * both * both);
}

// For each cosine of `mu`, the mean of energy(reflectance, masking of the reflected direction, that
// of the refracted one) over the normals that are visible. Maskings are G2 / G1; 0 on the wrong
// side. Visible normals after Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical
// Caps". Compilers vectorise the loop over columns; GCC 12 does not if the cosine has a maximum.
template <uint32_t kPoints, class Energy>
Row mean_over_normals(const Row& mu, float alpha, float eta, const Energy& energy) {
  static const auto points = disc_points<kPoints>();
  const float alpha2 = alpha * alpha, inverse = 1 / eta, inverse2 = inverse * inverse;
  Row sine{}, shadow{}, top{}, side{}, sum{};
  for (size_t i = 0; i < mu.size(); ++i) {
    sine[i] = std::sqrt(std::max(1 - mu[i] * mu[i], 0.0f));
    shadow[i] = std::sqrt(alpha2 * sine[i] * sine[i] + mu[i] * mu[i]);
    top[i] = mu[i] / shadow[i], side[i] = alpha * sine[i] / shadow[i];
  }
  for (const DiscPoint& p : points) {
    for (size_t i = 0; i < mu.size(); ++i) {
      const float out_z = mu[i], height = p.inner * (1 + top[i]), z = height - top[i];
      const float around = std::sqrt(std::max(1 - z * z, 0.0f));
      const float x = alpha * (around * p.cosine + side[i]), y = alpha * around * p.sine;
      const float scale = 1 / std::sqrt(x * x + y * y + height * height);
      const float half_z = height * scale;
      const float cosine = std::abs(sine[i] * x + out_z * height) * scale + 1e-6f;  // not 0
      const float visible = out_z + shadow[i];
      const auto masking = [&](float in_z) {
        const float in = std::max(in_z, 1e-15f);  // not 0 / 0, not denormal
        const float in_shadow = std::sqrt(alpha2 + (1 - alpha2) * in * in);
        return visible * in / (shadow[i] * in + in_shadow * out_z);
      };
      const float k = 1 - (1 - cosine * cosine) * inverse2;
      const float behind = std::sqrt(std::max(k, 0.0f));
      const float reflected = 2 * cosine * half_z - out_z;
      const float refracted = out_z * inverse - (cosine * inverse - behind) * half_z;
      sum[i] += p.weight *
                energy(reflectance(cosine, eta, behind), masking(reflected), masking(refracted));
    }
  }
  return sum;
}

}  // namespace

template <uint32_t kPoints, class Energy>
uint32_t EnergyTables::add(float eta, const Energy& energy) {
  static const Cosines cosines = all_cosines();
  const auto first = uint32_t(numbers_.size());
  numbers_.resize(first + kNumbers);
  parallel_for(kRows, [&](size_t row) {
    const auto square_of = [&](size_t half) { return cosines[row][half] * cosines[row][half]; };
    Row mu{};
    for (size_t i = 0; i < kColumns; ++i) mu[i] = float(cosines[row][2 * i]);
    const Row numbers = mean_over_normals<kPoints>(mu, float(alpha_of(row)), eta, energy);
    float* const out = &numbers_[first + row * kColumns];
    for (size_t i = 0; i < kColumns; ++i) out[i] = std::min(numbers[i], 1.0f);
    // The integral of E over mu^2, by parts, since E is linear between columns.
    auto average = double(out[kColumns - 1]);
    for (size_t i = 1; i < kColumns; ++i) {
      const double mean = (square_of(2 * i - 2) + 4 * square_of(2 * i - 1) + square_of(2 * i)) / 6;
      average -= (double(out[i]) - double(out[i - 1])) * mean;
    }
    numbers_[first + kRows * kColumns + row] = float(average);
  });
  return first;
}

uint32_t EnergyTables::conductor() {
  if (has_conductor_) return conductor_;
  has_conductor_ = true;
  return conductor_ = add<kFew>(1, [](float, float reflected, float) { return reflected; });
}

EnergyTables::Dielectric EnergyTables::dielectric(float ior) {
  for (const auto& [known, tables] : dielectrics_)
    if (known == ior) return tables;
  const auto both = [](float part, float reflected, float refracted) {
    return part * reflected + (1 - part) * refracted;
  };
  Dielectric tables;
  tables.reflection =
      add<kFew>(ior, [](float part, float reflected, float) { return part * reflected; });
  tables.entering = add<kFew>(ior, both), tables.leaving = add<kMany>(1 / ior, both);
  dielectrics_.emplace_back(ior, tables);
  return tables;
}

}  // namespace raio::core
