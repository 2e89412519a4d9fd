// Everything besides the scene that a picture depends on, fully resolved: resolve_options() in
// render/options.h computes it from the user's options.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "accel/accel.h"
#include "integrate/channels.h"
#include "integrate/denoise.h"
#include "integrate/figure.h"
#include "integrate/integrators.h"
#include "integrate/sample_set.h"
#include "integrate/tone.h"
#include "scene/cube_map.h"
#include "scene/scene.h"

namespace raio::core {

/// Distribution of samples in the pixel, on the lens and on the lights (integrate/sampler.h):
/// jittered in equal cells, one per sample; or by Sobol's sequence, which is even for any number.
enum class SamplerKind { jitter, sobol };

/// How a pixel weighs the light around its centre: evenly within its square, or by a smooth window
/// of 3 x 3 pixels (integrate/pixel_filter.h).
enum class PixelFilter { box, blackman_harris };

/// What the integrator `views` shows; `samples`: the number of samples per pixel.
enum class View { picture, normals, depth, ids, materials, steps, tests, focus, samples };
inline constexpr int kViews = 9;

/// The shading model of the integrator `classic` (docs/shading.md): that of NFF; or without ambient
/// light, with the highlight of Phong 1975 or Blinn 1977.
enum class ShadingModel { nff, phong, blinn_phong };

/// How light splits into reflection and refraction where T > 0: by Ks and T, by Fresnel's
/// equations, or by the approximation of Schlick 1994.
enum class Fresnel { none, exact, schlick };

inline constexpr int kMaxDepth = 32;  // a branch of the ray tree has 32 bits (integrate/sampler.h)
inline constexpr int kMaxSamples = 1 << 24;  // per pixel; the sampler numbers them in 32 bits

/// The rendered part of a picture: columns x0 to x1 - 1 and rows y0 to y1 - 1 of the whole.
struct Crop {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }

  friend bool operator==(const Crop&, const Crop&) = default;
};

/// The options whose resolved values have the same type, shared by RenderOptions (render/options.h)
/// and RenderSettings. In RenderOptions, zero or empty values are undecided; in RenderSettings,
/// they have the meaning in the comments.
struct PlainOptions {
  AccelOptions accel;
  View view = View::picture;
  ChannelSet channels;
  Exposure exposure;  // of display formats
  Denoiser denoise = Denoiser::none;

  int width = 0, height = 0;      // of the whole picture, pixels
  float dpi = 0;                  // of the printed picture; 0: no print size
  std::optional<Crop> crop;       // the part to render, otherwise everything
  bool angle_to_centers = false;  // for the field of view: see EyeRays

  uint32_t seed = 0;
  int aa = 0;            // cells along a pixel's side; 1: its centre; 0: the whole pixel
  int lens_samples = 0;  // per cell
  int samples = 0;       // per pixel in total, instead of aa x aa x lens_samples; 0: that product
  // Each tile gets samples, min_samples to max_samples, until its relative error is below `noise`
  // (docs/adaptive.md). RenderSettings::samples is then max_samples. 0: all tiles have `samples`.
  float noise = 0;
  int min_samples = 0, max_samples = 0;

  int depth = 0;  // levels of rays
  bool soft_shadows = false;
  float light_size = 0;           // side of the square; 0: a tenth of the light's distance
  float aperture = 0, focus = 0;  // lens radius and focus distance, also without dof
  bool no_reflection = false, no_refraction = false;
  // The spread of mirrored and refracted directions; if absent, the materials' roughness.
  std::optional<float> gloss, translucency;
  bool one_sided = false;

  int threads = 0;  // no effect on the picture

  /// If resolved; with `noise` the most.
  int samples_per_pixel() const {
    return noise > 0 ? max_samples : samples > 0 ? samples : aa * aa * lens_samples;
  }
  /// If resolved. The second round ends with the fewest samples.
  SampleRounds rounds() const { return {noise > 0 ? uint32_t(min_samples + 1) / 2 : 0}; }

  /// The channels of the film: those of the picture, and what the denoiser needs.
  ChannelSet film_channels() const {
    ChannelSet all = channels;
    if (denoise != Denoiser::none)
      for (const Channel channel : kGuideChannels) all.add(channel);
    return all;
  }

  friend bool operator==(const PlainOptions&, const PlainOptions&) = default;
};

struct RenderSettings : PlainOptions {
  IntegratorKind integrator = IntegratorKind::classic;
  Rgb background;                      // the radiance of rays that hit nothing
  std::shared_ptr<const CubeMap> sky;  // replaces it; null: none
  bool sees_environment = false;       // replaces both by the scene's environment
  Tone tone = Tone::none;              // for display formats

  float preview_scale = 1;  // its sides relative to those of the picture that View::focus judges
  Camera camera;            // coordinates relative to the scene's origin
  SamplerKind sampler = SamplerKind::jitter;
  PixelFilter filter = PixelFilter::box;
  bool dof = false;
  ShadingModel shading = ShadingModel::nff;
  Fresnel fresnel = Fresnel::none;
  // When the shutter opens and closes, for motion blur; samples are at times in between. Equal: all
  // at that time.
  float shutter_open = 0, shutter_close = 1;
  FigureSettings figure;  // for the integrator `ambient`

  RenderSettings() { width = height = 512, aa = lens_samples = threads = 1, depth = 5; }

  /// The rendered part of the whole picture.
  Crop frame() const { return crop.value_or(Crop{0, 0, width, height}); }

  /// The width in pixels of a line that is one pixel wide on a display.
  float line_scale() const { return dpi > 0 ? dpi / 96 : 1; }

  friend bool operator==(const RenderSettings&, const RenderSettings&) = default;
};

}  // namespace raio::core
