// The distribution of a pixel's samples: its cells, the lens, the lights. sampler-inl.h draws them
// for many pixels at once.
//
// The table of dimensions. Each row is a pair of numbers in the unit square, a function of
// (seed, pixel, sample, branch, purpose), so switching one effect does not move the others:
//
//   purpose      branch                what it positions
//   kPixel       1                     the eye ray in its cell of the pixel
//   kLens        1                     the eye ray on the lens
//   kLight + i   place in ray tree     the shadow ray on light i
//   kGloss       place in ray tree     the mirrored ray of a rough surface in its lobe
//   kTranslucency  place in ray tree   the refracted ray of one
//   kTime        the eye ray's         the time within the shutter, in_unit() only
//   kOcclusion   place in ray tree     ambient shading's rays to the sky: with k rays per sample,
//                                      sample s takes points k s to k s + k - 1
//   kKeyLight    place in ray tree     its shadow ray to the key light
//   kLayer       place in ray tree     which of many transparent layers to shade, in_unit()
//   kLayerKey    place in ray tree     which of the layers behind them stop it, key() only
//   kSkyDepth    place in ray tree     the largest depth a ray to the sky passes, in_unit()
//   kKeyDepth    place in ray tree     the same for the ray to the key light
//   kLightDepth + i  place in ray tree  the same for the ray to light i
//   kBsdf        bounce of a path      its next direction
//   kLobe        bounce of a path      the lobe of the surface, and whether the path ends
//   kLightChoice  bounce of a path     which light it samples, in_unit()
//   kLightPoint  bounce of a path      the point on this light
//   kAlpha       place in ray tree     whether it passes a texture's alpha, in_unit()
//
// A pixel is identified by its column plus 65536 times its row. A group of pixels
// (integrate/screen_keys.h) further down or to the right has a random identity.
// Branch 1 is the eye ray; the reflected child of branch b is 2b, the refracted one 2b + 1. Bounce
// b of a path has the number 2^b.
#pragma once

#include <array>
#include <cmath>

#include "base/random.h"
#include "integrate/settings.h"

namespace raio::core {

enum Purpose : uint32_t {
  kPixel = 0,
  kLens = 1,
  kLight = 2,
  kGloss = 0x80000000u,
  kTranslucency = 0x80000001u,
  kTime = 0x80000002u,
  kOcclusion = 0x80000003u,
  kKeyLight = 0x80000004u,
  kLayer = 0x80000005u,
  kLayerKey = 0x80000006u,
  kSkyDepth = 0x80000007u,
  kKeyDepth = 0x80000008u,
  kBsdf = 0x80000009u,
  kLobe = 0x8000000au,
  kLightChoice = 0x8000000bu,
  kLightPoint = 0x8000000cu,
  kAlpha = 0x8000000du,
  kLightDepth = 0xc0000000u
};

inline constexpr uint32_t kEyeBranch = 1;

/// Blocks of 4 x 4 pixels; the rays of a block are traced together.
inline constexpr int kBlockShift = 2;

struct Sampler {
  SamplerKind kind;
  uint32_t seed, aa, per_cell;      // jitter: aa x aa cells per pixel, per_cell samples in each
  uint32_t samples, columns, rows;  // jitter: the unit square in `samples` equal cells

  explicit Sampler(const RenderSettings& o)
      : kind(o.sampler),
        seed(o.seed * 0x9e3779b9u),
        aa(uint32_t(o.aa)),
        per_cell(uint32_t(o.lens_samples)),
        samples(uint32_t(o.samples_per_pixel())) {
    for (columns = uint32_t(std::sqrt(double(samples))); samples % columns;) --columns;
    rows = samples / columns;
  }

  /// One sample's position in several permutations of 0 .. samples - 1; each pixel or block of
  /// pixels uses one, rotated by its own offset. Pixel positions, lens and lights use different
  /// ones: with the same for two of them, a cell of one would always be paired with the same cell
  /// of the other, and no number of samples would converge.
  static constexpr uint32_t kPermutations = 16;
  struct Share {
    uint32_t first, count;  // a power of two
  };
  static constexpr Share share(uint32_t purpose) {
    return purpose == kPixel ? Share{0, 4} : purpose == kLens ? Share{4, 4} : Share{8, 8};
  }
  using Permutation = std::array<uint32_t, kPermutations>;
  Permutation permutation(uint32_t sample) const {
    Permutation out;
    for (uint32_t i = 0; i < kPermutations; ++i)
      out[i] = permute(sample, samples, seed + scramble(i));
    return out;
  }
};

}  // namespace raio::core
