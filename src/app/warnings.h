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

/// Guesses about the camera. They name the up axis of a side that was taken from a tilted camera,
/// what `fit` most leaves out, and stray parts that make the rest of a default picture small.
std::vector<std::string> camera_warnings(const RenderOptions& options, const Scene& scene);

}  // namespace raio::app
