// The statistics of a render: --stats (docs/statistics.md) and the line on standard error.
#pragma once

#include <string>

#include "app/json.h"
#include "render/job.h"

namespace raio::core::app {

Json statistics(const RenderFigures& made);

/// "balls.png: 512x512, 1 sample per pixel, bvh: load 1 ms, ...".
std::string summary(const std::string& output, const RenderFigures& made);

}  // namespace raio::core::app
