// How the window looks: colours with a meaning, type, spacing. All else that draws asks here and
// has no colour and no size of its own.
#pragma once

#include <imgui.h>

#include <string_view>

namespace raio::view {

/// What the user chooses.
struct Theme {
  bool light = false;
  bool projector = false;  // large, heavier type and stronger contrast, for the last row of a hall

  friend bool operator==(const Theme&, const Theme&) = default;
};

struct Palette {
  ImVec4 mat;      // around the picture
  ImVec4 ground;   // of panel and bars
  ImVec4 raised;   // fields and buttons
  ImVec4 hovered;  // those under the cursor
  ImVec4 line;     // between parts
  ImVec4 text, faint;
  ImVec4 accent, on_accent;  // what is on, or chosen, and text upon it
  ImVec4 good, busy, warning, bad;
};

/// Sets style and fonts for a screen on which text is `scale` times its usual size. Between frames.
void apply_look(const Theme& look, float scale);

/// Notes the letters of a name from outside, in whatever script, when it is drawn. Those that no
/// font of this machine has are shown as "?".
void show_letters(std::string_view text);
/// Whether some were noted that the fonts lack so far; apply_look() loads them.
bool wants_letters();

const Palette& palette();
/// The height of the text in window units, of which all distances are multiples.
float em();
/// The same before any look was applied.
float em_of(const Theme& look, float scale);
ImFont* heading_font();
ImFont* title_font();

inline ImU32 color(const ImVec4& c, float alpha = 1) {
  return ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, c.w * alpha});
}

}  // namespace raio::view
