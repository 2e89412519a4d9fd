#include "view/bars.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/terminal.h"
#include "view/icons.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr float kSide = 2, kGap = 0.6f;  // of a tool, and between groups, in ems
constexpr ImGuiWindowFlags kBar = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                  ImGuiWindowFlags_NoSavedSettings |
                                  ImGuiWindowFlags_NoScrollWithMouse |
                                  ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav;

void begin_bar(const char* name, const Rect& where) {
  ImGui::SetNextWindowPos({where.left, where.top});
  ImGui::SetNextWindowSize({where.width(), where.height()});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin(name, nullptr, kBar);
  ImGui::PopStyleVar(2);
}

struct Tool {
  Icon icon;
  const KeySpec* key;
  bool on = false, enabled = true;
  std::string label = {};  // next to the icon, with the width of `widest`
  std::string widest = {};
  bool starts_group = false;

  float width() const {
    const float text = widest.empty() ? 0 : ImGui::CalcTextSize(widest.c_str()).x + em() * 0.6f;
    return kSide * em() + text + (starts_group ? kGap * em() : 0);
  }
};

std::vector<Tool> tools_of(const ViewState& state, const ToolFacts& facts) {
  const auto key = [](Command command) { return &key_of(command); };
  const auto effect = [&](Icon icon, Command command) {
    return Tool{icon, key(command), state.is_on(command)};
  };
  const bool is_empty = state.path.empty();
  std::vector<Tool> tools = {
      {Icon::open, key(Command::open)},
      {Icon::save_scene, key(Command::save_scene)},
      {Icon::undo, key(Command::undo), false, facts.can_undo, {}, {}, true},
      {Icon::redo, key(Command::redo), false, facts.can_redo},
      effect(Icon::antialiasing, Command::antialiasing),
      effect(Icon::soft_shadows, Command::soft_shadows),
      effect(Icon::depth_of_field, Command::depth_of_field),
      effect(Icon::reflection, Command::reflection),
      effect(Icon::refraction, Command::refraction),
      effect(Icon::gloss, Command::gloss),
      effect(Icon::translucency, Command::translucency),
      effect(Icon::motion, Command::motion),
      {Icon::structure, key(Command::structure), false, true,
       std::string(accel_name(state.options.accel.kind)), "embree", true},
      {Icon::view, key(Command::show_view), state.options.view != View::picture, true,
       tr(find_key('1' + int(state.options.view))->help), tr("materials")},
      {Icon::split, key(Command::split), state.split},
      {Icon::boxes, key(Command::boxes), state.boxes.shown},
      {Icon::inspect, key(Command::inspect), facts.inspects},
      {state.paused ? Icon::play : Icon::pause,
       key(Command::pause),
       state.paused,
       true,
       {},
       {},
       true},
      {Icon::fit, key(Command::fit)},
      {Icon::home, key(Command::home)},
      {Icon::picture, key(Command::save_png), false, true, {}, {}, true},
      {Icon::copy, key(Command::copy)},
      {Icon::theme, key(Command::theme), false, true, {}, {}, true},
      {Icon::full_screen, key(Command::full_screen), facts.full_screen},
      {Icon::panel, key(Command::panel), facts.has_panel},
      {Icon::help, key(Command::help)},
  };
  std::erase_if(tools, [&](const Tool& tool) {
    const Command command = tool.key->command;
    if (is_empty) return tool.icon != Icon::open && tool.icon < Icon::theme;
    return command <= Command::refraction && command != Command::structure && !state.has(command);
  });
  if (const auto first = std::ranges::find_if(
          tools, [](const Tool& tool) { return tool.icon >= Icon::antialiasing; });
      first != tools.end())
    first->starts_group = true;
  return tools;
}

