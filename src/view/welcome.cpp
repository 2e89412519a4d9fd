#include "view/welcome.h"

#include <imgui.h>

#include <filesystem>

#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

void draw_list(const char* title, const std::vector<std::string>& paths, bool with_folders,
               WelcomeResult& result) {
  ImGui::PushFont(heading_font());
  text(title);
  ImGui::PopFont();
  if (paths.empty()) faint_text(tr("none yet"));
  ImGui::PushID(title);
  for (const std::string& path : paths) {
    const std::filesystem::path file(path);
    ImGui::PushID(path.c_str());
    show_letters(path);
    if (ImGui::Selectable(file.stem().string().c_str(), false, 0, {0, 1.5f * em()}))
      result.open = path;
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", path.c_str());
    if (with_folders) {
      const ImVec2 at = ImGui::GetItemRectMin();
      ImGui::GetWindowDrawList()->AddText({at.x + 9 * em(), at.y}, color(palette().faint),
                                          file.parent_path().string().c_str());
    }
    ImGui::PopID();
  }
  ImGui::PopID();
}

}  // namespace

WelcomeResult draw_welcome(const Rect& where, const std::vector<std::string>& recent,
                           const std::vector<std::string>& samples) {
  WelcomeResult result;
  ImGui::SetNextWindowPos({where.left, where.top});
  ImGui::SetNextWindowSize({where.width(), where.height()});
  const float side = std::max(em(), (where.width() - 44 * em()) / 2);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {side, 3 * em()});
  ImGui::Begin("welcome", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
  ImGui::PopStyleVar();
  ImGui::PushFont(title_font());
  text("Raio");
  ImGui::PopFont();
  faint_text(tr("A ray tracer. Drop a scene here, open one, or begin with one of these."));
  ImGui::Spacing(), ImGui::Spacing();
  ImGui::PushStyleColor(ImGuiCol_Button, palette().accent);
  ImGui::PushStyleColor(ImGuiCol_Text, palette().on_accent);
  if (ImGui::Button(tr("Open a scene (Ctrl+O)"), {14 * em(), 2.2f * em()})) result.asks = true;
  ImGui::PopStyleColor(2);
  ImGui::Spacing(), ImGui::Spacing();
  if (ImGui::BeginTable("lists", 2)) {
    ImGui::TableSetupColumn("samples", ImGuiTableColumnFlags_WidthStretch, 1);
    ImGui::TableSetupColumn("recent", ImGuiTableColumnFlags_WidthStretch, 2);
    ImGui::TableNextColumn();
    draw_list(tr("Scenes that come with Raio"), samples, false, result);
    ImGui::TableNextColumn();
    draw_list(tr("Recent scenes"), recent, true, result);
    ImGui::EndTable();
  }
  ImGui::End();
  return result;
}

}  // namespace raio::core::view
