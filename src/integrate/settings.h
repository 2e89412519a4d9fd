// Everything that a picture depends on besides the scene, with nothing left open:
// resolve_options() in render/options.h makes it of what a user asks for.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "accel/accel.h"
#include "integrate/channels.h"
#include "integrate/figure.h"
#include "integrate/integrators.h"
#include "integrate/tone.h"
#include "scene/cube_map.h"
#include "scene/scene.h"

namespace raio {

/// Where samples go in the pixel, on the lens and on the lights (integrate/sampler.h): at random in
/// equal cells, as many as there are samples; or by Sobol's sequence, which is even after any
/// number.
enum class SamplerKind { jitter, sobol };

/// What the integrator `views` shows, and `samples`: how many samples the pixels have.
enum class View { picture, normals, depth, ids, materials, steps, tests, focus, samples };
inline constexpr int kViews = 9;

/// The light at a surface in the integrator `classic` (docs/shading.md): that of NFF; or without
/// ambient light, with the highlight of Phong 1975 or that of Blinn 1977.
enum class ShadingModel { nff, phong, blinn_phong };

/// How light divides at a surface with T > 0 into reflected and refracted: by Ks and T, by
/// Fresnel's equations, or by the approximation of Schlick 1994.
enum class Fresnel { none, exact, schlick };

inline constexpr int kMaxDepth = 32;  // a place in the ray tree has 32 bits (integrate/sampler.h)
inline constexpr int kMaxSamples = 1 << 24;  // of a pixel; the sampler numbers them in 32 bits

/// The part of a picture that is rendered: columns x0 to x1 - 1 and rows y0 to y1 - 1 of the whole.
struct Crop {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }

  friend bool operator==(const Crop&, const Crop&) = default;
};

struct RenderSettings {
  AccelOptions accel;
  IntegratorKind integrator = IntegratorKind::classic;
  View view = View::picture;
  ChannelSet channels;
  Rgb background;                      // what rays bring that hit nothing
  std::shared_ptr<const CubeMap> sky;  // in place of it; null: none
  Tone tone = Tone::none;              // of display formats, as is the exposure, in stops
  float exposure = 0;

  int width = 512, height = 512;  // of the whole picture, pixels
  float dpi = 0;                  // of the printed picture; 0: it has no size in print
  float preview_scale = 1;        // its sides by those of the picture that View::focus judges
  std::optional<Crop> crop;       // a part of it, without which all of it is rendered
  Camera camera;                  // its coordinates are relative to the scene's origin
  bool angle_to_centers = false;  // of view: see EyeRays

  SamplerKind sampler = SamplerKind::jitter;
  uint32_t seed = 0;
  int aa = 1;            // cells along a side of the pixel; 1: its centre; 0: all of it
  int lens_samples = 1;  // of each cell
  int samples = 0;       // of a pixel in all, instead of aa x aa x lens_samples; 0: those

  int depth = 5;  // levels of rays
  bool soft_shadows = false;
  float light_size = 0;  // side of the square; 0: a tenth of the light's distance
  bool dof = false;
  float aperture = 0, focus = 0;  // the lens' radius and the distance in focus, also without dof
  bool reflection = true, refraction = true;
  ShadingModel shading = ShadingModel::nff;
  Fresnel fresnel = Fresnel::none;
  // How far mirrored and refracted directions spread; without, as the materials say.
  std::optional<float> gloss, translucency;
  // When the shutter opens and closes, for what moves; a sample is of a moment in between. Equal:
  // of that moment.
  float shutter_open = 0, shutter_close = 1;
  bool one_sided = false;
  FigureSettings figure;  // of the integrator `ambient`

  int threads = 1;  // no picture depends on it

  /// What is rendered of the whole picture.
  Crop frame() const { return crop.value_or(Crop{0, 0, width, height}); }

  /// Pixels of a line that is one wide on a display.
  float line_scale() const { return dpi > 0 ? dpi / 96 : 1; }

  int samples_per_pixel() const { return samples > 0 ? samples : aa * aa * lens_samples; }

  friend bool operator==(const RenderSettings&, const RenderSettings&) = default;
};

}  // namespace raio
