#include "view/panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "view/grid_panel.h"
#include "view/options_panel.h"
#include "view/panel_parts.h"
#include "view/scene_panel.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

// At the right end of the row, faint: the equivalent key.
void key_cap(const char* name) {
  const float width = ImGui::CalcTextSize(name).x;
  ImGui::SameLine(std::max(0.0f, ImGui::GetContentRegionMax().x - width));
  faint_text(name);
}

// The roughness of gloss or translucency, even if off; 0 switches it off.
void draw_roughness(ViewState& state, Command effect, PanelResult& result) {
  std::optional<float>& given = state.roughness(effect);
  float roughness = given.value_or(0);
  const std::string format = !given && state.is_on(effect) ? tr("roughness: the materials' own")
                                                           : trf("roughness {}", "%.3g");
  ImGui::PushID(int(effect));
  ImGui::Indent();
  ImGui::SetNextItemWidth(-em());
  if (ImGui::SliderFloat("##roughness", &roughness, 0, 1, format.c_str(),
                         ImGuiSliderFlags_AlwaysClamp)) {
    given = roughness;
    state.split_effect = effect;
    result.changed = true;
  }
  ImGui::Unindent();
  ImGui::PopID();
}

// Those that the scene has. A click is equivalent to the key.
void draw_effects(ViewState& state, PanelResult& result) {
  ImGui::PushID("effects");  // some have the same names as options
  for (const KeySpec& key : key_table()) {
    if (key.command > Command::refraction) break;
    if (key.command == Command::structure || !state.has(key.command)) continue;
    bool on = state.is_on(key.command);
    if (ImGui::Checkbox(tr(key.help), &on)) result.pressed.push_back(&key);
    key_cap(key.name);
    if (key.command == Command::gloss || key.command == Command::translucency)
      draw_roughness(state, key.command, result);
  }
  const KeySpec& key = key_of(Command::structure);
  ImGui::AlignTextToFramePadding();
  text(tr("structure"));
  ImGui::SameLine(6 * em());
  if (ImGui::Button(fmt::format("{}###structure", accel_name(state.options.accel.kind)).c_str(),
                    {6 * em(), 0}))
    result.pressed.push_back(&key);
  key_cap(key.name);
  ImGui::PopID();
}

