#include "view/panel_parts.h"

#include <fmt/format.h>

#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {

void begin_panel(const char* name, const Rect& where, bool scrolls) {
  ImGui::SetNextWindowPos({where.left, where.top});
  ImGui::SetNextWindowSize({where.width(), where.height()});
  ImGui::Begin(
      name, nullptr,
      ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
          ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
          ImGuiWindowFlags_NoBringToFrontOnFocus |
          (scrolls ? ImGuiWindowFlags_AlwaysVerticalScrollbar : ImGuiWindowFlags_NoScrollbar));
  ImGui::GetWindowDrawList()->AddLine({where.left, where.top}, {where.left, where.bottom},
                                      color(palette().line));
}

std::set<std::string>& switched_sections() {
  static std::set<std::string> names;
  return names;
}

bool open_section(const char* name, bool at_first) {
  ImGui::Spacing();
  ImGui::PushFont(heading_font());
  const bool begins_open = at_first != switched_sections().contains(name);
  // The name may be translated; the section's identity is not.
  const bool is_open = ImGui::CollapsingHeader(fmt::format("{}###{}", tr(name), name).c_str(),
                                               begins_open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
  ImGui::PopFont();
  if (is_open == at_first)
    switched_sections().erase(name);
  else
    switched_sections().insert(name);
  return is_open;
}

}  // namespace raio::core::view
