#include "integrate/energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

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
using Cosines = std::array<double, 2 * EnergyTables::kColumns - 1>;
Cosines cosines_of(double alpha) {
  Cosines all;
  for (size_t i = 0; i < all.size(); ++i)
    all[i] = cosine_of(double(i) / double(all.size() - 1), alpha);
  return all;
}
using AllCosines = std::array<Cosines, EnergyTables::kRows>;
AllCosines all_cosines() {
  AllCosines all;
  for (size_t row = 0; row < all.size(); ++row) all[row] = cosines_of(alpha_of(row));
  return all;
}

using Row = std::array<float, EnergyTables::kColumns>;
Row columns_of(const Cosines& cosines) {
  Row mu{};
  for (size_t i = 0; i < mu.size(); ++i) mu[i] = float(cosines[2 * i]);
  return mu;
}
// The integral over mu^2, by parts, since numbers are linear between columns.
float average_of(const float* row, const Cosines& cosines) {
  const auto square_of = [&](size_t half) { return cosines[half] * cosines[half]; };
  auto average = double(row[EnergyTables::kColumns - 1]);
  for (size_t i = 1; i < EnergyTables::kColumns; ++i) {
    const double mean = (square_of(2 * i - 2) + 4 * square_of(2 * i - 1) + square_of(2 * i)) / 6;
    average -= (double(row[i]) - double(row[i - 1])) * mean;
  }
  return float(average);
}

// Fresnel's equations for unpolarised light. `behind`: the cosine of the refracted ray, 0 at total
// internal reflection.
inline float reflectance(float cosine, float eta, float behind) {
  const float across = eta * behind, along = eta * cosine;
  const float parallel = (along - behind) * (cosine + across);
  const float perpendicular = (cosine - across) * (along + behind);
  const float both = (along + behind) * (cosine + across);
  return (parallel * parallel + perpendicular * perpendicular) / (2 * both * both);
}

// Of a ray that hits a microfacet. Maskings are G2 / G1; 0 on the wrong side.
struct Bounce {
  float part;                  // that is reflected
  float reflected, refracted;  // maskings of the two directions
  float out_z, reflected_z;
};

// For each cosine of `mu`, the mean of energy(Bounce) over the normals that are visible. Visible
// normals after Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical
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
      sum[i] += p.weight * energy(Bounce{reflectance(cosine, eta, behind), masking(reflected),
                                         masking(refracted), out_z, reflected});
    }
  }
  return sum;
}

// Looks up a column of layers.
class LayerColumns {
 public:
  explicit LayerColumns(const float* numbers) : numbers_(numbers) {}
  float at(EnergyTables::LayerColumn column, float cosine) const {
    const float mu = std::clamp(cosine, 1e-6f, 1.0f), mu2 = mu * mu;
    const float shadow = std::sqrt(numbers_[0] * (1 - mu2) + mu2);
    const float along =
        (1.5f * mu / (mu + 0.5f) + mu / shadow) * (float(EnergyTables::kColumns - 1) / 2);
    const auto whole = std::min(uint32_t(along), EnergyTables::kColumns - 2);
    const float* const first = numbers_ + 2 + column * EnergyTables::kColumns + whole;
    return first[0] + (first[1] - first[0]) * (along - float(whole));
  }
  // Of light that is reflected below the layers.
  float pass(const Bounce& b) const {
    return std::min(at(EnergyTables::kBelow, b.out_z), at(EnergyTables::kBelow, b.reflected_z));
  }

 private:
  const float* numbers_;
};

double power(double x, double y) { return exact_exp2(y * exact_log2(std::max(x, 1e-30))); }

// Conty Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF".
class Sheen {
 public:
  explicit Sheen(float roughness) {
    const double r = std::max(roughness, EnergyTables::kLeastSheen);
    alpha_ = r * r;
  }
  // By the cosine of the half vector, times 2 pi.
  double distribution(double cosine2) const {
    return (2 + 1 / alpha_) * power(1 - cosine2, 0.5 / alpha_);
  }
  double masking(double mu) const { return 1 / (1 + lambda(mu)); }

