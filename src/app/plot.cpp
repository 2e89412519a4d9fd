#include "app/plot.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

namespace raio::app {

namespace {

constexpr double kWidth = 1600, kHeight = 1000;
constexpr double kBarsLeft = 500, kBarsRight = 1540, kBarsTop = 222, kBarsBottom = 880;
constexpr double kGroupGap = 26;  // between the bars of the two structures
constexpr double kText = 19;      // size of most text
constexpr double kLabelGap = 10, kMarkerRadius = 10;

struct Ink {
  int r, g, b;  // 0..255
};

// Okabe and Ito's palette, whose colours remain distinct to colour-blind eyes; the two blues also
// differ in lightness, so that a print in grey works.
constexpr Ink kBlack{26, 26, 31}, kGrey{107, 107, 115}, kFaint{224, 224, 230};
constexpr Ink kWithout{86, 180, 233}, kGrid{0, 114, 178}, kReport{213, 94, 0};
constexpr Ink kWhite{255, 255, 255};

enum class Align { left, center, right };

std::string seconds_label(double s) {
  return s < 1 ? three_digits(s * 1000) + " ms" : three_digits(s) + " s";
}

std::string tick_label(double s) {
  return s < 0.999e-3 ? fmt::format("{:g} µs", s * 1e6)
         : s < 0.999  ? fmt::format("{:g} ms", s * 1000)
                      : fmt::format("{:g} s", s);
}

// Cairo refuses text that is no UTF-8, which a file's name need not be.
std::string valid_utf8(const std::string& text) {
  using nlohmann::json;
  const auto replace = json::error_handler_t::replace;
  return json::parse(json(text).dump(-1, ' ', false, replace)).get<std::string>();
}

// Cairo with the few strokes that the plot is made of.
class Canvas {
 public:
  explicit Canvas(cairo_t* cairo) : cairo_(cairo) {
    // Unhinted widths grow in step with the size, in the picture as in the vector formats.
    const std::unique_ptr<cairo_font_options_t, void (*)(cairo_font_options_t*)> options(
        cairo_font_options_create(), cairo_font_options_destroy);
    cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
    cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
    cairo_set_font_options(cairo_, options.get());
  }

  double text_width(const std::string& text, double size, bool bold = false) const {
    set_font(size, bold);
    cairo_text_extents_t extents;
    cairo_text_extents(cairo_, text.c_str(), &extents);
    return extents.x_advance;
  }

  // `y` is the middle of the small letters' height. Text wider than `max_width` is set smaller.
  void text(double x, double y, const std::string& text, Ink ink, Align align = Align::left,
            double size = kText, bool bold = false, double max_width = kWidth) const {
    const double width = text_width(text, size, bold);
    if (width > max_width) size *= max_width / width;
    const double shown = std::min(width, max_width);
    const double shift = align == Align::left ? 0 : align == Align::center ? shown / 2 : shown;
    set_font(size, bold);
    set(ink);
    cairo_move_to(cairo_, x - shift, y + 0.36 * size);
    cairo_show_text(cairo_, text.c_str());
  }

  void upright_text(double x, double y, const std::string& words, Ink ink) const {
    cairo_save(cairo_);
    cairo_translate(cairo_, x, y);
    cairo_rotate(cairo_, -std::numbers::pi / 2);
    text(0, 0, words, ink, Align::center, 24, true);
    cairo_restore(cairo_);
  }

  void box(double x, double y, double w, double h, Ink ink) const {
    set(ink);
    cairo_rectangle(cairo_, x, y, w, h);
    cairo_fill(cairo_);
  }

