#include "bench/log_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/suites.h"
#include "io/file.h"

namespace raio::core::bench {
namespace {

using namespace app;

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

void draw_line(const Canvas& canvas, const LogLine& line, const LogAxis& x, const LogAxis& y) {
  for (size_t i = 0; i < line.points.size(); ++i) {
    const auto [n, s] = line.points[i];
    canvas.disc(x(n), y(s), 6, line.ink);
    if (i == 0) continue;
    const auto [n0, s0] = line.points[i - 1];
    canvas.line(x(n0), y(s0), x(n), y(s), line.ink, 3, line.dotted);
  }
}

}  // namespace

void draw_log_plot(const Canvas& canvas, const LogPlot& p) {
  LogAxis x{p.left, p.right}, y{p.bottom, p.top};
  for (const LogLine& line : p.lines)
    for (const auto& [n, s] : line.points) x.include(n), y.include(s);
  for (double n = x.least; n < 1.01 * x.most; n *= 10) {
    canvas.line(x(n), p.top, x(n), p.bottom, kFaint, 2);
    canvas.text(x(n), p.bottom + 26, fmt::format("{:g}", n), kGrey, Align::center);
  }
  for (double s = y.least; s < 1.01 * y.most; s *= 10) {
    canvas.line(p.left, y(s), p.right, y(s), kFaint, 2);
    canvas.text(p.left - 14, y(s), p.y_label(s), kGrey, Align::right);
  }
  const double middle = (p.left + p.right) / 2;
  canvas.text(middle, p.bottom + 56, p.x_title, kGrey, Align::center);
  canvas.text(middle, p.top - 22, p.title, kBlack, Align::center, 22, true);
  for (const LogLine& line : p.lines) draw_line(canvas, line, x, y);
}

double draw_legend(const Canvas& canvas, double x, double y, const std::vector<LogLine>& lines) {
  for (const LogLine& line : lines) {
    canvas.line(x, y, x + 50, y, line.ink, 3, line.dotted);
    canvas.text(x + 64, y, line.name, kBlack);
    y += 36;
  }
  return y;
}

void write_page(const std::string& path, const std::function<void(const Canvas&)>& draw) {
  const auto page = draw_page(*plot_format(path), draw);
  if (!page) give_up(3, page.error());
  if (const auto written = write_file(path, *page); !written) give_up(3, written.error().text());
}

}  // namespace raio::core::bench
