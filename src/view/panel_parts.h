// Building blocks of panels: frame, collapsible sections, lines of text.
#pragma once

#include <imgui.h>

#include <set>
#include <string>

#include "view/layout.h"
#include "view/theme.h"

namespace raio::core::view {

inline void text(const std::string& line) {
  show_letters(line);
  ImGui::TextUnformatted(line.data(), line.data() + line.size());
}

inline void faint_text(const std::string& line) {
  ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
  text(line);
  ImGui::PopStyleColor();
}

/// Starts a panel that fills its area; ImGui::End() ends it. Without `scrolls`, parts of it may.
void begin_panel(const char* name, const Rect& where, bool scrolls = true);

/// The names of sections that the user has opened or closed against their default.
std::set<std::string>& switched_sections();

/// A heading that opens the content below; `name` is a key of the table of texts. Returns whether
/// it is open.
bool open_section(const char* name, bool at_first);

}  // namespace raio::core::view