// The scene and its warnings: always three rows.
void draw_head(const ViewState& state, const PanelFacts& facts) {
  const Scene& scene = *state.scene;
  ImGui::PushFont(heading_font());
  text(scene.name);
  ImGui::PopFont();
  const std::string light = state.is_figure() ? std::string(tr("lit by a sky"))
                                              : number_of(scene.lights.size(), "light", "lights");
  faint_text(facts.figure.waits
                 ? std::string(tr("reading the file"))
                 : fmt::format("{}, {}",
                               number_of(scene.primitive_count(), "primitive", "primitives"),
                               light));
  const size_t errors = facts.errors.size(), warnings = facts.warnings.size();
  if (errors + warnings == 0) return faint_text(tr("no warnings"));
  const Palette& p = palette();
  ImGui::PushStyleColor(ImGuiCol_Text, errors > 0 ? p.bad : p.warning);
  text(errors > 0 ? number_of(errors, "error", "errors") + tr(", showing the previous scene")
                  : number_of(warnings, "warning", "warnings"));
  ImGui::PopStyleColor();
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(30 * em());
  for (const Diagnostic& d : facts.errors) text(d.text());
  for (const std::string& line : facts.warnings) text(line);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

// Which boxes of the structure are drawn over the picture.
void draw_boxes(ViewState& state, const PanelFacts& facts, PanelResult& result) {
  const KeySpec& key = key_of(Command::boxes);
  BoxLook& look = state.boxes;
  bool shown = look.shown;
  if (ImGui::Checkbox(tr("over the picture"), &shown)) result.pressed.push_back(&key);
  key_cap(key.name);
  const BoxFacts& boxes = facts.boxes;
  ImGui::PushItemWidth(9 * em());
  ImGui::BeginDisabled(boxes.levels == 0);
  const std::string level = look.level == kLeafBoxes ? tr("all leaves") : "%d";
  (void)ImGui::SliderInt(tr("level"), &look.level, kLeafBoxes, std::max(boxes.levels, 0),
                         level.c_str(), ImGuiSliderFlags_AlwaysClamp);
  ImGui::EndDisabled();
  (void)ImGui::SliderInt(tr("minimum primitives"), &look.fewest, 1, int(boxes.most), "%d",
                         ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_Logarithmic);
  ImGui::PopItemWidth();
  (void)ImGui::Checkbox(tr("coloured by level"), &look.by_level);
  faint_text(!look.shown      ? std::string(tr("not shown"))
             : boxes.all == 0 ? std::string(tr("there is no structure to show"))
             : boxes.drawn == boxes.all
                 ? number_of(boxes.all, "box", "boxes")
                 : trf("the largest {} of {} boxes", boxes.drawn, boxes.all));
}

// The window's own appearance.
void draw_window_options(const PanelFacts& facts, PanelResult& result) {
  bool light = facts.look.light, projector = facts.look.projector;
  if (ImGui::Checkbox(tr("light colours"), &light))
    result.pressed.push_back(&key_of(Command::theme));
  key_cap(key_of(Command::theme).name);
  if (ImGui::Checkbox(tr("big type, for a projector"), &projector))
    result.pressed.push_back(&key_of(Command::projector));
  key_cap(key_of(Command::projector).name);
  bool portuguese = language() == Language::portuguese;
  if (ImGui::Checkbox("Portugu\xc3\xaas", &portuguese))
    set_language(portuguese ? Language::portuguese : Language::english);
}

// The selected primitive: facts, and what can be done with it. Once used, of constant height, so
// that the sections below stay where they are.
void draw_selection(ViewState& state, const SelectionFacts& facts, PanelResult& result) {
  using enum SelectionUse;
  constexpr float kLines = 5;
  const float row = ImGui::GetTextLineHeightWithSpacing(), buttons_at = kLines * row;
  float& height = *ImGui::GetStateStorage()->GetFloatRef(ImGui::GetID("height"), row);
  if (!facts.lines.empty()) height = buttons_at + 3 * ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild("selection", {0, height});
  if (facts.lines.empty()) faint_text(tr("click the picture to select"));
  for (const std::string& line : facts.lines) text(line);
  const auto button = [&](const char* label, SelectionUse means) {
    if (ImGui::Button(tr(label))) result.selection = means;
    ImGui::SameLine();
  };
  if (!facts.lines.empty()) {
    ImGui::SetCursorPosY(buttons_at);
    if (facts.can_focus) button("focus", focus);
    button("its rays", inspect);
    button("turn about it", turn);
    button("clear", clear);
    ImGui::NewLine();
  }
  if (facts.is_atom) {
    button("hide", hide);
    if (facts.has_residue) button("hide its residue", hide_residue);
    if (facts.has_chain) button("hide its chain", hide_chain);
    ImGui::NewLine();
    Rgb& own = state.form.own_color;
    (void)ImGui::ColorEdit3("##own", &own.x, ImGuiColorEditFlags_NoInputs);
    ImGui::SameLine();
    button("colour", color);
    if (facts.has_residue) button("its residue", color_residue);
    if (facts.has_chain) button("its chain", color_chain);
  } else if (facts.material) {
    ImGui::SetNextItemWidth(11 * em());
    result.changed |= draw_material_color(state, *facts.material);
  }
  ImGui::EndChild();
}

void draw_difference(const Difference& found) {
  const ImageDifference& d = found.whole;
  if (std::isinf(d.psnr_db)) return text(tr("equal pictures"));
  text(trf("PSNR {} dB, RMSE {} of 255", fmt::format("{:.2f}", d.psnr_db),
           fmt::format("{:.4g}", d.rmse)));
  text(trf("{} of the pixels differ by more than 8", fmt::format("{:.3g} %", 100 * d.above_8)));
  const auto first = suspect(found.regions);
  if (!first) return;
  if (ImGui::BeginTable("regions", 3, ImGuiTableFlags_RowBg)) {
    ImGui::TableSetupColumn("region", ImGuiTableColumnFlags_WidthStretch);
    for (const char* number : {"share", "mean"})
      ImGui::TableSetupColumn(number, ImGuiTableColumnFlags_WidthFixed);
    const auto cell = [](const std::string& value) { ImGui::TableNextColumn(), text(value); };
    cell(tr("of these pixels")), cell(tr("differ")), cell(tr("B minus A"));
    for (size_t r = 0; r < found.regions.size(); ++r) {
      const RegionDifference& in = found.regions[r];
      if (in.pixels == 0) continue;
      cell(tr(kRegionNames[r].data()));
      cell(fmt::format("{:.3g} %", 100 * double(in.apart) / double(in.pixels)));
      cell(in.apart > 0 ? fmt::format("{:+.1f}", in.mean) : "");
    }
    ImGui::EndTable();
  }
  ImGui::TextWrapped("%s", trf("Look first at the {}: {}.", tr(kRegionNames[size_t(*first)].data()),
                               tr(likely_cause(*first).data()))
                               .c_str());
}

// Another program's picture, and where it differs.
void draw_compared(const ViewState& state, const Difference* difference, PanelResult& result) {
  const KeySpec &compare = key_of(Command::compare), &split = key_of(Command::split);
  ImGui::Spacing();
  ImGui::PushFont(heading_font());
  text(tr("Your picture"));
  ImGui::PopFont();
  text(trf("A: Raio, B: {}", state.compared->path));
  const bool both = ImGui::RadioButton(tr("A and B"), !state.shows_difference);
  ImGui::SameLine();
  const bool apart = ImGui::RadioButton(tr("differences"), state.shows_difference);
  if (state.shows_difference ? both : apart) result.pressed.push_back(&split);
  key_cap(split.name);
  if (difference) draw_difference(*difference);
  if (ImGui::Button(tr("stop comparing"))) result.pressed.push_back(&compare);
  key_cap(compare.name);
}

// Whether an activity started within the last few frames. The size of a section is known one frame
// later.
bool has_just_begun(const char* what, bool goes_on) {
  int& frames = *ImGui::GetStateStorage()->GetIntRef(ImGui::GetID(what));
  frames = goes_on ? frames + 1 : 0;
  constexpr int kFew = 3;
  return frames > 0 && frames <= kFew;
}

}  // namespace

