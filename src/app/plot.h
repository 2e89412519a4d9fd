// The benchmark as a picture for a talk or a page: bars of seconds and dots of relative costs on
// logarithmic axes, with the report's beside them where they are known.
#pragma once

#include <expected>
#include <string>

#include "app/canvas.h"
#include "measure/benchmark.h"

namespace raio::app {

/// The file's bytes: 1600 x 1000 pixels, or the same page in vectors. The error is one line.
std::expected<std::string, std::string> draw_plot(const BenchmarkTable& table, PlotFormat format);

}  // namespace raio::app
