// Raio's own filter against the noise of few samples. Its bytes are the same on every machine.
#pragma once

#include <span>

#include "integrate/channels.h"
#include "io/image/image.h"

namespace raio::core {

/// The filter for `denoise`: none; Open Image Denoise (integrate/oidn.h); or Raio's own.
/// `automatic` is Open Image Denoise where it is found, else Raio's own.
enum class Denoiser : uint8_t { none, automatic, oidn, raio };

/// The channels that guide the filter, row by row.
struct PixelGuides {
  std::span<const float> alpha;       // one number per pixel; empty: all are opaque
  std::span<const float> albedo;      // three numbers per pixel, as the channel
  std::span<const float> normal;      // three
  std::span<const float> depth;       // one
  std::span<const float> variance;    // three: that of the pixel's samples
  std::span<const uint32_t> samples;  // one

  float alpha_of(size_t pixel) const { return alpha.empty() ? 1 : alpha[pixel]; }
};

/// The channels that the guides come from, besides alpha and the number of samples.
inline constexpr std::array kGuideChannels = {Channel::albedo, Channel::normal, Channel::depth,
                                              Channel::variance};

/// Whether a filter uses and changes a pixel. It is covered, and its numbers are neither NaN nor
/// too large for squares.
bool can_denoise(const Rgb& color, const PixelGuides& guides, size_t pixel);

/// Replaces each colour by the value of a linear model of its surroundings: the colour as a
/// function of position, normal, albedo and depth, fitted by weighted least squares to the pixels
/// whose patches look alike within their noise. After Moon et al., "Adaptive Rendering Based on
/// Weighted Local Regression" (2014), and Bitterli et al., "Nonlinearly Weighted First-order
/// Regression for Denoising Monte Carlo Renderings" (2016); weights of Rousselle et al., "Robust
/// Denoising using Feature and Color Information" (2013). Colours are premultiplied by alpha, which
/// stays. No result is outside the range of the colours that it comes from; NaN and infinity stay
/// in their pixels.
void denoise(Image& color, const PixelGuides& guides);

}  // namespace raio::core