 private:
  double exponent(double mu) const {
    const double t = (1 - alpha_) * (1 - alpha_);
    const auto mix = [&](double rough, double smooth) { return rough + (smooth - rough) * t; };
    return mix(21.5473, 25.3245) / (1 + mix(3.82987, 3.32435) * power(mu, mix(0.19823, 0.16801))) +
           mix(-1.97760, -1.27393) * mu + mix(-4.32054, -4.85967);
  }
  double lambda(double mu) const {
    const double e = mu < 0.5 ? exponent(mu) : 2 * exponent(0.5) - exponent(1 - mu);
    return exact_exp2(e / std::numbers::ln2);
  }

  double alpha_ = 1;
};

// Fills the columns of sheen, below a coat whose column is filled.
void add_sheen(const EnergyTables::Layers& layers, const Row& mu, float* numbers) {
  constexpr size_t kHeights = 64, kAzimuths = 64;
  constexpr size_t kColumns = EnergyTables::kColumns;
  const Sheen sheen(layers.sheen_roughness);
  const LayerColumns columns(numbers);
  const auto column = [&](EnergyTables::LayerColumn c) { return numbers + 2 + c * kColumns; };
  for (size_t i = 0; i < kColumns; ++i)
    column(EnergyTables::kSheenShadow)[i] = float(sheen.masking(double(mu[i])) / double(mu[i]));
  // Of all heights z = t^2, the energy that is sent there, by quadrature.
  std::array<double, kAzimuths> around{};
  for (size_t k = 0; k < kAzimuths; ++k)
    around[k] = exact_cos(std::numbers::pi * (double(k) + 0.5) / kAzimuths);
  const auto height = [](size_t k) {
    const double t = (double(k) + 0.5) / kHeights;
    return t * t;
  };
  std::vector<std::array<double, kHeights>> sent(kColumns);
  parallel_for(kColumns, [&](size_t i) {
    const auto z = double(mu[i]);
    const double g = double(column(EnergyTables::kSheenShadow)[i]) * z;
    for (size_t k = 0; k < kHeights; ++k) {
      const double h = height(k), both = std::sqrt((1 - z * z) * (1 - h * h));
      double sum = 0;
      for (const double cosine : around)
        sum += sheen.distribution((z + h) * (z + h) / (2 + 2 * (both * cosine + z * h)));
      const double q = double(columns.at(EnergyTables::kSheenShadow, float(h))), other = q * h;
      sent[i][k] = sum / kAzimuths * (g / z) * q / (4 * (g + other - g * other)) * h *
                   (2 * std::sqrt(h) / kHeights);
    }
  });
  for (size_t i = 0; i < kColumns; ++i) {
    double all = 0;
    for (const double part : sent[i]) all += part;
    column(EnergyTables::kSheen)[i] =
        column(EnergyTables::kBelowCoat)[i] * float(1 / std::max(all, 1.0));
  }
  for (size_t i = 0; i < kColumns; ++i) {
    const float own = column(EnergyTables::kSheen)[i];
    double all = 0;
    for (size_t k = 0; k < kHeights; ++k)
      all += sent[i][k] * double(std::min(own, columns.at(EnergyTables::kSheen, float(height(k)))));
    column(EnergyTables::kBelow)[i] =
        std::max(column(EnergyTables::kBelowCoat)[i] - layers.sheen * float(all), 0.0f);
  }
}

template <class Key, class Value>
const Value* found_in(const std::vector<std::pair<Key, Value>>& known, const Key& key) {
  const auto at = std::ranges::find(known, key, &std::pair<Key, Value>::first);
  return at == known.end() ? nullptr : &at->second;
}

}  // namespace

