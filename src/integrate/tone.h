// Converts linear light to display values: exposure, then a curve. Does not use the C library's
// functions, so a picture's bytes are the same on every machine.
#pragma once

#include "base/exact_math.h"
#include "base/srgb.h"
#include "base/vec.h"

namespace raio::core {

/// `none`: unchanged values, clipped by the display. `srgb`: the transfer curve of IEC 61966-2-1,
/// clipped at white. `agx`: the AgX view of Troy Sobotka (https://github.com/sobotka/AgX), which
/// compresses 16.5 stops into the display's range and lets bright colours fade to white instead of
/// clipping channels.
enum class Tone { none, srgb, agx };

/// Converts the linear colour of a pixel to display values. With `none` and exposure 0 it is the
/// identity, exactly; `srgb` and `agx` give 0 to 1.
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
