// The energy that microfacets reflect and transmit with one bounce: what they lack is made up for
// by diffuse lobes (bsdf-inl.h), so that rough surfaces do not darken.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace raio::core {

/// Directional albedos E(mu, alpha) of the GGX distribution with Smith's height-correlated
/// masking, and their averages, 2 times the integral of E mu over mu. Kulla and Conty 2017,
/// "Revisiting Physically Based Shading at Imageworks".
///
/// The first row of a table is that of perfectly smooth surfaces; the others are equally spaced in
/// the square root of the roughness, whose square is alpha, from kSmoothest to 1. Columns are
/// equally spaced in the mean of 1.5 mu / (mu + 1/2) and mu / (width^2 (1 - mu^2) + mu^2)^(1/2),
/// where width = min(alpha, kWidest). After the rows, a table has their averages. Values between
/// are bilinear.
class EnergyTables {
 public:
  static constexpr uint32_t kRows = 32, kColumns = 97, kNumbers = kRows * (kColumns + 1);

  /// Below this roughness, reflections are perfectly sharp: floats cannot resolve the lobe's peak.
  static constexpr float kSmoothest = 1.0f / 32, kSmoothestRoot = 0.17677669f;
  static constexpr float kWidest = 1.0f / 32;

  /// The tables of a surface that separates indices of refraction, those outside and inside.
  struct Dielectric {
    uint32_t reflection = 0;             // what it reflects outside
    uint32_t entering = 0, leaving = 0;  // what it reflects and transmits, together
  };

  /// Offsets into numbers(), of tables that are computed on first use. `ior`: inside relative to
  /// outside.
  uint32_t conductor();
  Dielectric dielectric(float ior);

  const float* numbers() const { return numbers_.data(); }

 private:
  template <uint32_t kPoints, class Energy>
  uint32_t add(float eta, const Energy& energy);

  std::vector<float> numbers_;
  std::vector<std::pair<float, Dielectric>> dielectrics_;
  bool has_conductor_ = false;
  uint32_t conductor_ = 0;
};

}  // namespace raio::core
