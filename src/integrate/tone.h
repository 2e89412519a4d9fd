// How linear light becomes display values: exposure, then a curve. The arithmetic is this file's
// own and not the C library's, so that a picture's bytes are the same on every machine.
#pragma once

#include "base/exact_math.h"
#include "base/srgb.h"
#include "base/vec.h"

namespace raio {

/// `none`: values as they are, clipped by the display. `srgb`: the transfer curve of IEC 61966-2-1,
/// clipped at white. `agx`: the AgX view of Troy Sobotka (https://github.com/sobotka/AgX), which
/// compresses 16.5 stops into the display's range and lets bright colours fade to white instead of
/// clipping channel by channel.
enum class Tone { none, srgb, agx };

/// From the linear colour of a pixel to its display values. With `none` and exposure 0 every colour
/// stays the same to the last bit; `srgb` and `agx` give 0 to 1.
class ToneMap {
 public:
  /// Light is multiplied by 2^exposure_ev first, exposure_ev from -100 to 100.
  ToneMap(Tone tone, float exposure_ev) : tone_(tone), scale_(float(exact_exp2(exposure_ev))) {}

  Rgb operator()(Rgb linear) const;

 private:
  Tone tone_;
  float scale_;
};

}  // namespace raio
