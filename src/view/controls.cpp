#include "view/controls.h"

#include <imgui.h>
#include <imgui_internal.h>

#include "view/help.h"
#include "view/texts.h"

namespace raio::core::view {

bool Controls::close() {
  const bool was_open = files.is_open() || shows_help_;
  files.close(), shows_help_ = false;
  // The toolkit's own keys are off, so menus and pickers are closed here.
  const bool has_menu = !was_open && ImGui::GetCurrentContext()->OpenPopupStack.Size > 0;
  if (has_menu) ImGui::ClosePopupToLevel(0, false);
  return was_open || has_menu;
}

ControlResult Controls::draw(ViewState& state, const Layout& layout, const ControlFacts& facts) {
  ControlResult result;
  if (layout.lesson.width() > 0) result.lesson = lesson.draw(layout.lesson, state.path.empty());
  if (state.path.empty()) {
    const WelcomeResult welcome = draw_welcome(layout.picture, facts.welcome);
    result.open = welcome.open;
    if (welcome.lesson) result.lesson.page = welcome.lesson;
    if (welcome.asks) result.pressed.push_back(&key_of(Command::open));
  } else if (layout.panel.width() > 0 && !facts.has_inspector) {
    static_cast<PanelResult&>(result) = draw_panel(state, facts.panel, layout.panel);
  }
  draw_tool_bar(layout.tool_bar, state, facts.tools, result.pressed);
  const Status none{Status::Kind::done, tr("No scene is open")};
  draw_status(layout.status, state.path.empty() ? none : status_of(facts.status), facts.read_out);
  if (!facts.message.empty())
    draw_message(message_place(layout.picture, facts.legend, facts.message), facts.message,
                 facts.is_error);
  if (shows_help_) shows_help_ = draw_help(layout, sought_);
  if (const auto file = files.draw(layout)) {
    using enum FileDialog::Purpose;
    const FileDialog::Purpose purpose = files.purpose();
    (purpose == open ? result.open : purpose == compare ? result.compare : result.save) = file;
  }
  return result;
}

}  // namespace raio::core::view
