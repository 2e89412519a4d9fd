#include "app/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "app/bench.h"
#include "app/bench_report.h"
#include "base/exact_math.h"

namespace raio::core::app {

namespace {

constexpr double kRowsTop = 222, kRowsBottom = 880;
constexpr double kGroupGap = 26;   // between the rows of two structures
constexpr double kMaxHeight = 44;  // of a row, if there are few
constexpr double kLabelGap = 10;

// From left to right: dots for the effects, samples, bars of seconds, dots of costs, their numbers.
constexpr double kEffectsLeft = 84, kEffectsRight = 318, kSamplesRight = 392;
constexpr double kBarsLeft = 430, kBarsRight = 1020;
constexpr double kCostsLeft = 1090, kCostsRight = 1370;
constexpr double kReportCostRight = 1468, kOurCostRight = 1560;

constexpr Ink kReport = kVermilion;

struct Structure {
  std::string_view name;
  Ink bar, on_bar;  // on_bar: of text on the bar
};

Structure structure_of(AccelKind kind) {
  switch (kind) {
    case AccelKind::none:
      return {"without grid", kSkyBlue, kBlack};
    case AccelKind::grid:
      return {"with grid", kBlue, kWhite};
    case AccelKind::embree:
      return {"Embree", kPurple, kBlack};
    default:
      return {"Raio's tree", kGreen, kWhite};
  }
}

// Maps values to pixels, logarithmically.
struct Axis {
  double left, right;
  double lo = 1, decades = 1;  // lo: at `left`

  double pixels_per_decade() const { return (right - left) / decades; }
  double x(double value) const { return left + exact_log10(value / lo) * pixels_per_decade(); }
  double hi() const { return lo * exact_pow(10, decades); }

  /// Lines at all digits of all decades, over the height of the rows. Lines with a label from
  /// `name` are longer.
  template <class Name>
  void draw(const Canvas& canvas, Name name) const {
    for (double decade = exact_pow(10, std::floor(exact_log10(lo))); decade <= hi() * 1.001;
         decade *= 10) {
      for (int digit = 1; digit <= 9; ++digit) {
        const double at = x(decade * digit);
        if (at < left - 0.5 || at > right + 0.5) continue;
        const std::string text = name(decade * digit, digit);
        const bool named = !text.empty();
        canvas.line(at, kRowsTop - 10, at, kRowsBottom + (named ? 8 : 0), kFaint, named ? 2 : 0.6);
        canvas.text(at, kRowsBottom + 24, text, kGrey, Align::center);
      }
    }
  }
};

class Plot {
 public:
  Plot(const Canvas& canvas, const BenchmarkTable& table) : canvas_(canvas), table_(table) {
    for (const BenchmarkRow& row : table.rows) {
      const bool another =
          &row == &table.rows.front() || row.combination.accel != (&row)[-1].combination.accel;
      if (another) groups_.push_back(row.combination.accel);
    }
    const double gaps = double(groups_.size() - 1) * kGroupGap;
    height_ = std::min(kMaxHeight, (kRowsBottom - kRowsTop - gaps) / double(table.rows.size()));
    text_ = std::min(kText, 0.8 * height_);
    marker_ = std::min(kMarkerRadius, 0.42 * height_);
    fit_seconds();
    fit_costs();
  }

  void draw() const {
    draw_titles();
    draw_legend();
    draw_headings();
    draw_axes();
    draw_rows();
  }

 private:
  std::optional<ReportTime> report_of(const BenchmarkRow& row) const {
    return report_time(table_, row);
  }
  static std::string ours_label(const BenchmarkRow& row) {
    return seconds_label(row.seconds().median);
  }
  double width_of(const std::string& text, bool bold = false) const {
    return canvas_.text_width(text, text_, bold);
  }

  // Whether the report's marker is far enough right of the bar for our label between them.
  bool marker_is_clear(const BenchmarkRow& row, const ReportTime& report) const {
    return seconds_.x(report.seconds) - marker_ >
           seconds_.x(row.seconds().median) + width_of(ours_label(row)) + 2 * kLabelGap;
  }

  // From the decade below the shortest time to where the widest label still fits right of its bar.
  void fit_seconds() {
    double shortest = std::numeric_limits<double>::infinity();
    for (const BenchmarkRow& row : table_.rows) shortest = std::min(shortest, row.seconds().median);
    seconds_.lo = exact_pow(10, std::floor(exact_log10(0.8 * shortest)));
    seconds_.decades = std::numeric_limits<double>::infinity();
    // The positions of labels depend on the scale. The first round assumes the worst case; the
    // wider scale found by the second only moves markers further from their bars.
    for (int round = 0; round < 2; ++round) {
      double decades = 1;
      for (const BenchmarkRow& row : table_.rows) {
        const auto report = report_of(row);
        const double longest = std::max(row.seconds().median, report ? report->seconds : 0);
        double labels = kLabelGap;
        if (!report || !marker_is_clear(row, *report))
          labels += kLabelGap + width_of(ours_label(row));
        if (report) labels += 3 * kLabelGap + marker_ + width_of(report->text() + " s", true);
        const double room = kBarsRight - kBarsLeft;
        decades = std::max(decades, exact_log10(longest / seconds_.lo) * room / (room - labels));
      }
      seconds_.decades = decades;
    }
  }

