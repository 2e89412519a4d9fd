// Replaces the sources that draw (annotations.cpp, canvas.cpp, plot.cpp, explain_plot.cpp) in
// builds with RAIO_PLOTS=OFF.
#include "app/annotations.h"
#include "app/explain.h"
#include "app/plot.h"

namespace raio::core::app {
namespace {

constexpr const char* kNoPlots = "this build draws no plots; use one with RAIO_PLOTS=ON";

}  // namespace

std::expected<PlotFormat, std::string> plot_format(const std::filesystem::path&) {
  return std::unexpected(kNoPlots);
}

std::expected<std::string, std::string> draw_plot(const BenchmarkTable&, PlotFormat) {
  return std::unexpected(kNoPlots);
}

std::expected<std::string, std::string> draw_color_bar(const ColorScale&, PlotFormat) {
  return std::unexpected(kNoPlots);
}

std::expected<void, std::string> check_drawing() { return std::unexpected(kNoPlots); }

std::expected<void, Error> draw_color_bar_on(Picture&, const ColorScale&, bool, bool) {
  return std::unexpected(Error{ErrorKind::no_resource, "", kNoPlots});
}

std::expected<void, Error> draw_legend_on(Picture&, std::span<const LegendEntry>, bool, bool) {
  return std::unexpected(Error{ErrorKind::no_resource, "", kNoPlots});
}

bool has_room_for_legend(int, int, float) { return true; }

std::expected<void, Error> draw_scale_bar_on(Picture&, double, std::string_view, bool) {
  return std::unexpected(Error{ErrorKind::no_resource, "", kNoPlots});
}

std::expected<std::string, std::string> draw_explained(const Explained&, PlotFormat) {
  return std::unexpected(kNoPlots);
}

}  // namespace raio::core::app
