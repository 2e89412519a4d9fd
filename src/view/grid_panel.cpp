#include "view/grid_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "app/terminal.h"
#include "base/exact_math.h"
#include "view/options_panel.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

using app::human_seconds;

struct Line {
  const char* name;  // with the unit
  ImVec4 ink;
  double (*value)(const GridPoint&);  // 0: unknown
};

// Both axes are logarithmic. The names of the lines are above them.
class Plot {
 public:
  Plot(const GridCurve& curve, std::vector<Line> lines, float height_in_ems)
      : curve_(curve), lines_(std::move(lines)) {
    lo_ = ImGui::GetCursorScreenPos();
    top_ = lo_.y + 0.2f * em() + float(lines_.size()) * ImGui::GetFontSize();
    hi_ = {lo_.x + ImGui::GetContentRegionAvail().x, top_ + height_in_ems * em()};
    for (const GridPoint& p : curve.points)
      for (const Line& line : lines_)
        if (const double v = line.value(p); v > 0)
          least_ = std::min(least_, v), most_ = std::max(most_, v);
    if (!(most_ > 0)) least_ = 1, most_ = 10;
    least_ /= 1.15, most_ *= 1.15;
  }

  void draw(double factor) const {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const Palette& p = palette();
    draw.AddRectFilled(lo_, hi_, color(p.raised, 0.5f), 0.2f * em());
    for (const auto& [at, ink] :
         {std::pair(double(kReportGridFactor), p.faint), {factor, p.accent}})
      if (at > 0) draw.AddLine({x(at), top_}, {x(at), hi_.y}, color(ink), 0.12f * em());
    float label_y = lo_.y + 0.2f * em();
    for (const Line& line : lines_) {
      draw_line(draw, line);
      const float width = ImGui::CalcTextSize(line.name).x;
      draw.AddText({hi_.x - width - 0.4f * em(), label_y}, color(line.ink), line.name);
      label_y += ImGui::GetFontSize();
    }
    ImGui::Dummy({hi_.x - lo_.x, hi_.y - lo_.y});
  }

  // The point under the cursor, or null.
  const GridPoint* hovered() const {
    if (!ImGui::IsItemHovered()) return nullptr;
    const GridPoint* best = nullptr;
    const float at = ImGui::GetMousePos().x;
    for (const GridPoint& p : curve_.points)
      if (!best || std::abs(x(p.factor) - at) < std::abs(x(best->factor) - at)) best = &p;
    return best;
  }

 private:
  float x(double factor) const {
    const double part =
        exact_log(std::clamp(factor, double(kMinGridFactor), double(kMaxGridFactor)) /
                  kMinGridFactor) /
        exact_log(double(kMaxGridFactor) / kMinGridFactor);
    return lo_.x + (0.04f + 0.92f * float(part)) * (hi_.x - lo_.x);
  }
  float y(double value) const {
    return hi_.y - float(exact_log(value / least_) / exact_log(most_ / least_)) * (hi_.y - top_);
  }
  void draw_line(ImDrawList& draw, const Line& line) const {
    const GridPoint* before = nullptr;
    for (const GridPoint& p : curve_.points) {
      if (!(line.value(p) > 0)) continue;
      const ImVec2 at(x(p.factor), y(line.value(p)));
      if (before)
        draw.AddLine({x(before->factor), y(line.value(*before))}, at, color(line.ink),
                     0.14f * em());
      draw.AddCircleFilled(at, 0.2f * em(), color(line.ink));
      before = &p;
    }
  }

  const GridCurve& curve_;
  std::vector<Line> lines_;
  ImVec2 lo_, hi_;
  float top_ = 0;  // of the lines' area
  double least_ = std::numeric_limits<double>::infinity(), most_ = 0;
};

std::string cells_text(const GridPoint& p) {
  return fmt::format("{} x {} x {}", p.resolution[0], p.resolution[1], p.resolution[2]);
}

void draw_tooltip(const GridPoint& p) {
  ImGui::BeginTooltip();
  text(trf("factor {:.3g}: {} cells", p.factor, cells_text(p)));
  if (p.rounds > 0)
    text(fmt::format("{} ({} - {})", human_seconds(p.seconds.median), human_seconds(p.seconds.low),
                     human_seconds(p.seconds.high)));
  text(trf("{:.3g} tests, {:.3g} steps per ray", p.tests, p.steps));
  const std::string bytes = app::human_bytes(double(p.bytes)), time = human_seconds(p.build_s);
  text(trf("{}, built in {}", bytes, time));
  ImGui::EndTooltip();
}

// Marks the minimum, and the report's factor.
void draw_words(const GridCurve& curve) {
  const GridPoint* const best = curve.fastest();
  if (!best) return;
  const std::string seconds = human_seconds(best->seconds.median);
  text(trf("minimum: {} at factor {:.3g}", seconds, best->factor));
  const double report = curve.seconds_at(kReportGridFactor);
  if (report > 0)
    text(trf("the report's factor 2: {:.3g} times as long", report / best->seconds.median));
}

}  // namespace

GridPanelResult draw_grid(ViewState& state, const CostFacts& facts) {
  GridPanelResult result;
  const bool is_grid = state.options.accel.kind == AccelKind::grid;
  float factor = state.options.accel.grid_factor;
  const std::string in_use = shown_value(option_of("grid-factor"), state, facts);
  ImGui::BeginDisabled(!is_grid);
  ImGui::PushItemWidth(9 * em());
  if (ImGui::SliderFloat(tr("cells per side: factor"), &factor, kMinGridFactor, kMaxGridFactor,
                         factor > 0 ? "%.3g" : in_use.c_str(),
                         ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
    state.options.accel.grid_factor = factor, state.options.accel.grid_resolution = {};
    result.changed = true;
  }
  ImGui::PopItemWidth();
  ImGui::EndDisabled();
  if (!is_grid) faint_text(tr("g switches to the grid"));
  if (facts.measuring == Measuring::Work::curve) {
    text(fmt::format("{}: {}; {}", tr("measuring"), text_of_progress(facts.progress),
                     tr("n stops")));
  } else {
    result.measures = ImGui::Button(tr("Measure (n)"));
    ImGui::SameLine();
    ImGui::BeginDisabled(facts.curve.points.empty());
    result.saves = ImGui::Button("CSV");
    ImGui::EndDisabled();
  }
  if (facts.curve.points.empty()) return result;
  const Palette& p = palette();
  const Plot time(facts.curve,
                  {{tr("seconds"), p.warning,
                    [](const GridPoint& g) { return g.rounds > 0 ? g.seconds.median : 0; }}},
                  6);
  time.draw(is_grid ? factor : 0);
  const GridPoint* hovered = time.hovered();
  const Plot counts(facts.curve,
                    {{tr("tests per ray"), p.good, [](const GridPoint& g) { return g.tests; }},
                     {tr("steps per ray"), p.busy, [](const GridPoint& g) { return g.steps; }}},
                    6);
  counts.draw(is_grid ? factor : 0);
  if (!hovered) hovered = counts.hovered();
  if (hovered) draw_tooltip(*hovered);
  faint_text(tr("factor 0.25 to 8; grey line: 2, as in the report"));
  draw_words(facts.curve);
  if (facts.is_curve_old && facts.measuring != Measuring::Work::curve)
    faint_text(tr("from before the last change"));
  return result;
}

}  // namespace raio::core::view