  void line(double x0, double y0, double x1, double y1, Ink ink, double width,
            bool dotted = false) const {
    set(ink);
    cairo_set_line_width(cairo_, width);
    const double dash[] = {1, 6};
    cairo_set_line_cap(cairo_, dotted ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
    cairo_set_dash(cairo_, dash, dotted ? 2 : 0, 0);
    cairo_move_to(cairo_, x0, y0);
    cairo_line_to(cairo_, x1, y1);
    cairo_stroke(cairo_);
  }

  void disc(double x, double y, double radius, Ink ink) const {
    set(ink);
    cairo_new_sub_path(cairo_);
    cairo_arc(cairo_, x, y, radius, 0, 2 * std::numbers::pi);
    cairo_fill(cairo_);
  }

  // A diamond with a white rim, which keeps it apart from a bar below it.
  void diamond(double x, double y, Ink ink) const {
    for (const auto& [radius, fill] :
         {std::pair(kMarkerRadius + 3, kWhite), std::pair(kMarkerRadius, ink)}) {
      set(fill);
      cairo_move_to(cairo_, x - radius, y);
      cairo_line_to(cairo_, x, y - radius);
      cairo_line_to(cairo_, x + radius, y);
      cairo_line_to(cairo_, x, y + radius);
      cairo_close_path(cairo_);
      cairo_fill(cairo_);
    }
  }

 private:
  void set(Ink ink) const {
    cairo_set_source_rgb(cairo_, ink.r / 255.0, ink.g / 255.0, ink.b / 255.0);
  }
  void set_font(double size, bool bold) const {
    cairo_select_font_face(cairo_, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo_, size);
  }

  cairo_t* cairo_;
};

// Seconds to pixels, logarithmic.
struct Axis {
  double lo = 1, decades = 1;  // lo: at kBarsLeft