// Draws one tool; returns whether it was pressed.
bool draw_tool(const Tool& tool) {
  const Palette& p = palette();
  const float side = kSide * em(), gap = tool.starts_group ? kGap * em() : 0;
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + gap);
  const ImVec2 at = ImGui::GetCursorScreenPos(), size(tool.width() - gap, side);
  ImGui::PushID(tool.key);
  const bool pressed = ImGui::InvisibleButton("tool", size) && tool.enabled;
  ImGui::PopID();
  const bool hovered = ImGui::IsItemHovered();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const ImVec2 end(at.x + size.x, at.y + size.y);
  const float inset = std::round(0.1f * em());
  if (tool.on || (hovered && tool.enabled))
    draw.AddRectFilled({at.x + inset, at.y}, {end.x - inset, end.y},
                       color(tool.on ? p.accent : p.hovered), 0.35f * em());
  const ImU32 ink = color(tool.on ? p.on_accent : p.text, tool.enabled ? 1 : 0.3f);
  draw_icon(draw, tool.icon, {at.x + side / 2, at.y + side / 2}, 1.15f * em(), ink);
  if (!tool.label.empty())
    draw.AddText({at.x + side - 0.1f * em(), at.y + (side - ImGui::GetFontSize()) / 2}, ink,
                 tool.label.c_str());
  if (hovered)
    ImGui::SetTooltip("%s",
                      fmt::format("{}  ({})", tr(tool.key->about), tr(tool.key->name)).c_str());
  ImGui::SameLine(0, 0);
  return pressed;
}

// The views by name; the selected one looks pressed.
void draw_views(const ViewState& state, std::vector<const KeySpec*>& pressed) {
  if (!ImGui::BeginPopup("views")) return;
  for (int view = 0; view < kViews; ++view) {
    const KeySpec* key = find_key('1' + view);
    if (ImGui::MenuItem(tr(key->help), key->name, view == int(state.options.view)))
      pressed.push_back(key);
  }
  ImGui::EndPopup();
}

}  // namespace

void draw_tool_bar(const Rect& where, const ViewState& state, const ToolFacts& facts,
                   std::vector<const KeySpec*>& pressed) {
  begin_bar("tool bar", where);
  const auto tools = tools_of(state, facts);
  std::vector<float> widths;
  widths.reserve(tools.size());
  for (const Tool& tool : tools) widths.push_back(tool.width());
  const float margin = std::round(0.4f * em());
  const size_t fit = tools_that_fit(widths, where.width() - 2 * margin, kSide * em());
  ImGui::SetCursorPos({margin, std::round((where.height() - kSide * em()) / 2)});
  for (size_t i = 0; i < fit; ++i) {
    // Tools of the window itself are at its right.
    if (tools[i].icon == Icon::theme && fit == tools.size()) {
      float rest = margin;
      for (size_t j = i; j < tools.size(); ++j) rest += widths[j];
      ImGui::SetCursorPosX(where.width() - rest);
    }
    if (!draw_tool(tools[i])) continue;
    if (tools[i].icon == Icon::view)
      ImGui::OpenPopup("views");
    else
      pressed.push_back(tools[i].key);
  }
  if (fit < tools.size()) {
    static constexpr KeySpec kMore{0, {}, Command::help, "", "more", "More tools"};
    if (draw_tool({Icon::more, &kMore})) ImGui::OpenPopup("more");
  }
  draw_views(state, pressed);
  if (ImGui::BeginPopup("more")) {
    for (size_t i = fit; i < tools.size(); ++i)
      if (tools[i].icon != Icon::view &&
          ImGui::MenuItem(tr(tools[i].key->help), tr(tools[i].key->name), tools[i].on,
                          tools[i].enabled))
        pressed.push_back(tools[i].key);
    ImGui::EndPopup();
  }
  ImGui::GetWindowDrawList()->AddLine({where.left, where.bottom - 1},
                                      {where.right, where.bottom - 1}, color(palette().line));
  ImGui::End();
}

