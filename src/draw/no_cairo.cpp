// Replaces annotations.cpp and canvas.cpp in builds with RAIO_PLOTS=OFF.
#include "draw/annotations.h"

namespace raio::core {
namespace {

constexpr const char* kNoPlots = "this build draws no plots; use one with RAIO_PLOTS=ON";

}  // namespace

std::expected<PlotFormat, std::string> plot_format(const std::filesystem::path&) {
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

}  // namespace raio::core
