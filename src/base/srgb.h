// Conversion between linear light and display values.
#pragma once

#include <array>
#include <cstdint>

#include "base/vec.h"

namespace raio::core {

/// The sRGB transfer curve and its inverse, from 0 to 1; negative values and NaN give 0, larger
/// values 1.
float srgb_from_linear(float linear);
float linear_from_srgb(float encoded);
Rgb linear_from_srgb(Rgb encoded);
/// A table for all 8-bit display values.
const std::array<float, 256>& linear_from_srgb_bytes();
/// The linear colour of a display value 0xrrggbb.
Rgb linear_from_srgb(uint32_t rrggbb);

}  // namespace raio::core
