// Lines of text in Dear ImGui's windows.
#pragma once

#include <imgui.h>

#include <string>

namespace raio::view {

inline void text(const std::string& line) {
  ImGui::TextUnformatted(line.data(), line.data() + line.size());
}

inline void faint_text(const std::string& line) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  text(line);
  ImGui::PopStyleColor();
}

}  // namespace raio::view
