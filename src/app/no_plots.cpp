// Replaces the sources that draw plots (plot.cpp, explain_plot.cpp) in builds with RAIO_PLOTS=OFF.
#include "app/explain.h"
#include "app/plot.h"

namespace raio::core::app {

// plot_format() and check_drawing() have refused before.
std::expected<std::string, std::string> draw_plot(const BenchmarkTable&, PlotFormat) {
  return std::unexpected(check_drawing().error());
}

std::expected<std::string, std::string> draw_explained(const Explained&, PlotFormat) {
  return std::unexpected(check_drawing().error());
}

}  // namespace raio::core::app
