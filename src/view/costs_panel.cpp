#include "view/costs_panel.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/bench.h"
#include "app/terminal.h"
#include "base/memory.h"
#include "view/draw_text.h"

namespace raio::view {

using app::human_bytes;
using app::human_count;
using app::human_seconds;

void draw_statistics(const CostFacts& facts) {
  if (!facts.picture || !facts.picture->baked) return;
  const SessionPicture& picture = *facts.picture;
  const BakedScene& baked = *picture.baked;
  const Image& image = *picture.image;
  text(fmt::format("{} x {} pixels{}", facts.picture_width, facts.picture_height,
                   image.width == facts.picture_width
                       ? ""
                       : fmt::format(", now {} x {}", image.width, image.height)));
  text(picture.samples == 0 ? "preview"
                            : fmt::format("{} {} a pixel{}", picture.samples,
                                          picture.samples == 1 ? "sample" : "samples",
                                          picture.finished ? ", done" : ""));
  text(fmt::format("{} a sample of all pixels", human_seconds(picture.pass_s)));
  const RayCounts& rays = picture.rays;
  const double seconds = std::max(picture.render_s, 1e-9);
  if (rays.total() > 0) {
    text(fmt::format("{}rays/s", human_count(double(rays.total()) / seconds)));
    for (const auto& [name, count] : {std::pair("eye", rays.eye),
                                      {"reflected", rays.reflection},
                                      {"refracted", rays.refraction},
                                      {"shadow", rays.shadow}})
      if (count > 0)
        text(fmt::format("    {}: {}/s, {:.2f} a pixel", name, human_count(double(count) / seconds),
                         double(count) / double(std::max<uint64_t>(1, rays.eye))));
  }
  text(fmt::format("{}: {}, built in {}", baked.info.name, human_bytes(double(baked.info.bytes)),
                   human_seconds(baked.build_s)));
  text(fmt::format("scene {}, program {}", human_bytes(double(memory_bytes(*baked.scene))),
                   human_bytes(double(peak_memory_bytes()))));
}

// A bar for each effect: what a picture takes with it, in white what it takes without.
void draw_costs(const CostFacts& facts) {
  if (facts.measuring == Measuring::Work::costs && facts.costs.empty())
    return faint_text("measuring ...");
  if (facts.costs.empty()) return faint_text("measured when the picture rests");
  // One scale for all effects; without a structure a picture takes so long that it has its own.
  const auto most = [&](bool is_structure) {
    double seconds = 0;
    for (const EffectCost& c : facts.costs)
      if ((c.effect == Command::structure) == is_structure)
        seconds = std::max({seconds, c.with_s, c.without_s});
    return seconds;
  };
  const float height = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  for (const EffectCost& c : facts.costs) {
    const auto keys = key_table();
    const KeySpec& key = *std::ranges::find(keys, c.effect, &KeySpec::command);
    const double factor = c.with_s / std::max(c.without_s, 1e-9);
    text(fmt::format("{}   {}: {} {}", key.name, key.help, human_seconds(c.with_s),
                     c.effect == Command::structure ? fmt::format("({:.3g} x faster)", 1 / factor)
                                                    : fmt::format("({:.2f} x)", factor)));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const double scale = width / most(c.effect == Command::structure);
    const auto length = [&](double seconds) { return float(seconds * scale); };
    draw.AddRectFilled(at, {at.x + length(c.with_s), at.y + height * 0.5f},
                       c.on ? IM_COL32(240, 150, 50, 255) : IM_COL32(240, 150, 50, 110));
    draw.AddRectFilled({at.x, at.y + height * 0.5f},
                       {at.x + length(c.without_s), at.y + height * 0.75f},
                       IM_COL32(220, 220, 220, 255));
    ImGui::Dummy({width, height});
  }
  faint_text("orange with it, white without; samples\nas the report has them: 9, 3, 27 a pixel");
}

bool draw_table(const CostFacts& facts) {
  bool pressed = false;
  if (facts.measuring == Measuring::Work::table)
    text("measuring ...");
  else
    pressed = ImGui::Button("Measure (m)");
  if (!facts.table || !ImGui::BeginTable("sixteen", 4, ImGuiTableFlags_RowBg)) return pressed;
  for (const char* name : {"", "s", "Mrays/s", "cost"}) ImGui::TableSetupColumn(name);
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

}  // namespace raio::view
