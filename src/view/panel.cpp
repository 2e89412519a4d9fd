#include "view/panel.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>

#include "app/terminal.h"
#include "view/draw_text.h"

namespace raio::view {
namespace {

using app::human_count;

bool is_effect(Command command) { return command <= Command::refraction; }

// The keys of the effects, with what is on; a click does what the key does.
void draw_effects(const ViewState& state, PanelResult& result) {
  for (const KeySpec& key : key_table()) {
    if (!is_effect(key.command)) continue;
    const std::string label = fmt::format("{}   {}", key.name, key.help);
    if (key.command == Command::structure) {
      const std::string name = fmt::format("{}   structure: {}###structure", key.name,
                                           accel_name(state.options.accel.kind));
      if (ImGui::Selectable(name.c_str())) result.pressed.push_back(&key);
      continue;
    }
    bool on = state.is_on(key.command);
    if (ImGui::Checkbox(label.c_str(), &on)) result.pressed.push_back(&key);
  }
}

// All other keys, as buttons in as many rows as they need.
void draw_keys(PanelResult& result) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float right = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
  ImGui::Spacing();
  for (bool first = true; const KeySpec& key : key_table()) {
    if (is_effect(key.command) || key.name.empty()) continue;
    const std::string label = fmt::format("{} {}", key.name, key.help);
    const float width = ImGui::CalcTextSize(label.c_str()).x + 2 * style.FramePadding.x;
    const float next = ImGui::GetItemRectMax().x + style.ItemSpacing.x + width;
    if (!first && next < right) ImGui::SameLine();
    first = false;
    if (ImGui::SmallButton(label.c_str())) result.pressed.push_back(&key);
  }
  ImGui::Spacing();
}

void draw_hands() {
  for (const HandSpec& hand : hand_table()) {
    text(std::string(hand.name));
    ImGui::SameLine(7.5f * ImGui::GetFontSize());
    text(std::string(hand.help));
  }
}

// One row of the table of options. The text of a new value, or nothing.
std::optional<std::string> draw_option(const RenderOptions& options, const RenderOptions& resolved,
                                       const OptionSpec& spec) {
  const std::string label(spec.name);
  struct Widget {
    RenderOptions given, used;
    const OptionSpec& spec;
    const char* label;
    using New = std::optional<std::string>;

    static New checkbox(const char* label, bool on) {
      if (!ImGui::Checkbox(label, &on)) return std::nullopt;
      return on ? "true" : "false";
    }
    New operator()(bool& (*value)(RenderOptions&)) { return checkbox(label, value(given)); }
    New operator()(std::optional<bool>& (*value)(RenderOptions&)) {
      return checkbox(label, value(used).value_or(false));
    }
    New operator()(int& (*value)(RenderOptions&)) {
      int number = value(used);
      if (!ImGui::InputInt(label, &number, 1, 10)) return std::nullopt;
      return fmt::format("{}", std::clamp(number, int(spec.least), int(spec.most)));
    }
    New operator()(float& (*value)(RenderOptions&)) {
      float number = value(used);
      // From zero, to both sides of which it may go, in even steps.
      const float speed = spec.least < 0 ? 0.01f : std::max(0.005f * std::abs(number), 1e-6f);
      const auto [least, most] = std::pair(float(spec.least), float(spec.most));
      if (!ImGui::DragFloat(label, &number, speed, least, most, "%.6g")) return std::nullopt;
      return fmt::format("{}", std::clamp(number, least, most));
    }
    New operator()(OptionSpec::Parse) {
      std::string value = spec.text(given);
      if (spec.words.empty()) {
        if (value.empty()) value = spec.text(used);
        const bool entered = ImGui::InputText(label, &value, ImGuiInputTextFlags_EnterReturnsTrue);
        return entered ? std::optional(value) : std::nullopt;
      }
      New chosen;
      if (value.empty()) value = spec.words.front();
      if (!ImGui::BeginCombo(label, value.c_str())) return chosen;
      for (const std::string_view word : spec.words)
        if (ImGui::Selectable(std::string(word).c_str(), word == value)) chosen = word;
      ImGui::EndCombo();
      return chosen;
    }
  };
  return std::visit(Widget{options, resolved, spec, label.c_str()}, spec.value);
}

void draw_options(ViewState& state, PanelResult& result) {
  ImGui::PushItemWidth(10 * ImGui::GetFontSize());
  for (const OptionSpec& spec : render_option_table()) {
    if (!spec.of_window) continue;
    RenderOptions options = state.options;
    set_camera(options, state.camera, *state.scene);
    const auto entered = draw_option(
        options, options_of(resolve_options(options, *state.scene), *state.scene), spec);
    if (ImGui::IsItemHovered())
      ImGui::SetTooltip("%s", fmt::format("--{} {}\n{}", spec.name, spec.value_name,
                                          with_settings(spec.help, "--"))
                                  .c_str());
    if (!entered) continue;
    if (const auto set = set_option(options, spec, *entered); !set) {
      result.problem = set.error().text("--");
      continue;
    }
    if (const auto why = window_conflict(options)) {
      result.problem = why->text("--");
      continue;
    }
    const Camera camera = camera_of(*state.scene, options);
    if (const auto why = camera_problem(camera); !why.empty()) {
      result.problem = why;
      continue;
    }
    state.camera = camera;
    options.from = options.at = options.up = std::nullopt, options.fov_deg = 0;
    state.options = options;
    result.changed = true;
  }
  ImGui::PopItemWidth();
}

void draw_errors(const Diagnostics& errors) {
  if (errors.empty()) return;
  ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.5f, 0.4f, 1));
  ImGui::PushTextWrapPos(0);
  text("The file has an error; this is the scene from before:");
  for (const Diagnostic& d : errors) text(d.text());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
  ImGui::Separator();
}

}  // namespace

PanelResult draw_panel(ViewState& state, const PanelFacts& facts, float width) {
  PanelResult result;
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({window.x - width, 0});
  ImGui::SetNextWindowSize({width, window.y});
  ImGui::Begin("panel", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
  text(fmt::format("{}, {} primitives", state.scene->name,
                   human_count(double(state.scene->primitive_count()))));
  ImGui::Separator();
  draw_errors(facts.errors);
  draw_effects(state, result);
  draw_keys(result);
  const auto open = [](const char* name, bool at_first) {
    return ImGui::CollapsingHeader(name, at_first ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  };
  if (open("Statistics", true)) draw_statistics(facts.costs);
  result.wants_costs = open("What each effect costs", true);
  if (result.wants_costs) draw_costs(facts.costs);
  if (facts.costs.measuring == Measuring::Work::table) ImGui::SetNextItemOpen(true);
  if (open("The report's sixteen", false) && draw_table(facts.costs))
    result.pressed.push_back(find_key('M', false));
  if (open("Mouse", false)) draw_hands();
  if (open("All options", false)) draw_options(state, result);
  ImGui::End();
  result.dragging = ImGui::IsAnyItemActive() && ImGui::IsMouseDown(ImGuiMouseButton_Left);
  return result;
}

}  // namespace raio::view
