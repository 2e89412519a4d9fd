#include "app/color_bar.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/srgb.h"

namespace raio::app {
namespace {

constexpr double kPageWidth = 640, kPageHeight = 130;
constexpr double kLeft = 40, kRight = 600, kTop = 46, kBottom = 82;
constexpr double kLabelWidth = 75;
constexpr int kTicks = 6;  // about so many

// 1, 2 or 5 times a power of ten, so that there are about so many steps in a length.
double round_step(double length) {
  const double step = length / kTicks, power = std::pow(10, std::floor(std::log10(step)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= step * 0.999) return digit * power;
  return 10 * power;
}

struct Tick {
  std::string text;
  double part;  // of the scale, 0 to 1
};

std::vector<Tick> ticks_of(const ColorScale& scale) {
  const auto text = [&](double value) { return scale_text(scale, value); };
  const double length = scale.most - scale.least;
  if (length == 0) return {{text(scale.least), 0}};
  std::vector<Tick> ticks;
  const double low = std::min(scale.least, scale.most), high = std::max(scale.least, scale.most);
  const double step = round_step(high - low);
  const double first = std::ceil(low / step - 1e-9);
  // Counted, since a large number plus one may be itself.
  for (int i = 0; i <= 2 * kTicks; ++i)
    if (const double value = (first + i) * step; value <= high + 1e-9 * step)
      ticks.push_back({text(value), (value - scale.least) / length});
  return ticks;
}

Ink map_ink(const ColorScale& scale, int i) {
  const Rgb c = map_color(scale.map, float(i) / (kMapColors - 1)).value_or(Rgb());
  const auto display = [](float x) { return int(to_byte(srgb_from_linear(x))); };
  return {display(c.x), display(c.y), display(c.z)};
}

// Of an upright bar, in pixels.
struct Layout {
  double text, margin, width, height, top, tick;
  double edge;  // the outer one of all
  bool left;

  Layout(const Image& image, bool at_left) : left(at_left) {
    const double w = image.width, h = image.height, size = std::min(h, 0.75 * w);
    text = std::max(0.032 * size, 7.0), margin = 0.045 * size, tick = 0.4 * text;
    width = 0.035 * size, height = 0.45 * h;
    top = (h - height) / 2 + 0.5 * text;
    edge = left ? margin : w - margin;
  }
};

// Where the bar is, with its name and numbers.
PixelBox place_of(const Image& image, const Layout& at) {
  const int wide =
      std::clamp(int(0.4 * image.width + at.width + at.margin + 2 * at.text), 1, image.width);
  const int top = std::clamp(int(at.top - 3 * at.text), 0, image.height - 1);
  const int bottom = std::clamp(int(at.top + at.height + 2 * at.text), top + 1, image.height);
  return {at.left ? 0 : image.width - wide, top, wide, bottom - top};
}

// The middle of what the picture shows at its edge there, as it is displayed; where it is clear, on
// white.
Ink page_of(const Picture& picture, const PixelBox& box, bool left, bool linear) {
  const Image& image = picture.color;
  const int wide = std::max(1, box.width / 3), begin = left ? 0 : image.width - wide;
  std::array<std::vector<float>, 3> values;
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = begin; x < begin + wide; ++x) {
      const size_t i = size_t(y) * size_t(image.width) + size_t(x);
      const float clear = picture.alpha.empty() ? 0 : 1 - picture.alpha[i];
      for (int c = 0; c < 3; ++c) values[size_t(c)].push_back(image.pixels[i][c] + clear);
    }
  const auto middle = [&](std::vector<float>& v) {
    const auto half = v.begin() + std::ssize(v) / 2;
    std::ranges::nth_element(v, half);
    return int(to_byte(linear ? srgb_from_linear(*half) : *half));
  };
  return {middle(values[0]), middle(values[1]), middle(values[2])};
}

void draw_upright(const Canvas& canvas, const ColorScale& scale, const Layout& at, Ink ink,
                  Ink page, double widest) {
  const std::vector<Tick> ticks = ticks_of(scale);
  double labels = 0;
  for (const Tick& tick : ticks) labels = std::max(labels, canvas.text_width(tick.text, at.text));
  labels = std::min(labels, widest);
  const double x = at.left ? at.edge : at.edge - labels - 2 * at.tick - at.width;
  const double line = std::max(1.0, at.text / 16), bottom = at.top + at.height;
  canvas.box(x - line, at.top - line, at.width + 2 * line, at.height + 2 * line, ink);
  for (int i = kMapColors; i-- > 0;)
    // To the lower end, so that no gap shows between two of them.
    canvas.box(x, bottom - at.height * (i + 1) / kMapColors, at.width,
               at.height * (i + 1) / kMapColors, map_ink(scale, i));
  for (const Tick& tick : ticks) {
    const double y = bottom - tick.part * at.height;
    canvas.line(x + at.width, y, x + at.width + at.tick, y, ink, line);
    canvas.rimmed_text(x + at.width + 2 * at.tick, y, tick.text, ink, page, Align::left, at.text,
                       labels);
  }
  canvas.rimmed_text(at.edge, at.top - 1.5 * at.text, valid_utf8(scale.name), ink, page,
                     at.left ? Align::left : Align::right, 1.1 * at.text, widest);
}

}  // namespace

std::expected<void, Error> draw_color_bar_on(Picture& picture, const ColorScale& scale, bool left,
                                             bool linear) {
  Image& image = picture.color;
  const Layout at(image, left);
  const PixelBox box = place_of(image, at);
  const Ink page = page_of(picture, box, left, linear);
  const bool dark = 0.299 * page.r + 0.587 * page.g + 0.114 * page.b < 128;
  const auto pixels = draw_pixels(
      [&](const Canvas& canvas) {
        draw_upright(canvas, scale, at, dark ? kWhite : kBlack, page, 0.4 * image.width);
      },
      box);
  if (!pixels) return std::unexpected(Error{ErrorKind::no_resource, "", pixels.error()});
  for (size_t k = 0; k < pixels->size(); ++k) {
    const uint32_t pixel = (*pixels)[k];
    const size_t row = size_t(box.y) + k / size_t(box.width);
    const size_t i = row * size_t(image.width) + size_t(box.x) + k % size_t(box.width);
    const float covered = float(pixel >> 24) / 255;
    if (covered == 0) continue;
    const auto part = [&](int shift) {
      const float value = float(pixel >> shift & 0xff) / 255;
      return linear ? linear_from_srgb(value / covered) * covered : value;
    };
    image.pixels[i] = Rgb(part(16), part(8), part(0)) + image.pixels[i] * (1 - covered);
    if (!picture.alpha.empty()) picture.alpha[i] = covered + picture.alpha[i] * (1 - covered);
  }
  return {};
}

std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format) {
  const auto draw = [&](const Canvas& canvas) {
    canvas.text((kLeft + kRight) / 2, 22, valid_utf8(scale.name), kBlack, Align::center, 22, true,
                kRight - kLeft);
    const double width = (kRight - kLeft) / kMapColors;
    for (int i = 0; i < kMapColors; ++i)
      // To the right end, so that no gap shows between two of them.
      canvas.box(kLeft + i * width, kTop, kRight - kLeft - i * width, kBottom - kTop,
                 map_ink(scale, i));
    for (const Tick& tick : ticks_of(scale)) {
      const double at = kLeft + tick.part * (kRight - kLeft);
      canvas.line(at, kBottom, at, kBottom + 7, kBlack, 1.5);
      canvas.text(at, kBottom + 22, tick.text, kBlack, Align::center, kText, false, kLabelWidth);
    }
  };
  return draw_page(format, draw, kPageWidth, kPageHeight);
}

}  // namespace raio::app