template <uint32_t kPoints, class Energy>
uint32_t EnergyTables::add(float eta, bool layered, const Energy& energy) {
  static const AllCosines kCosines = all_cosines();
  AllCosines cosines = kCosines;
  if (layered) cosines[0] = cosines_of(double(kWidest));
  const auto first = uint32_t(numbers_.size());
  std::vector<float> table(kNumbers);
  parallel_for(kRows, [&](size_t row) {
    const Row mu = columns_of(cosines[row]);
    const Row numbers = mean_over_normals<kPoints>(mu, float(alpha_of(row)), eta, energy);
    float* const out = &table[row * kColumns];
    for (size_t i = 0; i < kColumns; ++i) out[i] = std::min(numbers[i], 1.0f);
    table[kRows * kColumns + row] = average_of(out, cosines[row]);
  });
  numbers_.insert(numbers_.end(), table.begin(), table.end());
  return first;
}

uint32_t EnergyTables::layers(const Layers& of) {
  if (const auto* const known = found_in(layers_, of)) return *known;
  const bool is_smooth = of.coat_roughness < kSmoothest;
  const float alpha = is_smooth ? 0 : of.coat_roughness * of.coat_roughness;
  const Cosines cosines = cosines_of(double(is_smooth ? kWidest : alpha));
  const Row mu = columns_of(cosines);
  std::vector<float> block(kLayerNumbers);
  const float width = is_smooth ? kWidest : std::min(alpha, kWidest);
  block[0] = width * width;
  const Row reflected = mean_over_normals<kFew>(
      mu, alpha, kCoatIor, [](const Bounce& b) { return b.part * b.reflected; });
  for (size_t i = 0; i < kColumns; ++i)
    block[2 + kBelowCoat * kColumns + i] = block[2 + kBelow * kColumns + i] =
        1 - of.coat * std::min(reflected[i], 1.0f);
  if (of.sheen > 0) add_sheen(of, mu, block.data());
  block[1] = average_of(&block[2 + kBelow * kColumns], cosines);
  const auto first = uint32_t(numbers_.size());
  numbers_.insert(numbers_.end(), block.begin(), block.end());
  layers_.emplace_back(of, first);
  return first;
}

uint32_t EnergyTables::conductor(const Layers& above) {
  if (const auto* const known = found_in(conductors_, above)) return *known;
  uint32_t table = 0;
  if (above.any()) {
    const LayerColumns columns(&numbers_[layers(above)]);
    table = add<kFew>(1, true, [&](const Bounce& b) { return b.reflected * columns.pass(b); });
  } else {
    table = add<kFew>(1, false, [](const Bounce& b) { return b.reflected; });
  }
  conductors_.emplace_back(above, table);
  return table;
}

EnergyTables::Dielectric EnergyTables::dielectric(float ior, const Layers& above, bool transmits) {
  const std::tuple key(ior, above, transmits || !above.any());
  if (const auto* const known = found_in(dielectrics_, key)) return *known;
  Dielectric tables;
  if (above.any()) {
    tables.leaving = dielectric(ior, {}, true).leaving;
    const float* const first = &numbers_[layers(above)];
    const std::vector<float> copy(first, first + kLayerNumbers);  // numbers_ will move
    const LayerColumns columns(copy.data());
    tables.reflection = add<kFew>(
        ior, true, [&](const Bounce& b) { return b.part * b.reflected * columns.pass(b); });
    tables.entering = tables.reflection;
    if (transmits)
      tables.entering = add<kFew>(ior, true, [&](const Bounce& b) {
        return b.part * b.reflected * columns.pass(b) +
               (1 - b.part) * b.refracted * columns.at(kBelow, b.out_z);
      });
  } else {
    const auto both = [](const Bounce& b) {
      return b.part * b.reflected + (1 - b.part) * b.refracted;
    };
    tables.reflection = add<kFew>(ior, false, [](const Bounce& b) { return b.part * b.reflected; });
    tables.entering = add<kFew>(ior, false, both),
    tables.leaving = add<kMany>(1 / ior, false, both);
  }
  dielectrics_.emplace_back(key, tables);
  return tables;
}

}  // namespace raio::core
