// Cameras around a scene: they rotate about the axis through the point looked at.
#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace raio::core {

/// Camera `index` of `count` spaced evenly around `at`, rotated about `up` to the right as seen by
/// the viewer: counter-clockwise from above, so the scene seems to turn clockwise. Camera 0 is
/// exactly the given one; quarter turns have exact angles. Does not use the C library, so the
/// camera is the same on every machine.
Camera turntable_camera(const Camera& camera, int index, int count);

/// The name of picture `index` (from 0) of `count`: "balls.png" gives "balls-0001.png", with as
/// many digits as the last one needs, at least four.
std::filesystem::path numbered_path(const std::filesystem::path& path, int index, int count);

}  // namespace raio::core
