// Pictures around a scene: the camera goes round the axis through the point looked at.
#pragma once

#include <filesystem>

#include "scene/scene.h"

namespace raio {

/// Camera `index` of `count` that stand evenly around `at`, turned about `up` to the right as seen
/// by who looks: counter-clockwise from above, so that what is looked at seems to turn clockwise.
/// Camera 0 is the one given, to the last bit; quarter turns are exact in their angle. The C
/// library has no part in it, so that the camera is the same on every machine.
Camera turntable_camera(const Camera& camera, int index, int count);

/// The name of picture `index` (from 0) of `count` under the name that was given for all of them:
/// "balls.png" gives "balls-0001.png", with as many digits as all of them need, four at least.
std::filesystem::path numbered_path(const std::filesystem::path& path, int index, int count);

}  // namespace raio
