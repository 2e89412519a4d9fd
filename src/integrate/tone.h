// Converts linear light to display values: exposure, then a curve. Does not use the C library's
// functions, so a picture's bytes are the same on every machine.
#pragma once

#include <span>

#include "base/exact_math.h"
#include "base/srgb.h"
#include "base/vec.h"

namespace raio::core {

/// `none`: unchanged values, clipped by the display. `srgb`: the transfer curve of IEC 61966-2-1,
/// clipped at white. `agx`: the AgX view of Troy Sobotka (https://github.com/sobotka/AgX), which
/// compresses 16.5 stops into the display's range and lets bright colours fade to white instead of
/// clipping channels. `neutral`: the PBR Neutral tone mapper of the Khronos Group
/// (https://github.com/KhronosGroup/ToneMapping), which keeps colours up to 0.76 as they are, less
/// 0.04, and compresses brighter ones towards white.
enum class Tone { none, srgb, agx, neutral };

/// The exposure of a picture in stops; or chosen from the picture by exposure_of().
struct Exposure {
  float ev = 0;
  bool automatic = false;

  friend bool operator==(const Exposure&, const Exposure&) = default;
};

/// The exposure in stops that maps the geometric mean of the luminance to 0.18, the reflectance of
/// photographers' grey cards (Reinhard et al., "Photographic Tone Reproduction for Digital Images",
/// 2002). Black pixels do not count, nor do numbers that are not finite; others count by `alpha`,
/// which may be empty, and by which the colours are premultiplied. 0 if no pixel counts; from -100
/// to 100.
float exposure_of(std::span<const Rgb> colors, std::span<const float> alpha);

/// Converts the linear colour of a pixel to display values. With `none` and exposure 0 it is the
/// identity, exactly; the others give 0 to 1.
class ToneMap {
 public:
  /// Light is first multiplied by 2^exposure_ev, exposure_ev from -100 to 100.
  ToneMap(Tone tone, float exposure_ev) : tone_(tone), scale_(float(exact_exp2(exposure_ev))) {}

  Rgb operator()(Rgb linear) const;

 private:
  Tone tone_;
  float scale_;
};

}  // namespace raio::core