PanelResult draw_panel(ViewState& state, const PanelFacts& facts, const Rect& where) {
  PanelResult result;
  begin_panel("panel", where);
  draw_head(state, facts);
  if (open_section("Selection", true)) draw_selection(state, facts.selection, result);
  if (state.compared) draw_compared(state, facts.difference, result);
  if (!state.is_figure()) {
    if (open_section("Effects", true)) draw_effects(state, result);
  } else if (open_section("Figure", true)) {
    result.changed |= draw_figure(state, facts.figure, result.figure, result.problem);
  }
  if (open_section("Statistics", true)) draw_statistics(facts.costs);
  if (!state.compared && open_section("Your picture", false)) {
    faint_text(tr("A picture of this scene by your program."));
    const KeySpec& key = key_of(Command::compare);
    if (ImGui::Button(tr("compare with a picture"))) result.pressed.push_back(&key);
    key_cap(key.name);
  }
  if (open_section("The structure's boxes", false)) draw_boxes(state, facts, result);
  result.wants_costs = open_section("What each effect costs", false);
  if (result.wants_costs) draw_costs(facts.costs, state.costs_of);
  if (facts.costs.measuring == Measuring::Work::table) ImGui::SetNextItemOpen(true);
  if (open_section("All combinations of effects", false) && draw_table(facts.costs))
    result.pressed.push_back(&key_of(Command::measure));
  const bool curve = facts.costs.measuring == Measuring::Work::curve;
  if (curve) ImGui::SetNextItemOpen(true);
  if (open_section("The grid's resolution", false)) {
    if (has_just_begun("curve", curve)) ImGui::SetScrollHereY(0);
    const GridPanelResult grid = draw_grid(state, facts.costs);
    result.changed |= grid.changed, result.saves_curve = grid.saves;
    if (grid.measures) result.pressed.push_back(&key_of(Command::curve));
  }
  if (open_section("Scene", false)) result.changed |= draw_scene(state);
  if (open_section("All options", false)) draw_options(state, facts.costs, result);
  if (open_section("Window", false)) draw_window_options(facts, result);
  ImGui::End();
  result.dragging = ImGui::IsAnyItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  return result;
}

}  // namespace raio::core::view
