// The window's appearance: colours by meaning, fonts, spacing. All drawing code takes its colours
// and sizes from here.
#pragma once

#include <imgui.h>

#include <string_view>

namespace raio::core::view {

/// The user's choices.
struct Theme {
  bool light = false;
  bool projector = false;  // larger, heavier type and stronger contrast, for the back row

  friend bool operator==(const Theme&, const Theme&) = default;
};

struct Palette {
  ImVec4 mat;      // around the picture
  ImVec4 ground;   // of panel and bars
  ImVec4 raised;   // fields and buttons
  ImVec4 hovered;  // the same under the cursor
  ImVec4 line;     // between parts
  ImVec4 text, faint;
  ImVec4 accent, on_accent;  // what is on, or selected, and text on it
  ImVec4 good, busy, warning, bad;
};

/// Sets style and fonts for a screen with text at `scale` times its usual size. Between frames.
void apply_look(const Theme& look, float scale);

/// Registers the letters of an external name, in any script, when it is drawn. Those without a font
/// are shown as "?".
void show_letters(std::string_view text);
/// Whether registered letters are missing from the fonts; apply_look() loads them.
bool wants_letters();

const Palette& palette();
/// The text height in window units, the base of all distances.
float em();
/// The same before a theme was applied.
float em_of(const Theme& look, float scale);
ImFont* heading_font();
ImFont* title_font();
ImFont* code_font();  // all of its letters have the same width, if the system has such a font

inline ImU32 color(const ImVec4& c, float alpha = 1) {
  return ImGui::ColorConvertFloat4ToU32({c.x, c.y, c.z, c.w * alpha});
}

}  // namespace raio::core::view
