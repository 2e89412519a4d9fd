// Plots time against the number of primitives, both logarithmic.

#include <algorithm>

#include "app/bench.h"
#include "bench/log_plot.h"
#include "bench/suites.h"

namespace raio::core::bench {
namespace {

std::vector<LogLine> lines_of(const std::vector<Json>& rows) {
  using namespace app;
  constexpr Ink kInks[] = {kVermilion, kBlue, kSkyBlue, kBlack};
  std::vector<LogLine> lines;
  for (const auto& [key, verb] : {std::pair("median_s", "render"), std::pair("build_s", "build")})
    for (const Json& row : rows) {
      const std::string structure = row["structure"], name = structure + ", " + verb;
      auto line = std::ranges::find(lines, name, &LogLine::name);
      if (line == lines.end()) {
        const bool build = key[0] == 'b';
        const size_t others = size_t(std::ranges::count(lines, build, &LogLine::dotted));
        lines.push_back({name, kInks[others % std::size(kInks)], build, {}});
        line = lines.end() - 1;
      }
      line->points.emplace_back(row["primitives"], row[key]);
    }
  return lines;
}

}  // namespace

void plot_growth(const std::vector<Json>& rows, const std::string& path) {
  write_page(path, [&](const Canvas& canvas) {
    canvas.text(40, 60, "Time against the number of primitives", kBlack, Align::left, 38, true);
    const LogPlot plot{130, 1300, 130, 900, "", "primitives", app::tick_label, lines_of(rows)};
    draw_log_plot(canvas, plot);
    draw_legend(canvas, plot.right + 30, plot.top + 20, plot.lines);
  });
}

}  // namespace raio::core::bench
