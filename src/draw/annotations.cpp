#include "draw/annotations.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "base/exact_math.h"
#include "base/srgb.h"

namespace raio::core {
namespace {

constexpr double kBarWidth = 640, kBarHeight = 130;
constexpr double kLeft = 40, kRight = 600, kTop = 46, kBottom = 82;
constexpr double kLabelWidth = 75;
constexpr int kTicks = 6;  // approximate number

// The round step, 1, 2 or 5 times a power of ten, that divides a length into about kTicks parts.
double round_step(double length) {
  const double step = length / kTicks, power = exact_pow(10, std::floor(exact_log10(step)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= step * 0.999) return digit * power;
  return 10 * power;
}

// The largest such number that does not exceed a length.
double round_length(double longest) {
  const double power = exact_pow(10, std::floor(exact_log10(longest)));
  for (const double digit : {5.0, 2.0})
    if (digit * power <= longest * 1.001) return digit * power;
  return power;
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
  // Counted, since a large number plus one may equal itself.
  for (int i = 0; i <= 2 * kTicks; ++i)
    if (const double value = (first + i) * step; value <= high + 1e-9 * step)
      ticks.push_back({text(value), (value - scale.least) / length});
  return ticks;
}

Ink ink_of(Rgb linear) {
  const auto display = [](float x) { return int(to_byte(srgb_from_linear(x))); };
  return {display(linear.x), display(linear.y), display(linear.z)};
}

// Sizes of all annotations, in pixels.
struct Measures {
  double text, margin, line;

  explicit Measures(const Picture& picture)
      : Measures(picture.color.width, picture.color.height, picture.dpi) {}
  Measures(int width, int height, float dpi) {
    constexpr double kPoints = 7, kPointsPerInch = 72;
    const double size = std::min<double>(height, 0.75 * width);
    text = dpi > 0 ? kPoints / kPointsPerInch * double(dpi) : std::max(0.032 * size, 7.0);
    margin = 0.045 * size;
    line = std::max(1.0, text / 16);
  }
};

// For a vertical colour bar.
struct Layout : Measures {
  double width, height, top, tick;
  double edge;  // outermost
  bool left;

  Layout(const Picture& picture, bool at_left) : Measures(picture), left(at_left) {
    const double w = picture.color.width, h = picture.color.height;
    tick = 0.4 * text, width = 1.1 * text, height = 0.45 * h;
    top = (h - height) / 2 + 0.5 * text;
    edge = left ? margin : w - margin;
  }
};

// The position of the bar with its name and numbers.
PixelBox place_of(const Image& image, const Layout& at) {
  const int wide =
      std::clamp(int(0.4 * image.width + at.width + at.margin + 2 * at.text), 1, image.width);
  const int top = std::clamp(int(at.top - 3 * at.text), 0, image.height - 1);
  const int bottom = std::clamp(int(at.top + at.height + 2 * at.text), top + 1, image.height);
  return {at.left ? 0 : image.width - wide, top, wide, bottom - top};
}

// The middle colour of the picture's edge there, as displayed; transparent parts are on white.
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

// Draws on a box of the picture with an ink that contrasts with the page there.
std::expected<void, Error> draw_on(
    Picture& picture, const PixelBox& box, bool left, bool linear,
    const std::function<void(const Canvas&, Ink ink, Ink page)>& draw) {
  Image& image = picture.color;
  const Ink page = page_of(picture, box, left, linear);
  const bool dark = 0.299 * page.r + 0.587 * page.g + 0.114 * page.b < 128;
  const auto pixels =
      draw_pixels([&](const Canvas& canvas) { draw(canvas, dark ? kWhite : kBlack, page); }, box);
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

void draw_upright(const Canvas& canvas, const ColorScale& scale, const Layout& at, Ink ink,
                  Ink page, double widest) {
  const std::vector<Tick> ticks = ticks_of(scale);
  double labels = 0;
  for (const Tick& tick : ticks) labels = std::max(labels, canvas.text_width(tick.text, at.text));
  labels = std::min(labels, widest);
  const double x = at.left ? at.edge : at.edge - labels - 2 * at.tick - at.width;
  const double bottom = at.top + at.height;
  canvas.box(x - at.line, at.top - at.line, at.width + 2 * at.line, at.height + 2 * at.line, ink);
  for (int i = kMapColors; i-- > 0;)
    // To the lower end, so that no gap is visible between two of them.
    canvas.box(x, bottom - at.height * (i + 1) / kMapColors, at.width,
               at.height * (i + 1) / kMapColors, ink_of(scale_color(scale, i)));
  for (const Tick& tick : ticks) {
    const double y = bottom - tick.part * at.height;
    canvas.line(x + at.width, y, x + at.width + at.tick, y, ink, at.line);
    canvas.rimmed_text(x + at.width + 2 * at.tick, y, tick.text, ink, page, Align::left, at.text,
                       labels);
  }
  canvas.rimmed_text(at.edge, at.top - 1.5 * at.text, valid_utf8(scale.name), ink, page,
                     at.left ? Align::left : Align::right, 1.1 * at.text, widest);
}

}  // namespace

std::expected<void, Error> draw_color_bar_on(Picture& picture, const ColorScale& scale, bool left,
                                             bool linear) {
  const Layout at(picture, left);
  return draw_on(picture, place_of(picture.color, at), left, linear,
                 [&](const Canvas& canvas, Ink ink, Ink page) {
                   draw_upright(canvas, scale, at, ink, page, 0.4 * picture.color.width);
                 });
}

// Heights relative to the text: of a line of the legend, and of the disc in front of the name with
// its gap.
constexpr double kLegendRow = 1.5, kLegendIndent = 2.5;

bool has_room_for_legend(int width, int height, float dpi) {
  constexpr double kLetters = 3;  // of about half a height each, to which "chain" would shrink
  const Measures at(width, height, dpi);
  return 0.3 * width >= (kLegendIndent + kLetters) * at.text &&
         height - 2 * at.margin >= 2 * kLegendRow * at.text;
}

std::expected<void, Error> draw_legend_on(Picture& picture, std::span<const LegendEntry> entries,
                                          bool left, bool linear) {
  const Measures at(picture);
  const double row = kLegendRow * at.text, radius = 0.42 * at.text;
  const int width = picture.color.width, height = picture.color.height;
  const auto room = size_t(std::max(1.0, (height - 2 * at.margin) / row));
  const size_t rows = std::min(room, entries.size());
  const int wide = std::clamp(int(0.3 * width + at.margin), 1, width);
  const PixelBox box{left ? 0 : width - wide, 0, wide,
                     std::clamp(int(at.margin + row * (double(rows) + 0.5)), 1, height)};
  return draw_on(picture, box, left, linear, [&](const Canvas& canvas, Ink ink, Ink page) {
    const double widest = wide - at.margin - kLegendIndent * at.text;
    std::vector<std::string> names;
    double longest = 0;
    for (size_t i = 0; i < rows; ++i) {
      const bool is_cut = i + 1 == rows && rows < entries.size();
      names.push_back(is_cut ? fmt::format("and {} more", entries.size() - i)
                             : valid_utf8(entries[i].name));
      longest = std::max(longest, canvas.text_width(names.back(), at.text));
    }
    const double x =
        left ? at.margin : width - at.margin - std::min(longest, widest) - 1.6 * at.text;
    for (size_t i = 0; i < rows; ++i) {
      const double y = at.margin + row * (double(i) + 0.5);
      if (i + 1 < rows || rows == entries.size()) {
        canvas.disc(x + radius, y, radius + at.line, ink);
        canvas.disc(x + radius, y, radius, ink_of(entries[i].color));
      }
      canvas.rimmed_text(x + 1.6 * at.text, y, names[i], ink, page, Align::left, at.text, widest);
    }
  });
}

std::expected<void, Error> draw_scale_bar_on(Picture& picture, double pixels_per_unit,
                                             std::string_view unit, bool linear) {
  const Measures at(picture);
  const int width = picture.color.width, height = picture.color.height;
  const double length = round_length(0.25 * width / pixels_per_unit);
  const double pixels = length * pixels_per_unit, thick = std::max(2.0, at.text / 5);
  const std::string text = fmt::format("{:g}{}{}", length, unit.empty() ? "" : " ", unit);
  const int wide = std::clamp(int(0.5 * width), 1, width);
  const int top = std::clamp(int(height - at.margin - 3 * at.text), 0, height - 1);
  return draw_on(picture, {0, top, wide, height - top}, true, linear,
                 [&](const Canvas& canvas, Ink ink, Ink page) {
                   const double y = height - at.margin;
                   canvas.box(at.margin - at.line, y - thick - at.line, pixels + 2 * at.line,
                              thick + 2 * at.line, page);
                   canvas.box(at.margin, y - thick, pixels, thick, ink);
                   canvas.rimmed_text(at.margin + pixels / 2, y - thick - 0.9 * at.text, text, ink,
                                      page, Align::center, at.text, wide - at.margin);
                 });
}

std::expected<std::string, std::string> draw_color_bar(const ColorScale& scale, PlotFormat format) {
  const auto draw = [&](const Canvas& canvas) {
    canvas.text((kLeft + kRight) / 2, 22, valid_utf8(scale.name), kBlack, Align::center, 22, true,
                kRight - kLeft);
    const double width = (kRight - kLeft) / kMapColors;
    for (int i = 0; i < kMapColors; ++i)
      // To the right end, so that no gap is visible between two of them.
      canvas.box(kLeft + i * width, kTop, kRight - kLeft - i * width, kBottom - kTop,
                 ink_of(scale_color(scale, i)));
    for (const Tick& tick : ticks_of(scale)) {
      const double at = kLeft + tick.part * (kRight - kLeft);
      canvas.line(at, kBottom, at, kBottom + 7, kBlack, 1.5);
      canvas.text(at, kBottom + 22, tick.text, kBlack, Align::center, kText, false, kLabelWidth);
    }
  };
  return draw_page(format, draw, kBarWidth, kBarHeight);
}

}  // namespace raio::core
