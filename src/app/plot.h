// The benchmark as a picture for a talk or a page: bars of seconds and dots of relative costs on
// logarithmic axes, with the report's figures if known.
#pragma once

#include <expected>
#include <string>

#include "draw/canvas.h"
#include "measure/benchmark.h"

namespace raio::core::app {

/// The bytes of a file: 1600 x 1000 pixels, or the same page in vectors. The error is one line.
std::expected<std::string, std::string> draw_plot(const BenchmarkTable& table, PlotFormat format);

}  // namespace raio::core::app
