// The warnings of render/warnings.h as people read them, with the options that would help.
#pragma once

#include <string>
#include <vector>

#include "accel/accel.h"
#include "render/options.h"
#include "scene/scene.h"

namespace raio::app {

/// One line each, without a prefix. For resolved options; without a structure the lens is not
/// judged.
std::vector<std::string> warning_lines(const Scene& scene, const RenderOptions& options,
                                       const Accel* accel);

}  // namespace raio::app