Status status_of(const StatusFacts& f) {
  using enum Status::Kind;
  if (f.picture && f.picture->error && f.picture->request == f.request)
    return {failed, f.picture->error->text()};
  const bool is_new = f.picture && f.picture->request == f.request && f.picture->samples > 0;
  const std::string samples = number_of(f.picture ? size_t(f.picture->samples) : 0,
                                        "sample per pixel", "samples per pixel");
  if (f.moving && f.picture && f.picture->image) {
    const Image& image = *f.picture->image;
    return {moving, trf("Moving: {} x {} of {} x {} pixels", image.width, image.height,
                        f.picture_width, f.picture_height)};
  }
  if (f.measuring == Measuring::Work::table)
    return {measuring, tr("Measuring all combinations; m stops")};
  if (f.measuring == Measuring::Work::curve)
    return {measuring, tr("Measuring grids from coarse to fine; n stops")};
  if (!is_new) {
    if (f.paused && f.picture && f.picture->request == f.request)
      return {paused, tr("Paused; space resumes")};
    if (f.progress && f.progress->stage != SessionProgress::structure && f.progress->share > 0)
      return {working, trf("Rendering the first sample: {:.0f} %, {:.0f} s left",
                           100 * f.progress->share, f.progress->left_s)};
    return {working, trf("Rendering the first sample, {:.0f} s", f.since_request_s)};
  }
  if (f.picture->finished) return {done, trf("Finished: {}", samples)};
  if (f.paused) return {paused, trf("Paused at {}; space resumes", samples)};
  const int most = f.picture->settings.samples_per_pixel();
  const double sample_s = f.picture->sample_s.median;
  const std::string so_far = trf("Refining: {} of {}", f.picture->samples,
                                 number_of(size_t(most), "sample per pixel", "samples per pixel"));
  if (!(sample_s > 0)) return {working, so_far};
  const double rays = double(f.picture->rays.total()) / (sample_s * f.picture->samples);
  return {working, trf("{}, {} each, {}", so_far, app::human_seconds(sample_s),
                       app::human_quantity(rays, "rays/s"))};
}

void draw_status(const Rect& where, const Status& status, const std::string& read_out) {
  const Palette& p = palette();
  const auto kind_color = [&] {
    switch (status.kind) {
      case Status::Kind::done:
        return p.good;
      case Status::Kind::failed:
        return p.bad;
      case Status::Kind::paused:
        return p.warning;
      default:
        return p.busy;
    }
  };
  begin_bar("status", where);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  show_letters(status.text), show_letters(read_out);
  draw.AddLine({where.left, where.top}, {where.right, where.top}, color(p.line));
  const float middle = (where.top + where.bottom) / 2, top = middle - ImGui::GetFontSize() / 2;
  draw.AddCircleFilled({where.left + em(), middle}, 0.3f * em(), color(kind_color()));
  const float right = where.right - 0.8f * em() - ImGui::CalcTextSize(read_out.c_str()).x;
  draw.PushClipRect({where.left, where.top}, {std::max(where.left, right - em()), where.bottom},
                    true);
  draw.AddText({where.left + 1.8f * em(), top}, color(p.text), status.text.c_str());
  draw.PopClipRect();
  draw.AddText({right, top}, color(p.text), read_out.c_str());
  ImGui::End();
}

namespace {

constexpr float kMessagePad = 0.5f;  // ems

float message_bar() { return std::round(0.25f * em()); }
float message_wrap(float width) { return std::max(width - 4 * em(), 8 * em()); }

}  // namespace

Rect message_place(const Rect& picture, const Rect& legend, const std::string& message) {
  const ImVec2 text =
      ImGui::CalcTextSize(message.c_str(), nullptr, false, message_wrap(picture.width()));
  const float pad = kMessagePad * em();
  Rect place;
  place.left = picture.left + em();
  place.right = place.left + message_bar() + 2 * pad + text.x;
  const bool is_beside = legend.width() <= 0 || place.right + em() <= legend.left;
  place.bottom = (is_beside ? picture.bottom : legend.top) - em();
  place.top = place.bottom - text.y - 2 * pad;
  return place;
}

void draw_message(const Rect& place, const std::string& message, bool is_error) {
  const Palette& p = palette();
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const float pad = kMessagePad * em(), bar = message_bar();
  const ImVec2 lo(place.left, place.top), hi(place.right, place.bottom);
  draw.AddRectFilled(lo, hi, color(p.ground, 0.94f), 0.3f * em());
  draw.AddRectFilled(lo, {lo.x + bar, hi.y}, color(is_error ? p.bad : p.accent), 0.3f * em(),
                     ImDrawFlags_RoundCornersLeft);
  show_letters(message);
  // Wrapped as measured: one unit more than the widest line.
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), {lo.x + bar + pad, lo.y + pad},
               color(p.text), message.c_str(), nullptr, place.width() - bar - 2 * pad + 1);
}

}  // namespace raio::core::view
