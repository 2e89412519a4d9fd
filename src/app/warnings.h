// The warnings of render/warnings.h as people read them, with the options that would help.
#pragma once

#include <string>
#include <vector>

#include "accel/accel.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio::app {

/// One line each, without a prefix. Without a structure, the lens is not
/// judged.
std::vector<std::string> warning_lines(const Scene& scene, const RenderSettings& settings,
                                       const Accel* accel);

}  // namespace raio::app
