#include "view/costs_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/bench.h"
#include "app/terminal.h"
#include "base/memory.h"
#include "view/comparison.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

using app::human_bytes;
using app::human_seconds;

const KeySpec& key_of(Effect effect) {
  return *std::ranges::find(key_table(), command_of(effect), &KeySpec::command);
}

// "34 %, 12 s left"
std::string text_of_progress(double done, double left_s) {
  const std::string percent = fmt::format("{:.0f} %", 100 * done);
  return left_s < 0.05
             ? percent
             : trf("{}, {} s left", percent, fmt::format("{:.{}f}", left_s, left_s < 9.95 ? 1 : 0));
}

// Half of the interval of a factor that says nothing, relative to the median.
constexpr double kTooNoisy = 0.25;

// "1.83 x", for counts that may be 0.
std::string times(double with, double without) {
  return without > 0 ? app::three_digits(with / without) + " x" : app::human_count(with);
}

// "rays 1.75 x, tests 1.9 x, steps 1.6 x"
std::string count_line(const EffectCost& c) {
  const auto counts = [&](const char* what, auto count) {
    return fmt::format("{} {}", tr(what),
                       times(double(count(c.with.rays)), double(count(c.without.rays))));
  };
  std::string line = counts("rays", [](const RayCounts& r) { return r.total(); });
  if (!c.with.has_steps || !c.without.has_steps) return line;
  line += ", " + counts("tests", [](const RayCounts& r) { return r.tests; });
  if (c.effect != Effect::structure)
    line += ", " + counts("steps", [](const RayCounts& r) { return r.steps; });
  return line;
}

std::string factor_text(const EffectCost& c) {
  const std::string number = app::three_digits(c.factor.median);
  return c.effect == Effect::structure ? trf("{} x faster", number) : number + " x";
}

std::string range_text(const EffectCost& c) {
  return trf("{} to {} x", app::three_digits(c.factor.low), app::three_digits(c.factor.high));
}

std::string absence(EffectCost::Presence presence) {
  switch (presence) {
    case EffectCost::not_in_scene:
      return tr("not in this scene");
    case EffectCost::too_slow:
      return tr("too slow without one to measure");
    default:
      return tr("not in this picture");
  }
}

std::string seconds_line(const EffectCost& c) {
  const std::string with = human_seconds(c.with.seconds),
                    without = human_seconds(c.without.seconds);
  return trf("{}, without {}", with, without);
}

// All counts, and how they were measured.
std::string details(const EffectCost& c) {
  const auto side = [](const char* name, const EffectCost::Side& s) {
    const uint64_t rays = s.rays.total();
    std::string line = fmt::format("{}: {}", name, trf("{} rays", rays));
    if (s.has_steps) line += ", " + trf("{} tests, {} steps", s.rays.tests, s.rays.steps);
    return line;
  };
  return fmt::format("{}\n{}\n{}\n{}", side(tr("with it"), c.with), side(tr("without"), c.without),
                     trf("counted on {} pixels; median of {} rounds,", c.pixels, c.rounds),
                     trf("in nine of ten cases {}", range_text(c)));
}

}  // namespace

std::string progress_line(const SessionProgress& p) {
  if (p.stage == SessionProgress::structure)
    return trf("building the structure: {:.0f} s", p.passed_s);
  const std::string progress = text_of_progress(p.share, p.left_s);
  return trf("first sample: {}", progress);
}

std::string text_of_progress(const MeasuringProgress& p) {
  return text_of_progress(p.done, p.left_s);
}

std::string cost_line(const EffectCost& c) {
  const std::string_view name = tr(key_of(c.effect).help);
  if (c.presence != EffectCost::in_picture) return fmt::format("{}: {}", name, absence(c.presence));
  return fmt::format("{}: {}{}; {}; {}", name, factor_text(c), text_of_spread(c.factor),
                     seconds_line(c), count_line(c));
}

void draw_statistics(const CostFacts& facts) {
  if (facts.waits) text(*facts.waits);
  if (!facts.picture || !facts.picture->baked) return;
  const SessionPicture& picture = *facts.picture;
  const BakedScene& baked = *picture.baked;
  const Image& image = *picture.image;
  text(trf("{} x {} pixels", facts.picture_width, facts.picture_height) +
       (image.width == facts.picture_width ? "" : trf(", now {} x {}", image.width, image.height)));
  text(picture.samples == 0
           ? tr("preview")
           : number_of(size_t(picture.samples), "sample per pixel", "samples per pixel") +
                 (picture.finished ? tr(", done") : ""));
  // Previews have no figures.
  const double sample_s = picture.samples > 0 ? picture.sample_s.median : 0;
  if (sample_s > 0) {
    const std::string time = text_of_seconds(picture.sample_s);
    text(trf("{} per sample of all pixels", time));
    const RayCounts& rays = picture.rays;
    const double seconds = sample_s * picture.samples;
    const auto rate = [&](uint64_t count) {
      return app::human_quantity(double(count) / seconds, tr("rays/s"));
    };
    text(rate(rays.total()));
    for (const auto& [name, count] : {std::pair(tr("eye"), rays.eye),
                                      {tr("reflected"), rays.reflection},
                                      {tr("refracted"), rays.refraction},
                                      {tr("shadow"), rays.shadow}}) {
      if (count == 0) continue;
      const std::string per_second = rate(count);
      const double per_eye_ray = double(count) / double(std::max<uint64_t>(1, rays.eye));
      text("    " + trf("{}: {}, {:.2f} per eye ray", name, per_second, per_eye_ray));
    }
  } else {
    faint_text(tr("waiting for a whole sample"));
  }
  const std::string bytes = human_bytes(double(baked.info.bytes)),
                    time = human_seconds(baked.build_s),
                    of_scene = human_bytes(double(memory_bytes(*baked.scene))),
                    of_program = human_bytes(double(peak_memory_bytes()));
  text(trf("{}: {}, built in {}", baked.info.name, bytes, time));
  text(trf("scene {}, program {}", of_scene, of_program));
}

