// Lines between logarithmic axes: power laws are straight.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "draw/canvas.h"

namespace raio::core::bench {

struct LogLine {
  std::string name;
  Ink ink;
  bool dotted;
  std::vector<std::pair<double, double>> points;
};

/// A frame on the page, in its pixels, with lines in it. The axes span whole decades.
struct LogPlot {
  double left, right, top, bottom;
  std::string title, x_title;
  std::string (*y_label)(double);
  std::vector<LogLine> lines;
};

void draw_log_plot(const Canvas& canvas, const LogPlot& plot);

/// Names next to their inks, one below the other from (x, y); returns the next position.
double draw_legend(const Canvas& canvas, double x, double y, const std::vector<LogLine>& lines);

/// Writes a page with the result of `draw` to a file: .png, .svg or .pdf.
void write_page(const std::string& path, const std::function<void(const Canvas&)>& draw);

}  // namespace raio::core::bench
