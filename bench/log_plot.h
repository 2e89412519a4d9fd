// Lines between logarithmic axes: what grows or falls as a power is straight there.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "app/canvas.h"

namespace raio::bench {

struct LogLine {
  std::string name;
  app::Ink ink;
  bool dotted;
  std::vector<std::pair<double, double>> points;
};

/// A frame on the page, in its pixels, with lines in it. The axes go over whole decades.
struct LogPlot {
  double left, right, top, bottom;
  std::string title, x_title;
  std::string (*y_label)(double);
  std::vector<LogLine> lines;
};

void draw_log_plot(const app::Canvas& canvas, const LogPlot& plot);

/// Names beside their inks, one below the other from (x, y) on; returns where the next would be.
double draw_legend(const app::Canvas& canvas, double x, double y,
                   const std::vector<LogLine>& lines);

/// A page with what `draw` puts on it, to a file: .png, .svg or .pdf.
void write_page(const std::string& path, const std::function<void(const app::Canvas&)>& draw);

}  // namespace raio::bench