// Two bars per effect: the time with it, and below, thinner, without it.
void draw_costs(const CostFacts& facts, CostOf& of) {
  const auto name_of = [](CostOf what) {
    return what == CostOf::sample ? tr("of one sample of this picture")
                                  : tr("of a picture as the 2018 report counts");
  };
  ImGui::SetNextItemWidth(-em());
  if (ImGui::BeginCombo("##costs", name_of(of))) {
    for (const CostOf what : {CostOf::sample, CostOf::report})
      if (ImGui::Selectable(name_of(what), of == what)) of = what;
    ImGui::EndCombo();
  }
  const bool measures = facts.measuring == Measuring::Work::costs;
  if (measures)
    text(fmt::format("{}: {}", tr("measuring"), text_of_progress(facts.progress)));
  else if (facts.are_old)
    faint_text(facts.costs.effects.empty() ? tr("measured when idle")
                                           : tr("from before the last change; measured when idle"));
  // All effects share a scale. The structure has its own, since a picture without one takes far
  // longer.
  const auto most = [&](bool is_structure) {
    double seconds = 1e-9;
    for (const EffectCost& c : facts.costs.effects)
      if ((c.effect == Effect::structure) == is_structure)
        seconds = std::max({seconds, c.with.seconds, c.without.seconds});
    return seconds;
  };
  const float height = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  for (const EffectCost& c : facts.costs.effects) {
    if (c.presence == EffectCost::not_in_scene) continue;
    const KeySpec& key = key_of(c.effect);
    const std::string name = fmt::format("{}   {}: ", key.name, tr(key.help));
    if (c.presence != EffectCost::in_picture || c.rounds == 0) {
      faint_text(name + (c.presence == EffectCost::in_picture ? "..." : absence(c.presence)));
      continue;
    }
    ImGui::BeginGroup();
    const bool is_noisy = c.finished && c.factor.half_width() > kTooNoisy;
    text(name + (is_noisy ? trf("too noisy: {}", range_text(c)) : factor_text(c)) +
         (c.finished || !measures ? "" : " ..."));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const double scale = width / most(c.effect == Effect::structure);
    const auto bar = [&](double seconds) { return float(seconds * scale); };
    draw.AddRectFilled(at, {at.x + bar(c.with.seconds), at.y + height * 0.5f},
                       color(palette().warning, c.on ? 1 : 0.45f));
    draw.AddRectFilled({at.x, at.y + height * 0.5f},
                       {at.x + bar(c.without.seconds), at.y + height * 0.75f},
                       color(palette().faint));
    ImGui::Dummy({width, height * 0.75f});
    faint_text("    " + seconds_line(c));
    faint_text("    " + count_line(c));
    ImGui::EndGroup();
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", details(c).c_str());
  }
  if (facts.costs.effects.empty()) return;
  faint_text(tr("upper bar with it, lower without"));
  faint_text(facts.costs.of == CostOf::report
                 ? tr("9 samples per pixel with AA, 3 with DOF, 27 with both")
                 : tr("AA, soft shadows and DOF need many samples"));
}

bool draw_table(const CostFacts& facts) {
  bool pressed = false;
  if (facts.measuring == Measuring::Work::table)
    text(fmt::format("{}\n{}; {}", facts.progress.what, text_of_progress(facts.progress),
                     tr("m stops")));
  else
    pressed = ImGui::Button(tr("Measure (m)"));
  constexpr auto kFlags = ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit;
  if (!facts.table || !ImGui::BeginTable("sixteen", 4, kFlags)) return pressed;
  ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch);
  for (const char* name : {"s", tr("Mrays/s"), tr("cost")}) ImGui::TableSetupColumn(name);
  ImGui::TableHeadersRow();
  for (const BenchmarkRow& row : facts.table->rows) {
    const auto cell = [](const std::string& value) { ImGui::TableNextColumn(), text(value); };
    cell(short_label(row.combination));
    cell(app::three_digits(row.seconds().median));
    cell(app::three_digits(row.rays_per_s() * 1e-6));
    cell(app::three_digits(facts.table->relative_cost(row).median) + " x");
  }
  ImGui::EndTable();
  return pressed;
}

}  // namespace raio::core::view