  void fit_costs() {
    double least = 1, most = 1;
    for (const BenchmarkRow& row : table_.rows) {
      const Spread ours = table_.relative_cost(row);
      least = std::min(least, ours.least);
      most = std::max({most, ours.most, report_cost(table_, row).value_or(1)});
    }
    costs_.lo = 0.9 * least;
    costs_.decades = exact_log10(std::max(1.15 * most, 2.5) / costs_.lo);
  }

  void draw_titles() const {
    const double room = kOurCostRight - 40;
    canvas_.text(
        40, 52,
        fmt::format("{}, {} × {} pixels", valid_utf8(table_.scene), table_.width, table_.height),
        kBlack, Align::left, 38, true, room);
    canvas_.text(40, 100,
                 fmt::format("Times of all combinations of structure and effects, and costs of "
                             "effects; ray depth {}",
                             table_.depth),
                 kGrey, Align::left, 22, false, room);
    const std::string runs = table_.repeat > 1 ? fmt::format("median of {} runs", table_.repeat)
                                               : std::string("one run");
    canvas_.text(
        40, 972,
        fmt::format("Raio {} · {} · {} thread{} · {}", table_.version, valid_utf8(table_.machine),
                    table_.threads, table_.threads == 1 ? "" : "s", runs),
        kGrey, Align::left, 17, false, room);
  }

  void draw_legend() const {
    constexpr double kY = 148;
    double x = kBarsLeft;
    const auto entry = [&](const std::string& text) {
      canvas_.text(x + 34, kY, text, kBlack);
      x += 34 + canvas_.text_width(text, kText) + 40;
    };
    for (const AccelKind kind : groups_) {
      const Structure structure = structure_of(kind);
      canvas_.box(x, kY - 10, 24, 20, structure.bar);
      entry(std::string(structure.name));
    }
    if (!report_knows(table_)) return;
    canvas_.diamond(x + 12, kY, kReport);
    entry("technical report of 2018, on its own machine");
  }

  // The position of the dots of the n-th combined effect, and the width of its column.
  std::pair<double, double> effect_column(size_t n) const {
    const double width = (kEffectsRight - kEffectsLeft) / std::popcount(table_.effects);
    return {kEffectsLeft + (double(n) + 0.5) * width, width};
  }

  void draw_headings() const {
    constexpr double kSize = 17, kTop = kRowsTop - 48, kLine = 22;
    for (size_t i = 0, n = 0; i < kBenchmarkEffects.size(); ++i) {
      if (!(table_.effects >> i & 1)) continue;
      const auto [x, width] = effect_column(n++);
      for (size_t line = 0; line < 2; ++line)
        canvas_.text(x, kTop + kLine * double(line),
                     std::string(kBenchmarkEffects[i].heading[line]), kGrey, Align::center, kSize,
                     false, width - 6);
    }
    canvas_.text(kSamplesRight, kTop, "samples", kGrey, Align::right, kSize);
    canvas_.text(kSamplesRight, kTop + kLine, "per pixel", kGrey, Align::right, kSize);
    canvas_.text(kOurCostRight, kTop + kLine, "Raio", kGrey, Align::right, kSize);
    if (report_knows(table_))
      canvas_.text(kReportCostRight, kTop + kLine, "report", kReport, Align::right, kSize);
  }

  void draw_axes() const {
    // With few decades there is room to label the 2s and 5s as well.
    const bool name_all = seconds_.pixels_per_decade() > 420;
    seconds_.draw(canvas_, [&](double value, int digit) {
      const bool named = digit == 1 || (name_all && (digit == 2 || digit == 5));
      return named ? tick_label(value) : std::string();
    });
    costs_.draw(canvas_, [&](double value, int digit) {
      const bool named = digit == 1 || digit == 2 || digit == 5;
      return named ? fmt::format("{:g}", value) : std::string();
    });
    const auto caption = [&](const Axis& axis, const char* text) {
      canvas_.text((axis.left + axis.right) / 2, kRowsBottom + 56, text, kGrey, Align::center);
    };
    caption(seconds_, "rendering time, logarithmic: shorter is better");
    caption(costs_, "cost: time relative to no effects");
  }

  void draw_effects(const BenchmarkRow& row, double y) const {
    const EffectSet on = row.combination.effects;
    for (size_t i = 0, n = 0; i < kBenchmarkEffects.size(); ++i) {
      if (!(table_.effects >> i & 1)) continue;
      const bool is_on = on >> i & 1;
      canvas_.disc(effect_column(n++).first, y, is_on ? 0.8 * marker_ : 3, is_on ? kBlack : kFaint);
    }
    canvas_.text(kSamplesRight - 6, y, fmt::format("{}", samples_per_pixel(on)), kBlack,
                 Align::right, text_);
  }