  double pixels_per_decade() const { return (kBarsRight - kBarsLeft) / decades; }
  double x(double seconds) const {
    return kBarsLeft + std::log10(seconds / lo) * pixels_per_decade();
  }
  double hi() const { return lo * std::pow(10, decades); }
};

std::string report_label(const BenchRow& row) {
  // The report's seconds as it gives them, without digits of our own.
  return fmt::format("{:g} s, Raio {}× as fast", *row.report_s, three_digits(*row.speedup()));
}

// Is the report's marker far enough right of the bar for our label to stand between them?
bool marker_is_clear(const Canvas& canvas, const Axis& axis, const BenchRow& row) {
  const double ours = canvas.text_width(seconds_label(row.seconds()), kText);
  return axis.x(*row.report_s) - kMarkerRadius > axis.x(row.seconds()) + ours + 2 * kLabelGap;
}

// From the decade below the shortest time to where the widest label still fits beside its bar.
Axis fit_axis(const BenchTable& table, const Canvas& canvas) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const BenchRow& row : table.rows)
    shortest = std::min({shortest, row.seconds(), row.report_s.value_or(row.seconds())});
  Axis axis{.lo = std::pow(10, std::floor(std::log10(0.8 * shortest))),
            .decades = std::numeric_limits<double>::infinity()};
  // Where labels stand depends on the scale. The first round takes the worst case; the wider scale
  // that the second finds only moves markers further from their bars.
  for (int round = 0; round < 2; ++round) {
    double decades = 1;
    for (const BenchRow& row : table.rows) {
      const double longest = std::max(row.seconds(), row.report_s.value_or(0));
      double labels = kLabelGap;
      if (!row.report_s || !marker_is_clear(canvas, axis, row))
        labels += kLabelGap + canvas.text_width(seconds_label(row.seconds()), kText);
      if (row.report_s)
        labels += 3 * kLabelGap + kMarkerRadius + canvas.text_width(report_label(row), kText, true);
      const double room = kBarsRight - kBarsLeft;
      decades = std::max(decades, std::log10(longest / axis.lo) * room / (room - labels));
    }
    axis.decades = decades;
  }
  return axis;
}

void draw_axis(const Canvas& canvas, const Axis& axis) {
  // With few decades there is room to name the 2s and 5s as well.
  const bool name_all = axis.pixels_per_decade() > 420;
  for (double decade = axis.lo; decade <= axis.hi() * 1.001; decade *= 10) {
    for (int digit = 1; digit <= 9; ++digit) {
      const double seconds = decade * digit, x = axis.x(seconds);
      if (x > kBarsRight + 0.5) break;
      const bool named = digit == 1 || (name_all && (digit == 2 || digit == 5));
      canvas.line(x, kBarsTop - 10, x, kBarsBottom + (named ? 8 : 0), kFaint, named ? 2 : 0.6);
      if (named) canvas.text(x, kBarsBottom + 24, tick_label(seconds), kGrey, Align::center);
    }
  }
  canvas.text((kBarsLeft + kBarsRight) / 2, kBarsBottom + 56,
              "rendering time, logarithmic: shorter is better", kGrey, Align::center);
}

// The columns left of the bars, as wide as their headings.
constexpr std::array<double, 4> kColumns = {130, 228, 326, 430};

void draw_headings(const Canvas& canvas) {
  constexpr std::array<std::array<const char*, 2>, 4> kHeadings = {
      {{"anti-", "aliasing"}, {"soft", "shadows"}, {"depth", "of field"}, {"samples", "a pixel"}}};
  for (size_t i = 0; i < kColumns.size(); ++i)
    for (size_t line = 0; line < 2; ++line)
      canvas.text(kColumns[i], kBarsTop - 48 + 22 * double(line), kHeadings[i][line], kGrey,
                  Align::center, 17);
}

void draw_row(const Canvas& canvas, const Axis& axis, const BenchRow& row, double y,
              double height) {
  const Combination& c = row.combination;
  const bool grid = c.accel == AccelKind::grid;
  const std::array<bool, 3> effects = {c.aa, c.soft_shadows, c.dof};
  for (size_t i = 0; i < effects.size(); ++i)
    canvas.disc(kColumns[i], y, effects[i] ? 8 : 3, effects[i] ? kBlack : kFaint);
  canvas.text(kColumns[3] + 14, y, fmt::format("{}", samples_per_pixel(c)), kBlack, Align::right);

  const double end = axis.x(row.seconds());
  canvas.box(kBarsLeft, y - 0.36 * height, end - kBarsLeft, 0.72 * height, grid ? kGrid : kWithout);

  // Labels stand on white, over the lines of the axis.
  const auto label = [&](double x, const std::string& text, Ink color, bool bold) {
    const double width = canvas.text_width(text, kText, bold);
    canvas.box(x - 4, y - 0.6 * kText, width + 8, 1.2 * kText, kWhite);
    canvas.text(x, y, text, color, Align::left, kText, bold);
    return x + width;
  };
  const std::string ours = seconds_label(row.seconds());
  if (!row.report_s) {
    label(end + kLabelGap, ours, kBlack, false);
    return;
  }
  const double marker = axis.x(*row.report_s);
  const double ours_width = canvas.text_width(ours, kText), ours_end = end + kLabelGap + ours_width;
  double report_at = marker + kMarkerRadius + kLabelGap;
  if (marker_is_clear(canvas, axis, row)) {
    label(end + kLabelGap, ours, kBlack, false);
    if (marker - kMarkerRadius > ours_end + 3 * kLabelGap)
      canvas.line(ours_end + kLabelGap, y, marker - kMarkerRadius - 6, y, kReport, 2.5, true);
  } else if (marker > end + kMarkerRadius && end - kBarsLeft > ours_width + 2 * kLabelGap) {
    // The marker stands where the label would: the label goes into the bar.
    canvas.text(end - kLabelGap, y, ours, grid ? kWhite : kBlack, Align::right);
  } else {
    // The marker is on the bar: both labels come after both.
    const double x = std::max(end, marker + kMarkerRadius) + kLabelGap;
    report_at = label(x, ours, kBlack, false) + 2 * kLabelGap;
  }
  label(report_at, report_label(row), kReport, true);
  canvas.diamond(marker, y, kReport);
}

void draw_rows(const Canvas& canvas, const Axis& axis, const BenchTable& table) {
  const double height = (kBarsBottom - kBarsTop - kGroupGap) / double(table.rows.size());
  double y = kBarsTop, group_top = kBarsTop;
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const AccelKind accel = table.rows[i].combination.accel;
    draw_row(canvas, axis, table.rows[i], y + height / 2, height);
    y += height;
    if (i + 1 < table.rows.size() && table.rows[i + 1].combination.accel == accel) continue;
    const bool grid = accel == AccelKind::grid;
    const Ink ink = grid ? kGrid : kWithout;
    canvas.box(64, group_top + 4, 4, y - group_top - 8, ink);
    canvas.upright_text(40, (group_top + y) / 2, grid ? "with grid" : "without grid", kBlack);
    y += kGroupGap;
    group_top = y;
  }
  canvas.line(kBarsLeft, kBarsTop - 10, kBarsLeft, kBarsBottom, kGrey, 2);
}

