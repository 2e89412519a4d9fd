// The tool bar above the picture and the status line below it.
#pragma once

#include <string>
#include <vector>

#include "render/session.h"
#include "view/layout.h"
#include "view/measure.h"
#include "view/state.h"

namespace raio::core::view {

struct ToolFacts {
  bool can_undo = false, can_redo = false;
  bool full_screen = false;
  bool inspects = false, has_panel = false;
};

/// Appends pressed tools to `pressed`, as if by their keys.
void draw_tool_bar(const Rect& where, const ViewState& state, const ToolFacts& facts,
                   std::vector<const KeySpec*>& pressed);

/// The current activity.
struct Status {
  enum class Kind { working, moving, measuring, paused, done, failed };
  Kind kind = Kind::working;
  std::string text;
};

struct StatusFacts {
  const SessionPicture* picture = nullptr;  // the newest; may be null
  uint64_t request = 0;                     // the newest
  double since_request_s = 0;
  std::optional<SessionProgress> progress{};  // of a slow first sample
  int picture_width = 0, picture_height = 0;  // of a full picture
  bool moving = false, paused = false;
  Measuring::Work measuring = Measuring::Work::none;
};
Status status_of(const StatusFacts& facts);

/// `read_out`: what is under the cursor; empty if nothing.
void draw_status(const Rect& where, const Status& status, const std::string& read_out);

/// The position of a message: at the lower left of the picture, in as many lines as needed, above
/// the legend if both do not fit side by side.
Rect message_place(const Rect& picture, const Rect& legend, const std::string& message);
void draw_message(const Rect& place, const std::string& message, bool is_error);

}  // namespace raio::core::view
