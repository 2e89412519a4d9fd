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
constexpr float kShape = 1.5f;  // of the pictures of scenes

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
  const Texture* picture;   // null: none
  const char* instead;      // of the picture
  std::string name, below;  // the lines below it
  Keep keep;                // of the second line, if it is too long
  std::string about;        // in the tooltip; may be empty
  float width;
  float shape = kShape;  // of the picture: its width by its height

  // Returns whether it was pressed.
  bool draw() const {
    const float pad = 0.5f * em(), inner = width - 2 * pad;
    const ImVec2 frame = frame_of(width), at = ImGui::GetCursorScreenPos();
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
    if (picture && !picture->empty()) {
      // Others are shown whole, in the middle.
      const ImVec2 size(std::min(frame.x, frame.y * shape), std::min(frame.y, frame.x / shape));
      const ImVec2 lo(at.x + (frame.x - size.x) / 2, at.y + (frame.y - size.y) / 2);
      picture->draw_round(lo, {lo.x + size.x, lo.y + size.y}, size.x < frame.x ? 0 : round);
    } else {
      const ImVec2 size = ImGui::CalcTextSize(instead);
      draw.AddText({at.x + (width - size.x) / 2, at.y + (frame.y - size.y) / 2}, color(p.faint),
                   instead);
    }
    show_letters(path);
    draw.AddText({at.x + pad, at.y + frame.y + pad * 0.7f}, color(p.text),
                 shortened(name, inner, Keep::start).c_str());
    draw.AddText({at.x + pad, at.y + frame.y + pad * 0.9f + line}, color(p.faint),
                 shortened(below, inner, keep).c_str());
    if (hovered) {
      draw.AddRect(at, end, color(p.accent), round, 0, std::round(0.13f * em()));
      tooltip();
    }
    return pressed;
  }

  static ImVec2 frame_of(float width) { return {width, std::round(width / kShape)}; }

  void tooltip() const {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(30 * em());
    text(path);
    if (!about.empty()) text(about);
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

  // Calls `draw` for each of the cards, in rows.
  template <class Draw>
  void draw_section(const char* title, size_t cards, const Draw& draw) const {
    if (cards == 0) return;
    ImGui::Dummy({0, 0.6f * em()});
    ImGui::PushFont(heading_font());
    text(title);
    ImGui::PopFont();
    ImGui::PushID(title);
    ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {kGapEms * em(), kGapEms * em()});
    for (size_t i = 0; i < cards; ++i) {
      if (i % size_t(columns) != 0) ImGui::SameLine();
      draw(i);
    }
    ImGui::PopStyleVar();
    ImGui::PopID();
  }

  void draw_scenes(const char* title, const std::vector<std::string>& paths, bool shows_folder) {
    draw_section(title, paths.size(), [&](size_t i) {
      const std::filesystem::path file(paths[i]);
      const SceneCard* const made = card_of(paths[i]);
      if (Card{paths[i], made ? &made->texture : nullptr, made ? tr("no picture") : "...",
               file.stem().string(),
               shows_folder ? file.parent_path().string()
               : made       ? made->size
                            : "",
               shows_folder ? Keep::end : Keep::start, made ? made->about : "", card}
              .draw())
        result.open = paths[i];
    });
  }

  void draw_lessons() {
    draw_section(tr("Lessons"), facts.lessons.size(), [&](size_t i) {
      const LessonEntry& lesson = facts.lessons[i];
      const bool is_seen = ImGui::IsRectVisible(Card::frame_of(card));
      const auto* const picture = facts.pictures && is_seen && !lesson.picture.empty()
                                      ? &facts.pictures->of(lesson.picture)
                                      : nullptr;
      Card one{lesson.page.native(), picture ? &picture->texture : nullptr,
               tr("no picture"),     lesson.title,
               lesson.question,      Keep::start,
               lesson.question,      card};
      if (picture && picture->height > 0) one.shape = picture->width / picture->height;
      if (one.draw()) result.lesson = lesson.page.string();
    });
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
  page.draw_scenes(tr("Recent scenes"), facts.recent, true);
  page.draw_lessons();
  page.draw_scenes(tr("Scenes of the course"), facts.samples.course, false);
  page.draw_scenes(tr("Scenes that come with Raio"), facts.samples.others, false);
  ImGui::PopTextWrapPos();
  ImGui::End();
  return page.result;
}

}  // namespace raio::core::view
