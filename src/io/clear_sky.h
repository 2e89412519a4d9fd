// The light of the sun and of a clear sky.
#pragma once

#include "io/image/image.h"

namespace raio::core {

/// The luminance of the value 1, in cd/m^2: white surfaces in the sun are then about 1.
inline constexpr double kSkyUnit = 25'000;

/// The width of the picture; the height is half of it.
inline constexpr int kSkyWidth = 2048;

/// An equirectangular picture of the radiance from all directions near the ground, with the sun
/// above the middle of its lower edge. `turbidity` is the optical depth of the air over that of air
/// without aerosols, at 550 nm: 2 very clear, 3 clear, 6 hazy; from 1 to 10. `elevation` of the
/// sun's centre above the horizon, from 0 to 90 degrees. docs/light.md describes the model. All
/// threads work on it; the picture does not depend on them.
Image clear_sky(double turbidity, double elevation);

}  // namespace raio::core
