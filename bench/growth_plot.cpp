// Time against the number of primitives, both logarithmic, as a picture.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/canvas.h"
#include "bench/suites.h"
#include "io/file.h"

namespace raio::bench {
namespace {

using namespace app;

constexpr double kLeft = 130, kRight = 1300, kTop = 130, kBottom = 900;

// Whole decades to pixels.
struct LogAxis {
  double from, to;  // pixels
  double least = std::numeric_limits<double>::infinity(), most = 0;

  void include(double value) {
    least = std::min(least, std::pow(10, std::floor(std::log10(value))));
    most = std::max(most, std::pow(10, std::ceil(std::log10(value))));
  }
  double operator()(double value) const {
    return from + (to - from) * std::log10(value / least) / std::log10(most / least);
  }
};

struct Line {
  std::string name;
  Ink ink;
  bool dotted;
  std::vector<std::pair<double, double>> points;  // primitives, seconds
};

std::vector<Line> lines_of(const std::vector<Json>& rows) {
  constexpr Ink kInks[] = {kVermilion, kBlue, kSkyBlue, kBlack};
  std::vector<Line> lines;
  for (const auto& [key, verb] : {std::pair("median_s", "render"), std::pair("build_s", "build")})
    for (const Json& row : rows) {
      const std::string structure = row["structure"], name = structure + ", " + verb;
      auto line = std::ranges::find(lines, name, &Line::name);
      if (line == lines.end()) {
        const bool build = key[0] == 'b';
        const size_t others = size_t(std::ranges::count(lines, build, &Line::dotted));
        lines.push_back({name, kInks[others % std::size(kInks)], build, {}});
        line = lines.end() - 1;
      }
      line->points.emplace_back(row["primitives"], row[key]);
    }
  return lines;
}

void draw_axes(const Canvas& canvas, const LogAxis& x, const LogAxis& y) {
  for (double n = x.least; n < 1.01 * x.most; n *= 10) {
    canvas.line(x(n), kTop, x(n), kBottom, kFaint, 2);
    canvas.text(x(n), kBottom + 26, fmt::format("{:g}", n), kGrey, Align::center);
  }
  for (double s = y.least; s < 1.01 * y.most; s *= 10) {
    canvas.line(kLeft, y(s), kRight, y(s), kFaint, 2);
    canvas.text(kLeft - 14, y(s), tick_label(s), kGrey, Align::right);
  }
  canvas.text((kLeft + kRight) / 2, kBottom + 62, "primitives", kGrey, Align::center);
}

void draw_line(const Canvas& canvas, const Line& line, const LogAxis& x, const LogAxis& y) {
  for (size_t i = 0; i < line.points.size(); ++i) {
    const auto [n, s] = line.points[i];
    canvas.disc(x(n), y(s), 6, line.ink);
    if (i == 0) continue;
    const auto [n0, s0] = line.points[i - 1];
    canvas.line(x(n0), y(s0), x(n), y(s), line.ink, 3, line.dotted);
  }
}

}  // namespace

void plot_growth(const std::vector<Json>& rows, const std::string& path) {
  const std::vector<Line> lines = lines_of(rows);
  LogAxis x{kLeft, kRight}, y{kBottom, kTop};
  for (const Line& line : lines)
    for (const auto& [n, s] : line.points) x.include(n), y.include(s);
  const auto page = draw_page(*plot_format(path), [&](const Canvas& canvas) {
    canvas.text(40, 60, "Time against the number of primitives", kBlack, Align::left, 38, true);
    draw_axes(canvas, x, y);
    double legend = kTop + 20;
    for (const Line& line : lines) {
      draw_line(canvas, line, x, y);
      canvas.line(kRight + 30, legend, kRight + 80, legend, line.ink, 3, line.dotted);
      canvas.text(kRight + 94, legend, line.name, kBlack);
      legend += 36;
    }
  });
  if (!page) give_up(3, page.error());
  if (const auto written = write_file(path, *page); !written) give_up(3, written.error().message);
}

}  // namespace raio::bench
