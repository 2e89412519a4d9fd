#include "view/help.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "view/keys.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return text;
}

bool has_all_words(const HelpLine& line, const std::string& sought) {
  const std::string text = lower(line.keys + " " + line.about);
  std::istringstream words(lower(sought));
  for (std::string word; words >> word;)
    if (text.find(word) == std::string::npos) return false;
  return true;
}

void draw_lines(const std::vector<HelpLine>& lines, bool mouse) {
  if (!std::ranges::any_of(lines, [&](const HelpLine& l) { return l.is_mouse == mouse; })) return;
  ImGui::Spacing();
  ImGui::PushFont(heading_font());
  text(mouse ? tr("Mouse") : tr("Keys"));
  ImGui::PopFont();
  if (!ImGui::BeginTable(mouse ? "mouse" : "keys", 2, ImGuiTableFlags_RowBg)) return;
  ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed, 11 * em());
  ImGui::TableSetupColumn("about", ImGuiTableColumnFlags_WidthStretch);
  for (const HelpLine& line : lines) {
    if (line.is_mouse != mouse) continue;
    ImGui::TableNextColumn(), text(line.keys);
    ImGui::TableNextColumn(), ImGui::TextWrapped("%s", line.about.c_str());
  }
  ImGui::EndTable();
}

}  // namespace

std::vector<HelpLine> help_lines(const std::string& sought) {
  std::vector<HelpLine> lines;
  for (const KeySpec& key : key_table()) {
    if (!*key.about) continue;
    std::string names;
    for (const char* name : app::key_names(key))
      names += (names.empty() ? "" : ", ") + std::string(tr(name));
    lines.push_back({names, tr(key.about), false});
  }
  for (const HandSpec& hand : hand_table()) lines.push_back({tr(hand.name), tr(hand.help), true});
  std::erase_if(lines, [&](const HelpLine& line) { return !has_all_words(line, sought); });
  return lines;
}

bool draw_help(const Layout& layout, std::string& sought) {
  const float width = std::min(44 * em(), layout.tool_bar.right),
              height = std::min(40 * em(), layout.picture.height());
  ImGui::SetNextWindowPos({(layout.tool_bar.right - width) / 2,
                           layout.picture.top + (layout.picture.height() - height) / 2});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.5f * em());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  bool open = true;
  ImGui::Begin(fmt::format("{}###help", tr("Help")).c_str(), &open,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoSavedSettings);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##sought", tr("Search"), &sought);
  ImGui::BeginChild("lines");
  const auto lines = help_lines(sought);
  if (lines.empty()) faint_text(tr("Nothing matches all of these words."));
  draw_lines(lines, false);
  draw_lines(lines, true);
  ImGui::EndChild();
  ImGui::End();
  ImGui::PopStyleVar(2);
  return open;
}

}  // namespace raio::core::view
