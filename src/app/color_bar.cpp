#include "app/color_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/srgb.h"

namespace raio::app {
namespace {

constexpr double kPageWidth = 640, kPageHeight = 130;
constexpr double kLeft = 40, kRight = 600, kTop = 46, kBottom = 82;
constexpr int kTicks = 6;  // about so many

// 1, 2 or 5 times a power of ten, so that there are about so many steps in a length.
double round_step(double length) {
  const double step = length / kTicks, power = std::pow(10, std::floor(std::log10(step)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= step * 0.999) return digit * power;
  return 10 * power;
}

}  // namespace

std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format) {
  const auto draw = [&](const Canvas& canvas) {
    canvas.text((kLeft + kRight) / 2, 22, valid_utf8(scale.name), kBlack, Align::center, 22, true,
                kRight - kLeft);
    const double width = (kRight - kLeft) / kMapColors;
    for (int i = 0; i < kMapColors; ++i) {
      const Rgb c = map_color(scale.map, float(i) / (kMapColors - 1)).value_or(Rgb());
      const auto display = [](float x) { return int(to_byte(srgb_from_linear(x))); };
      // To the right end, so that no gap shows between two of them.
      canvas.box(kLeft + i * width, kTop, kRight - kLeft - i * width, kBottom - kTop,
                 {display(c.x), display(c.y), display(c.z)});
    }
    const double length = scale.most - scale.least;
    const auto tick = [&](double value, double at) {
      canvas.line(at, kBottom, at, kBottom + 7, kBlack, 1.5);
      // The sum makes 0 of -0.
      canvas.text(at, kBottom + 22, fmt::format("{:.6g}", value + 0.0), kBlack, Align::center);
    };
    if (length == 0) return tick(scale.least, kLeft);
    const double low = std::min(scale.least, scale.most), high = std::max(scale.least, scale.most);
    const double step = round_step(high - low);
    const double first = std::ceil(low / step - 1e-9);
    // Counted, since a large number plus one may be itself.
    for (int i = 0; i <= 2 * kTicks; ++i) {
      const double value = (first + i) * step;
      if (value <= high + 1e-9 * step)
        tick(value, kLeft + (value - scale.least) / length * (kRight - kLeft));
    }
  };
  return draw_page(format, draw, kPageWidth, kPageHeight);
}

}  // namespace raio::app
