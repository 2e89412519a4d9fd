#include "app/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace raio::app {

namespace {

constexpr double kBarsLeft = 500, kBarsRight = 1540, kBarsTop = 222, kBarsBottom = 880;
constexpr double kGroupGap = 26;  // between the bars of two structures
constexpr double kLabelGap = 10;

constexpr Ink kReport = kVermilion;

struct Structure {
  std::string_view name;
  Ink bar, on_bar;  // on_bar: of what is written there
};

Structure structure_of(AccelKind kind) {
  switch (kind) {
    case AccelKind::none:
      return {"without grid", kSkyBlue, kBlack};
    case AccelKind::grid:
      return {"with grid", kBlue, kWhite};
    default:
      return {"Raio's tree", kGreen, kWhite};
  }
}

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
  const Structure structure = structure_of(c.accel);
  const std::array<bool, 3> effects = {c.aa, c.soft_shadows, c.dof};
  for (size_t i = 0; i < effects.size(); ++i)
    canvas.disc(kColumns[i], y, effects[i] ? 8 : 3, effects[i] ? kBlack : kFaint);
  canvas.text(kColumns[3] + 14, y, fmt::format("{}", samples_per_pixel(c)), kBlack, Align::right);

  const double end = axis.x(row.seconds());
  canvas.box(kBarsLeft, y - 0.36 * height, end - kBarsLeft, 0.72 * height, structure.bar);

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
    canvas.text(end - kLabelGap, y, ours, structure.on_bar, Align::right);
  } else {
    // The marker is on the bar: both labels come after both.
    const double x = std::max(end, marker + kMarkerRadius) + kLabelGap;
    report_at = label(x, ours, kBlack, false) + 2 * kLabelGap;
  }
  label(report_at, report_label(row), kReport, true);
  canvas.diamond(marker, y, kReport);
}

void draw_rows(const Canvas& canvas, const Axis& axis, const BenchTable& table) {
  const double height = (kBarsBottom - kBarsTop - (kBenchStructures.size() - 1) * kGroupGap) /
                        double(table.rows.size());
  double y = kBarsTop, group_top = kBarsTop;
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const AccelKind accel = table.rows[i].combination.accel;
    draw_row(canvas, axis, table.rows[i], y + height / 2, height);
    y += height;
    if (i + 1 < table.rows.size() && table.rows[i + 1].combination.accel == accel) continue;
    const Structure structure = structure_of(accel);
    canvas.box(64, group_top + 4, 4, y - group_top - 8, structure.bar);
    canvas.upright_text(40, (group_top + y) / 2, std::string(structure.name), kBlack);
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
  for (const AccelKind kind : kBenchStructures) {
    const Structure structure = structure_of(kind);
    canvas.box(x, kY - 10, 24, 20, structure.bar);
    entry(std::string(structure.name));
  }
  if (std::ranges::none_of(table.rows, [](const BenchRow& r) { return r.report_s.has_value(); }))
    return;
  canvas.diamond(x + 12, kY, kReport);
  entry("technical report of 2018, on its own machine");
}

void draw(const Canvas& canvas, const BenchTable& table) {
  const double room = kBarsRight - 40;
  canvas.text(40, 52,
              fmt::format("{}, {} × {} pixels", valid_utf8(table.scene), table.width, table.height),
              kBlack, Align::left, 38, true, room);
  canvas.text(40, 100,
              fmt::format("Time of all combinations of structure and effects, {} levels of rays",
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

}  // namespace

std::expected<std::string, std::string> draw_plot(const BenchTable& table, PlotFormat format) {
  return draw_page(format, [&](const Canvas& canvas) { draw(canvas, table); });
}

}  // namespace raio::app
