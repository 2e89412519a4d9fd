#include "view/welcome.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr float kCardEms = 12, kGapEms = 0.8f, kMostColumns = 7;

enum class Keep { start, end };

// As much of the text as fits, with dots for the rest.
std::string shortened(const std::string& text, float width, Keep keep) {
  const auto is_inside = [](char c) { return (c & 0xc0) == 0x80; };  // of a letter in UTF-8
  std::string part = text;
  const auto with_dots = [&] { return keep == Keep::start ? part + "..." : "..." + part; };
  if (ImGui::CalcTextSize(part.c_str()).x <= width) return part;
  while (!part.empty() && ImGui::CalcTextSize(with_dots().c_str()).x > width) {
    if (keep == Keep::start) {
      while (is_inside(part.back())) part.pop_back();
      part.pop_back();
    } else {
      part.erase(0, 1);
      while (!part.empty() && is_inside(part.front())) part.erase(0, 1);
    }
  }
  return with_dots();
}

struct Card {
  const std::string& path;
  const SceneCard* made;  // null: not yet
  bool shows_folder;
  float width;

  // Returns whether it was pressed.
  bool draw() const {
    const std::filesystem::path file(path);
    const std::string name = file.stem().string();
    const float pad = 0.5f * em(), inner = width - 2 * pad;
    const ImVec2 frame(width, std::round(width * 2 / 3)), at = ImGui::GetCursorScreenPos();
    const float line = ImGui::GetTextLineHeight();
    ImGui::PushID(path.c_str());
    const bool pressed = ImGui::InvisibleButton("card", {width, frame.y + 2 * line + 2 * pad});
    ImGui::PopID();
    const bool hovered = ImGui::IsItemHovered();
    const Palette& p = palette();
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const ImVec2 end = ImGui::GetItemRectMax();
    const float round = 0.4f * em();
    draw.AddRectFilled(at, end, color(hovered ? p.hovered : p.raised), round);
    draw.AddRectFilled(at, {end.x, at.y + frame.y}, color(p.mat), round,
                       ImDrawFlags_RoundCornersTop);
    if (made && !made->texture.empty()) {
      made->texture.draw_round(at, {end.x, at.y + frame.y}, round);
    } else {
      const char* const word = made ? tr("no picture") : "...";
      const ImVec2 size = ImGui::CalcTextSize(word);
      draw.AddText({at.x + (width - size.x) / 2, at.y + (frame.y - size.y) / 2}, color(p.faint),
                   word);
    }
    show_letters(path);
    draw.AddText({at.x + pad, at.y + frame.y + pad * 0.7f}, color(p.text),
                 shortened(name, inner, Keep::start).c_str());
    const std::string below = shows_folder
                                  ? shortened(file.parent_path().string(), inner, Keep::end)
                              : made ? shortened(made->size, inner, Keep::start)
                                     : "";
    draw.AddText({at.x + pad, at.y + frame.y + pad * 0.9f + line}, color(p.faint), below.c_str());
    if (hovered) {
      draw.AddRect(at, end, color(p.accent), round, 0, std::round(0.13f * em()));
      tooltip();
    }
    return pressed;
  }

  void tooltip() const {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(30 * em());
    text(path);
    if (made && !made->about.empty()) text(made->about);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
};

struct Page {
  const WelcomeFacts& facts;
  int columns;
  float width, card;  // of the columns together, and of each
  WelcomeResult result = {};

  // Null while it is not made.
  const SceneCard* card_of(const std::string& path) const {
    if (!facts.cards) return nullptr;
    const auto found = facts.cards->find(path);
    return found == facts.cards->end() ? nullptr : &found->second;
  }

  void draw_section(const char* title, const std::vector<std::string>& paths, bool shows_folder) {
    if (paths.empty()) return;
    ImGui::Dummy({0, 0.6f * em()});
    ImGui::PushFont(heading_font());
    text(title);
    ImGui::PopFont();
    ImGui::PushID(title);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {kGapEms * em(), kGapEms * em()});
    for (size_t i = 0; i < paths.size(); ++i) {
      if (i % size_t(columns) != 0) ImGui::SameLine();
      if (Card{paths[i], card_of(paths[i]), shows_folder, card}.draw()) result.open = paths[i];
    }
    ImGui::PopStyleVar();
    ImGui::PopID();
  }

  // The title, and the button, beside it if there is room.
  void draw_head() {
    const float button = std::min(14 * em(), width), left = ImGui::GetCursorPosX(),
                top = ImGui::GetCursorPosY();
    ImGui::PushFont(title_font());
    text("Raio");
    ImGui::PopFont();
    faint_text(tr("A ray tracer. Drop a scene here, open one, or begin with one of these."));
    const bool is_beside = width >= 48 * em();
    if (!is_beside) ImGui::Spacing();
    const ImVec2 below = ImGui::GetCursorPos();
    if (is_beside) ImGui::SetCursorPos({left + width - button, top + 0.5f * em()});
    ImGui::PushStyleColor(ImGuiCol_Button, palette().accent);
    ImGui::PushStyleColor(ImGuiCol_Text, palette().on_accent);
    if (ImGui::Button(tr("Open a scene (Ctrl+O)"), {button, 2.2f * em()})) result.asks = true;
    ImGui::PopStyleColor(2);
    if (is_beside) ImGui::SetCursorPos(below);
  }
};

}  // namespace

WelcomeResult draw_welcome(const Rect& where, const WelcomeFacts& facts) {
  const float gap = kGapEms * em(), bar = ImGui::GetStyle().ScrollbarSize;
  const float room = std::max(where.width() - 2 * em() - bar, em());
  const float card = std::min(kCardEms * em(), room);
  const int columns = int(std::clamp((room + gap) / (card + gap), 1.0f, kMostColumns));
  const float width = float(columns) * (card + gap) - gap;
  const float side = std::floor((where.width() - bar - width) / 2);
  ImGui::SetNextWindowPos({where.left, where.top});
  ImGui::SetNextWindowSize({where.width(), where.height()});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {side, 1.6f * em()});
  ImGui::Begin("welcome", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::PopStyleVar();
  Page page{facts, columns, width, card};
  ImGui::PushTextWrapPos();
  page.draw_head();
  page.draw_section(tr("Recent scenes"), facts.recent, true);
  page.draw_section(tr("Scenes of the course"), facts.samples.course, false);
  page.draw_section(tr("Scenes that come with Raio"), facts.samples.others, false);
  ImGui::PopTextWrapPos();
  ImGui::End();
  return page.result;
}

}  // namespace raio::core::view
