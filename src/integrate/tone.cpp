#include "integrate/tone.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "base/parallel.h"

namespace raio::core {
namespace {

// NaN gives 0.
double unit(double x) { return x > 0 ? std::min(x, 1.0) : 0; }

using Rows = std::array<Vec3d, 3>;

Vec3d times(const Rows& m, Vec3d v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }

// AgX by the fit of Benjamin Wrensch, "Minimal AgX Implementation" (2023,
// https://iolite-engine.com/blog_posts/minimal_agx_implementation): the inset of the primaries,
// which lets pure colours reach white, and its inverse; light in stops from kDarkest to kBrightest;
// the contrast curve as a polynomial of degree six, with a mean square error of 3.7e-6. The result
// is encoded for the display.
constexpr Rows kInset = {{{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                          {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                          {0.0423756549057051, 0.0784336, 0.879142973793104}}};
constexpr Rows kOutset = {{{1.19687900512017, -0.0980208811401368, -0.0990297440797205},
                           {-0.0528968517574562, 1.15190312990417, -0.0989611768448433},
                           {-0.0529716355144438, -0.0980434501171241, 1.15107367264116}}};
constexpr double kDarkest = -12.47393, kBrightest = 4.026069;

double agx_contrast(double linear) {
  // At least kDarkest, so that the logarithm is finite.
  const double stops = exact_log2(std::max(linear, 0x1p-13));
  const double x = unit((stops - kDarkest) / (kBrightest - kDarkest));
  double y = 15.5;
  for (const double next : {-40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232}) y = y * x + next;
  return y;
}

// Without negative numbers and NaN, which become 0, and infinity, whose product with zero is NaN.
Vec3d light_of(Rgb linear) {
  Vec3d light;
  for (int c = 0; c < 3; ++c)
    light[c] = linear[c] > 0 ? double(std::min(linear[c], std::numeric_limits<float>::max())) : 0;
  return light;
}

Rgb agx(Rgb linear) {
  Vec3d color = times(kInset, light_of(linear));
  for (int c = 0; c < 3; ++c) color[c] = agx_contrast(color[c]);
  color = times(kOutset, color);
  return {float(unit(color.x)), float(unit(color.y)), float(unit(color.z))};
}

// As the specification states it; only its names differ. The display's curve follows.
Rgb neutral(Rgb linear) {
  constexpr double kStart = 0.8 - 0.04, kDesaturation = 0.15;
  Vec3d color = light_of(linear);
  const double least = std::min({color.x, color.y, color.z});
  const double offset = least < 0.08 ? least - 6.25 * least * least : 0.04;
  color = color - Vec3d(offset);
  const double peak = std::max({color.x, color.y, color.z});
  if (peak >= kStart) {
    constexpr double kRoom = 1 - kStart;
    const double new_peak = 1 - kRoom * kRoom / (peak + kRoom - kStart);
    const double white = 1 - 1 / (kDesaturation * (peak - new_peak) + 1);
    color = color * (new_peak / peak * (1 - white)) + Vec3d(new_peak * white);
  }
  return {srgb_from_linear(float(color.x)), srgb_from_linear(float(color.y)),
          srgb_from_linear(float(color.z))};
}

}  // namespace

float exposure_of(std::span<const Rgb> colors, std::span<const float> alpha) {
  struct Sum {
    double stops = 0, weight = 0;
  };
  std::vector<Sum> sums(chunks_of(colors.size()));  // added in order, whatever the threads
  for_chunks(colors.size(), [&](size_t chunk, size_t first, size_t end) {
    Sum& sum = sums[chunk];
    for (size_t i = first; i < end; ++i) {
      const double covered = alpha.empty() ? 1 : double(alpha[i]);
      const double luminance = dot(Vec3d(0.2126, 0.7152, 0.0722), Vec3d(colors[i])) / covered;
      if (!(covered > 0 && luminance >= 0x1p-120 && luminance <= 0x1p120)) continue;
      sum.stops += covered * exact_log2(luminance), sum.weight += covered;
    }
  });
  Sum all;
  for (const Sum& sum : sums) all.stops += sum.stops, all.weight += sum.weight;
  constexpr double kGrey = 0.18;
  if (all.weight == 0) return 0;
  return float(std::clamp(exact_log2(kGrey) - all.stops / all.weight, -100.0, 100.0));
}

Rgb ToneMap::operator()(Rgb linear) const {
  const Rgb light = linear * scale_;
  switch (tone_) {
    case Tone::none:
      break;
    case Tone::srgb:
      return {srgb_from_linear(light.x), srgb_from_linear(light.y), srgb_from_linear(light.z)};
    case Tone::agx:
      return agx(light);
    case Tone::neutral:
      return neutral(light);
  }
  return light;
}

}  // namespace raio::core
