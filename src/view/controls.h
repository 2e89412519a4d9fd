// All that is drawn around the picture and over it: tool bar, panel, status line, messages and
// dialogs. It knows which dialogs are open, and nothing else.
#pragma once

#include <optional>
#include <string>

#include "view/bars.h"
#include "view/layout.h"
#include "view/panel.h"
#include "view/state.h"

namespace raio::view {

struct ControlFacts {
  PanelFacts panel;
  ToolFacts tools;
  StatusFacts status;
  std::string read_out;  // what is under the cursor
  std::string message;
  bool is_error = false;
};

class Controls {
 public:
  void switch_help() { shows_help_ = !shows_help_; }
  /// Closes a dialog. Whether one was open.
  bool close() { return std::exchange(shows_help_, false); }

  /// A frame of it. Changes the state as it is told.
  PanelResult draw(ViewState& state, const Layout& layout, const ControlFacts& facts);

 private:
  bool shows_help_ = false;
  std::string sought_;  // in the help
};

}  // namespace raio::view
