// The benchmark as a picture for a talk or a page: bars of seconds on a logarithmic axis, with the
// report's seconds beside them where they are known.
#pragma once

#include <expected>
#include <string>

#include "app/bench.h"
#include "app/canvas.h"

namespace raio::app {

/// The file's bytes: 1600 x 1000 pixels, or the same page in vectors. The error is one line.
std::expected<std::string, std::string> draw_plot(const BenchTable& table, PlotFormat format);

}  // namespace raio::app
