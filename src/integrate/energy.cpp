#include "integrate/energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/exact_math.h"
#include "base/parallel.h"
#include "base/vec.h"

namespace raio::core {
namespace {

// Points of the unit disc, one in each of equal areas. Half of the azimuths suffice: energy does
// not depend on the sign of an azimuth.
constexpr size_t kAzimuths = 12, kRings = 40;

struct DiscPoint {
  double r2, cosine, sine;
};
std::array<DiscPoint, kAzimuths * kRings> disc_points() {
  std::array<DiscPoint, kAzimuths * kRings> points{};
  for (size_t a = 0; a < kAzimuths; ++a)
    for (size_t r = 0; r < kRings; ++r) {
      const double azimuth = (double(a) + 0.5) * std::numbers::pi / kAzimuths;
      points[a * kRings + r] = {(double(r) + 0.5) / kRings, exact_cos(azimuth), exact_sin(azimuth)};
    }
  return points;
}

// Smith's Lambda.
double lambda(double cosine, double alpha) {
  const double c2 = cosine * cosine, tangent2 = std::max(1 - c2, 0.0) / c2;
  return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

// The mean of energy(half . out, masking of the reflected direction, that of the refracted one)
// over the normals that are visible from `out`. Maskings are G2 / G1; 0 on the wrong side. Visible
// normals after Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
template <class Energy>
double mean_over_normals(double mu, double alpha, double eta, const Energy& energy) {
  static const auto kPoints = disc_points();
  const Vec3d out(std::sqrt(std::max(1 - mu * mu, 0.0)), 0, mu);
  const Vec3d stretched = normalize(Vec3d(alpha * out.x, 0, out.z));
  const double lambda_out = lambda(mu, alpha);
  double sum = 0;
  for (const DiscPoint& p : kPoints) {
    const double z = (1 - p.r2) * (1 + stretched.z) - stretched.z;
    const double sine = std::sqrt(std::max(1 - z * z, 0.0));
    const Vec3d cap = Vec3d(sine * p.cosine, sine * p.sine, z) + stretched;
    const Vec3d half = normalize(Vec3d(alpha * cap.x, alpha * cap.y, std::max(cap.z, 1e-12)));
    const double cosine = std::max(dot(out, half), 1e-12);
    const auto masking = [&](double in_z) {
      return in_z > 0 ? (1 + lambda_out) / (1 + lambda_out + lambda(in_z, alpha)) : 0.0;
    };
    const double reflected = 2 * cosine * half.z - out.z;
    const double k = 1 - (1 - cosine * cosine) / (eta * eta);
    const double refracted = k > 0 ? -((cosine / eta - std::sqrt(k)) * half.z - out.z / eta) : 0.0;
    sum += energy(cosine, masking(reflected), masking(refracted));
  }
  return sum / double(kPoints.size());
}

// The average of a row: the integral of 4 E x^3 over x from 0 to 1, with E linear between columns.
double average(const float* row) {
  constexpr size_t kLast = EnergyTables::kColumns - 1;
  double sum = 0;
  for (size_t i = 0; i < kLast; ++i) {
    const double a = double(i) / kLast, b = double(i + 1) / kLast;
    const double slope = (double(row[i + 1]) - double(row[i])) * kLast;
    const double start = double(row[i]) - slope * a;
    const double a4 = a * a * a * a, b4 = b * b * b * b;
    sum += start * (b4 - a4) + slope * 0.8 * (b4 * b - a4 * a);
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
uint32_t EnergyTables::add(const Energy& energy) {
  constexpr double kSmallest = 1e-4;  // of mu; the limit at 0 is not reached evenly
  const auto first = uint32_t(numbers_.size());
  numbers_.resize(first + kNumbers);
  parallel_for(kRows, [&](size_t row) {
    float* const numbers = &numbers_[first + row * kColumns];
    const double roughness = double(row) / (kRows - 1);
    for (size_t column = 0; column < kColumns; ++column) {
      const double x = double(column) / (kColumns - 1);
      numbers[column] =
          float(std::min(energy(std::max(x * x, kSmallest), roughness * roughness), 1.0));
    }
    numbers_[first + kRows * kColumns + row] = float(average(numbers));
  });
  return first;
}

uint32_t EnergyTables::conductor() {
  if (has_conductor_) return conductor_;
  has_conductor_ = true;
  return conductor_ = add([](double mu, double alpha) {
           return mean_over_normals(mu, alpha, 1,
                                    [](double, double reflected, double) { return reflected; });
         });
}

EnergyTables::Dielectric EnergyTables::dielectric(float ior) {
  for (const auto& [known, tables] : dielectrics_)
    if (known == ior) return tables;
  const auto both = [](double eta) {
    return [eta](double mu, double alpha) {
      return mean_over_normals(mu, alpha, eta, [=](double cosine, double out, double through) {
        const double part = dielectric_reflectance(cosine, eta);
        return part * out + (1 - part) * through;
      });
    };
  };
  Dielectric tables;
  tables.reflection = add([&](double mu, double alpha) {
    return mean_over_normals(mu, alpha, double(ior), [&](double cosine, double out, double) {
      return dielectric_reflectance(cosine, double(ior)) * out;
    });
  });
  tables.entering = add(both(double(ior))), tables.leaving = add(both(1 / double(ior)));
  dielectrics_.emplace_back(ior, tables);
  return tables;
}

}  // namespace raio::core
