// The energy that microfacets reflect and transmit with one bounce: what they lack is made up for
// by diffuse lobes (bsdf-inl.h), so that rough surfaces do not darken.
#pragma once

#include <cstdint>
#include <tuple>
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
/// where width = min(alpha, kWidest), or kWidest in the first row below layers. After the rows, a
/// table has their averages. Values between are bilinear.
///
/// Layers above a surface, a clear coat and sheen below it, scale what the surface reflects by the
/// lesser of what they transmit for both directions, and its tables contain that, too.
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

  struct Layers {
    float coat = 0, coat_roughness = 0;    // part of the surface
    float sheen = 0, sheen_roughness = 0;  // the brightest component, at most 1

    bool any() const { return coat > 0 || sheen > 0; }
    friend bool operator==(const Layers&, const Layers&) = default;
  };
  /// The columns of layers, after two numbers: the square of the width as above, with the coat's
  /// alpha, and the average of kBelow. All are parts of the light from a direction.
  enum LayerColumn : uint32_t {
    kBelow,        // left below all layers
    kBelowCoat,    // left below the coat
    kSheen,        // scales the sheen: kBelowCoat, or less where the sheen would gain energy
    kSheenShadow,  // G / mu, where G is the sheen's masking
    kLayerColumns
  };
  static constexpr uint32_t kLayerNumbers = 2 + kLayerColumns * kColumns;
  static constexpr float kCoatIor = 1.5f;
  /// Below this roughness, the sheen of grazing rays would be noise.
  static constexpr float kLeastSheen = 0.1f;

  /// Offsets into numbers(), of tables that are computed on first use. `ior`: inside relative to
  /// outside. Light that leaves glass does not meet the layers. Below layers, only what `transmits`
  /// has a table for entering light.
  uint32_t layers(const Layers& of);
  uint32_t conductor(const Layers& above);
  Dielectric dielectric(float ior, const Layers& above, bool transmits);

  const float* numbers() const { return numbers_.data(); }
  size_t size() const { return numbers_.size(); }

 private:
  template <uint32_t kPoints, class Energy>
  uint32_t add(float eta, bool layered, const Energy& energy);

  std::vector<float> numbers_;
  std::vector<std::pair<Layers, uint32_t>> layers_, conductors_;
  std::vector<std::pair<std::tuple<float, Layers, bool>, Dielectric>> dielectrics_;
};

}  // namespace raio::core
