// Everything drawn around and over the picture: tool bar, panel, status line, messages and dialogs.
// It knows which dialogs are open, and nothing else.
#pragma once

#include <imgui.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "view/bars.h"
#include "view/file_dialog.h"
#include "view/layout.h"
#include "view/lesson_panel.h"
#include "view/panel.h"
#include "view/state.h"
#include "view/welcome.h"

namespace raio::core::view {

struct ControlFacts {
  PanelFacts panel;
  ToolFacts tools;
  StatusFacts status;
  WelcomeFacts welcome;  // without a scene
  std::string read_out;  // what is under the cursor
  std::string message;
  bool is_error = false;
  Rect legend;                 // avoided by the message
  bool has_inspector = false;  // replaces the panel
};

struct ControlResult : PanelResult {
  LessonResult lesson;
  std::optional<std::string> open, compare, save;  // files that were chosen
};

class Controls {
 public:
  FileDialog files;
  LessonPanel lesson;

  void switch_help() { shows_help_ = !shows_help_, sought_.clear(); }
  /// Whether something may cover the picture.
  bool has_dialog() const {
    return shows_help_ || files.is_open() ||
           ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel);
  }
  /// Closes a dialog or a menu; returns whether one was open.
  bool close();

  /// Draws a frame and updates the state from user input.
  ControlResult draw(ViewState& state, const Layout& layout, const ControlFacts& facts);

 private:
  bool shows_help_ = false;
  std::string sought_;  // in the help
};

}  // namespace raio::core::view
