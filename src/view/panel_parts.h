// What the panels are made of: their frame, sections that open and close, lines of text.
#pragma once

#include <imgui.h>

#include <string>

#include "view/layout.h"
#include "view/theme.h"

namespace raio::view {

inline void text(const std::string& line) {
  show_letters(line);
  ImGui::TextUnformatted(line.data(), line.data() + line.size());
}

inline void faint_text(const std::string& line) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  text(line);
  ImGui::PopStyleColor();
}

/// Begins a panel that fills its place; ImGui::End() ends it.
void begin_panel(const char* name, const Rect& where);

/// A heading that opens what is below it; `name` is that of the table of texts. Whether it is open.
bool open_section(const char* name, bool at_first);

}  // namespace raio::view
