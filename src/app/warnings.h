// The warnings of render/warnings.h as text, with the options that would help.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/accel.h"
#include "integrate/settings.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::core::app {

/// One line each, without a prefix. Without a structure, the lens is not judged. If the file
/// requests brute force, `tries_tree` estimates the time with a tree, which takes some time itself.
std::vector<std::string> warning_lines(const Scene& scene, const RenderSettings& settings,
                                       const Accel* accel, bool tries_tree = false);

/// Warnings about guesses: the up axis of a side view of a tilted camera, what `fit` most ignores,
/// and stray parts that make the rest of a default picture small.
std::vector<std::string> camera_warnings(const RenderOptions& options, const Scene& scene);

}  // namespace raio::core::app
