// The warnings of render/warnings.h as people read them, with the options that would help.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "integrate/settings.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::app {

/// One line each, without a prefix. Without a structure, the lens is not judged. Of brute force
/// that the file asks for, `tries_tree` tells how long a tree would take, which takes a while
/// itself.
std::vector<std::string> warning_lines(const Scene& scene, const RenderSettings& settings,
                                       const Accel* accel, bool tries_tree = false);

/// What was guessed about the camera: which axis a side of the scene takes for up, where no option
/// says so and the scene's camera is not upright about it, as when it was fitted to molecules; what
/// `fit` most leaves out; how small most of the scene is where all of it is shown by default.
std::vector<std::string> camera_warnings(const RenderOptions& options, const Scene& scene);

}  // namespace raio::app
