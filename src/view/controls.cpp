#include "view/controls.h"

#include <imgui.h>

#include "view/help.h"

namespace raio::view {

PanelResult Controls::draw(ViewState& state, const Layout& layout, const ControlFacts& facts) {
  PanelResult result;
  if (state.panel) result = draw_panel(state, facts.panel, layout.panel);
  draw_tool_bar(layout.tool_bar, state, facts.tools, result.pressed);
  draw_status(layout.status, status_of(facts.status), facts.read_out);
  if (!facts.message.empty()) draw_message(layout.picture, facts.message, facts.is_error);
  if (shows_help_) shows_help_ = draw_help(layout, sought_);
  return result;
}

}  // namespace raio::view