void draw_legend(const Canvas& canvas, const BenchTable& table) {
  constexpr double kY = 150;
  double x = kBarsLeft;
  const auto entry = [&](const std::string& text) {
    canvas.text(x + 34, kY, text, kBlack);
    x += 34 + canvas.text_width(text, kText) + 44;
  };
  canvas.box(x, kY - 10, 24, 20, kWithout);
  entry("without grid");
  canvas.box(x, kY - 10, 24, 20, kGrid);
  entry("with grid");
  if (std::ranges::none_of(table.rows, [](const BenchRow& r) { return r.report_s.has_value(); }))
    return;
  canvas.diamond(x + 12, kY, kReport);
  entry("technical report of 2018, on its own machine");
}

void draw(const Canvas& canvas, const BenchTable& table) {
  canvas.box(0, 0, kWidth, kHeight, kWhite);
  const double room = kBarsRight - 40;
  canvas.text(40, 52,
              fmt::format("{}, {} × {} pixels", valid_utf8(table.scene), table.width, table.height),
              kBlack, Align::left, 38, true, room);
  canvas.text(
      40, 100,
      fmt::format("Time of sixteen combinations of structure and effects, {} levels of rays",
                  table.depth),
      kGrey, Align::left, 22, false, room);
  const Axis axis = fit_axis(table, canvas);
  draw_legend(canvas, table);
  draw_headings(canvas);
  draw_axis(canvas, axis);
  draw_rows(canvas, axis, table);
  canvas.text(
      40, 972,
      fmt::format("Raio {} · {} · {} thread{} · {}", table.version, valid_utf8(table.machine),
                  table.threads, table.threads == 1 ? "" : "s",
                  table.repeat > 1 ? fmt::format("median of {} runs", table.repeat) : "one run"),
      kGrey, Align::left, 17, false, room);
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int size) {
  try {
    static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), size);
    return CAIRO_STATUS_SUCCESS;
  } catch (const std::bad_alloc&) {
    return CAIRO_STATUS_NO_MEMORY;
  }
}

cairo_surface_t* make_surface(PlotFormat format, std::string& bytes) {
  switch (format) {
    case PlotFormat::png:
      return cairo_image_surface_create(CAIRO_FORMAT_RGB24, int(kWidth), int(kHeight));
    case PlotFormat::svg: {
      auto* surface = cairo_svg_surface_create_for_stream(append, &bytes, kWidth, kHeight);
      cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
      return surface;
    }
    case PlotFormat::pdf:
      return cairo_pdf_surface_create_for_stream(append, &bytes, kWidth, kHeight);
  }
  return nullptr;
}

}  // namespace

std::expected<PlotFormat, std::string> plot_format(const std::filesystem::path& path) {
  std::string suffix = path.extension().string();
  for (char& c : suffix)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  if (suffix == ".png") return PlotFormat::png;
  if (suffix == ".svg") return PlotFormat::svg;
  if (suffix == ".pdf") return PlotFormat::pdf;
  return std::unexpected(
      fmt::format("{}: a plot's file ends in .png, .svg or .pdf", path.string()));
}

std::expected<std::string, std::string> draw_plot(const BenchTable& table, PlotFormat format) {
  std::string bytes;  // outlives the surface, which may write to it until it is finished
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      make_surface(format, bytes), cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()),
                                                           cairo_destroy);
  draw(Canvas(cairo.get()), table);
  cairo_status_t status = cairo_status(cairo.get());
  if (status == CAIRO_STATUS_SUCCESS && format == PlotFormat::png)
    status = cairo_surface_write_to_png_stream(surface.get(), append, &bytes);
  cairo_surface_finish(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface.get());
  if (status == CAIRO_STATUS_SUCCESS) return bytes;
  return std::unexpected(fmt::format("cannot draw the plot: {}", cairo_status_to_string(status)));
}

}  // namespace raio::app
