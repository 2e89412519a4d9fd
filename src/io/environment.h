// Reads environments: equirectangular pictures of the light from all directions.
#pragma once

#include <expected>
#include <filesystem>

#include "base/error.h"
#include "scene/scene.h"

namespace raio::core {

/// The largest width; the height is half of it.
inline constexpr int kLargestEnvironment = 16384;

/// Lights the scene by the picture (EXR, HDR, PFM; PNG, JPEG and PPM are sRGB), which replaces its
/// environment. The picture's upper edge is towards the axis closest to `up`; its middle column
/// towards -Z, or towards +Y if that axis is Z, turned by `rotation` degrees counterclockwise as
/// seen from above. The error names what was found and what was expected. The file is not trusted.
/// Throws std::bad_alloc and Stopped.
std::expected<void, Error> set_environment(Scene& scene, const std::filesystem::path& path,
                                           Vec3f up, double rotation);

/// Lights the scene by the sun and a clear sky (io/clear_sky.h) in the same way. `azimuth` is that
/// of the sun in degrees, clockwise from where the middle column of a picture would be.
void set_clear_sky(Scene& scene, double turbidity, double elevation, double azimuth, Vec3f up,
                   double rotation);

}  // namespace raio::core
