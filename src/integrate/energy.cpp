#include "integrate/energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

// Points of the unit disc with weights. They are denser near its rim, from which the long tail of
// GGX comes. Half of the azimuths suffice: energy does not depend on the sign of an azimuth.
constexpr size_t kAzimuths = 24, kRings = 48;

struct DiscPoint {
  float inner;  // 1 - the square of the radius
  float cosine, sine;
  float weight;
};
std::array<DiscPoint, kAzimuths * kRings> disc_points() {
  std::array<DiscPoint, kAzimuths * kRings> points{};
  for (size_t a = 0; a < kAzimuths; ++a)
    for (size_t r = 0; r < kRings; ++r) {
      const double azimuth = (double(a) + 0.5) * std::numbers::pi / kAzimuths;
      const double x = (double(r) + 0.5) / kRings, low = double(r) / kRings,
                   high = low + 1.0 / kRings;
      points[a * kRings + r] = {float(x * x * x), float(exact_cos(azimuth)),
                                float(exact_sin(azimuth)),
                                float((high * high * high - low * low * low) / kAzimuths)};
    }
  return points;
}

// The coordinate of a column, and the cosine of a column. The former's first part resolves
// Fresnel's reflectance, the latter masking, which depends on mu / alpha near grazing angles.
double column_of(double mu, double alpha) {
  return (std::sqrt(mu) + mu / std::sqrt(alpha * alpha * (1 - mu * mu) + mu * mu)) / 2;
}
double cosine_of(double column, double alpha) {
  double low = 0, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double mid = (low + high) / 2;
    (column_of(mid, alpha) < column ? low : high) = mid;
  }
  return high;
}

using Row = std::array<float, EnergyTables::kColumns>;

// As that of the header.
inline float reflectance(float cosine, float eta, float behind) {
  const float parallel = (eta * cosine - behind) / (eta * cosine + behind);
  const float perpendicular = (cosine - eta * behind) / (cosine + eta * behind);
  return behind > 0 ? (parallel * parallel + perpendicular * perpendicular) / 2 : 1.0f;
}

// For each cosine of `mu`, the mean of energy(reflectance, masking of the reflected direction, that
// of the refracted one) over the normals that are visible. Maskings are G2 / G1; 0 on the wrong
// side. Visible normals after Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical
// Caps". The loop over columns is vectorised by compilers.
template <class Energy>
Row mean_over_normals(const Row& mu, float alpha, float eta, const Energy& energy) {
  static const auto kPoints = disc_points();
  const float alpha2 = alpha * alpha, inverse = 1 / eta, inverse2 = inverse * inverse;
  Row sine{}, shadow{}, top{}, side{}, sum{};
  for (size_t i = 0; i < mu.size(); ++i) {
    sine[i] = std::sqrt(std::max(1 - mu[i] * mu[i], 0.0f));
    shadow[i] = std::sqrt(alpha2 * sine[i] * sine[i] + mu[i] * mu[i]);
    top[i] = mu[i] / shadow[i], side[i] = alpha * sine[i] / shadow[i];
  }
  for (const DiscPoint& p : kPoints) {
    for (size_t i = 0; i < mu.size(); ++i) {
      const float out_z = mu[i], height = p.inner * (1 + top[i]), z = height - top[i];
      const float around = std::sqrt(std::max(1 - z * z, 0.0f));
      const float x = alpha * (around * p.cosine + side[i]), y = alpha * around * p.sine;
      const float scale = 1 / std::sqrt(x * x + y * y + height * height);
      const float half_z = height * scale;
      const float cosine = std::max((sine[i] * x + out_z * height) * scale, 1e-12f);
      const float visible = out_z + shadow[i];
      const auto masking = [&](float in_z) {
        const float in = std::max(in_z, 0.0f);
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

double dielectric_reflectance(double cosine, double eta) {
  const double k = 1 - (1 - cosine * cosine) / (eta * eta);
  if (k <= 0) return 1;
  const double behind = std::sqrt(k);
  const double parallel = (eta * cosine - behind) / (eta * cosine + behind);
  const double perpendicular = (cosine - eta * behind) / (cosine + eta * behind);
  return (parallel * parallel + perpendicular * perpendicular) / 2;
}

template <class Energy>
uint32_t EnergyTables::add(float eta, const Energy& energy) {
  constexpr double kSmallest = 1e-3;  // of mu / alpha
  const auto first = uint32_t(numbers_.size());
  numbers_.resize(first + kNumbers);
  parallel_for(kRows, [&](size_t row) {
    // Not 0, where no column has a masking.
    const double roughness = std::max(double(row) / (kRows - 1), 1e-2);
    const double alpha = roughness * roughness;
    Row mu{};
    for (size_t i = 0; i < kColumns; ++i)
      mu[i] = float(std::max(cosine_of(double(i) / (kColumns - 1), alpha), kSmallest * alpha));
    const Row numbers = mean_over_normals(mu, float(alpha), eta, energy);
    double average = 0, before = 0;
    for (size_t i = 0; i < kColumns; ++i) {
      const double square = double(mu[i]) * double(mu[i]);
      const float number = std::min(numbers[i], 1.0f);
      const double last = i > 0 ? double(numbers_[first + row * kColumns + i - 1]) : double(number);
      average += (square - before) * (last + double(number)) / 2;
      numbers_[first + row * kColumns + i] = number, before = square;
    }
    numbers_[first + kRows * kColumns + row] = float(average);
  });
  return first;
}

uint32_t EnergyTables::conductor() {
  if (has_conductor_) return conductor_;
  has_conductor_ = true;
  return conductor_ = add(1, [](float, float reflected, float) { return reflected; });
}

EnergyTables::Dielectric EnergyTables::dielectric(float ior) {
  for (const auto& [known, tables] : dielectrics_)
    if (known == ior) return tables;
  const auto both = [](float part, float reflected, float refracted) {
    return part * reflected + (1 - part) * refracted;
  };
  Dielectric tables;
  tables.reflection = add(ior, [](float part, float reflected, float) { return part * reflected; });
  tables.entering = add(ior, both), tables.leaving = add(1 / ior, both);
  dielectrics_.emplace_back(ior, tables);
  return tables;
}

}  // namespace raio::core