  // On white, over the lines of the axis; returns its end.
  double label(double x, double y, const std::string& text, Ink color, bool bold) const {
    const double width = width_of(text, bold);
    canvas_.box(x - 4, y - 0.6 * text_, width + 8, 1.2 * text_, kWhite);
    canvas_.text(x, y, text, color, Align::left, text_, bold);
    return x + width;
  }

  void draw_seconds(const BenchmarkRow& row, double y) const {
    const Structure structure = structure_of(row.combination.accel);
    const double end = seconds_.x(row.seconds().median);
    canvas_.box(kBarsLeft, y - 0.36 * height_, end - kBarsLeft, 0.72 * height_, structure.bar);
    const std::string ours = ours_label(row);
    const auto report = report_of(row);
    if (!report) {
      label(end + kLabelGap, y, ours, kBlack, false);
      return;
    }
    const double marker = seconds_.x(report->seconds);
    const double ours_end = end + kLabelGap + width_of(ours);
    double report_at = marker + marker_ + kLabelGap;
    if (marker_is_clear(row, *report)) {
      label(end + kLabelGap, y, ours, kBlack, false);
      if (marker - marker_ > ours_end + 3 * kLabelGap)
        canvas_.line(ours_end + kLabelGap, y, marker - marker_ - 6, y, kReport, 2.5, true);
    } else if (marker > end + marker_ && end - kBarsLeft > width_of(ours) + 2 * kLabelGap) {
      // The marker is where the label would be: the label goes into the bar.
      canvas_.text(end - kLabelGap, y, ours, structure.on_bar, Align::right, text_);
    } else {
      // The marker is on the bar: both labels come after both.
      const double x = std::max(end, marker + marker_) + kLabelGap;
      report_at = label(x, y, ours, kBlack, false) + 2 * kLabelGap;
    }
    label(report_at, y, report->text() + " s", kReport, true);
    canvas_.diamond(marker, y, kReport, marker_);
  }

  // Ours as a dot with its spread; the report's joined to it by a line.
  void draw_cost(const BenchmarkRow& row, double y) const {
    const Ink ink = structure_of(row.combination.accel).bar;
    const Spread ours = table_.relative_cost(row);
    const double x = costs_.x(ours.median);
    const auto number = [&](double right, double cost, Ink color, bool bold) {
      canvas_.text(right, y, three_digits(cost) + "×", color, Align::right, text_, bold);
    };
    number(kOurCostRight, ours.median, kBlack, false);
    const auto report = report_cost(table_, row);
    if (report) {
      canvas_.line(x, y, costs_.x(*report), y, kReport, 2.5);
      canvas_.diamond(costs_.x(*report), y, kReport, marker_);
      number(kReportCostRight, *report, kReport, true);
    }
    canvas_.line(costs_.x(ours.least), y, costs_.x(ours.most), y, ink, 3);
    canvas_.disc(x, y, 0.7 * marker_, ink);
  }

  void draw_rows() const {
    double y = kRowsTop, group_top = kRowsTop;
    for (size_t i = 0; i < table_.rows.size(); ++i) {
      const BenchmarkRow& row = table_.rows[i];
      const double middle = y + height_ / 2;
      draw_effects(row, middle);
      draw_seconds(row, middle);
      draw_cost(row, middle);
      y += height_;
      const AccelKind accel = row.combination.accel;
      if (i + 1 < table_.rows.size() && table_.rows[i + 1].combination.accel == accel) continue;
      const Structure structure = structure_of(accel);
      canvas_.box(64, group_top + 4, 4, y - group_top - 8, structure.bar);
      if (const double room = y - group_top; room > 150)
        canvas_.upright_text(40, (group_top + y) / 2, std::string(structure.name), kBlack);
      y += kGroupGap;
      group_top = y;
    }
    canvas_.line(kBarsLeft, kRowsTop - 10, kBarsLeft, kRowsBottom, kGrey, 2);
    canvas_.line(costs_.x(1), kRowsTop - 10, costs_.x(1), kRowsBottom, kGrey, 2);
  }

  const Canvas& canvas_;
  const BenchmarkTable& table_;
  std::vector<AccelKind> groups_;              // the structures
  double height_ = 0, text_ = 0, marker_ = 0;  // of a row, its letters, its markers
  Axis seconds_{kBarsLeft, kBarsRight}, costs_{kCostsLeft, kCostsRight};
};

}  // namespace

std::expected<std::string, std::string> draw_plot(const BenchmarkTable& table, PlotFormat format) {
  return draw_page(format, [&](const Canvas& canvas) { Plot(canvas, table).draw(); });
}

}  // namespace raio::core::app
