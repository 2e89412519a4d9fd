// The benchmark as a picture for a talk or a page: bars of seconds on a logarithmic axis, with the
// report's seconds beside them where they are known.
#pragma once

#include <expected>
#include <filesystem>
#include <string>

#include "app/bench.h"

namespace raio::app {

enum class PlotFormat { png, svg, pdf };

/// By suffix, in any case; the error lists the suffixes.
std::expected<PlotFormat, std::string> plot_format(const std::filesystem::path& path);

/// The file's bytes: 1600 x 1000 pixels, or the same page in vectors. The error is one line.
std::expected<std::string, std::string> draw_plot(const BenchTable& table, PlotFormat format);

}  // namespace raio::app
