// The keys of the window and its mouse actions: one table for the window itself, its help, that of
// `raio view` and the manual.
#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace raio::core::app {

enum class Command : uint8_t {
  antialiasing,
  soft_shadows,
  depth_of_field,
  gloss,
  translucency,
  motion,
  structure,
  reflection,
  refraction,
  split,
  compare,
  pause,
  panel,
  fit,
  home,
  save_png,
  save_exr,
  copy,
  show_view,  // the one named by the key's digit
  measure,
  curve,
  boxes,
  inspect,
  focus,
  walk_back,
  walk_on,
  walk_play,
  lesson,
  open,
  save_scene,
  undo,
  redo,
  theme,
  projector,
  full_screen,
  help,
  quit,
};

/// Modifiers held while a key is pressed.
struct Modifiers {
  bool shift = false, ctrl = false, alt = false;  // alt: also the system key

  friend auto operator<=>(const Modifiers&, const Modifiers&) = default;
};

struct KeySpec {
  int key;         // GLFW's code: capitals for letters, digits for digits
  Modifiers held;  // exactly these
  Command command;
  const char *name, *help;  // on the screen, in English
  const char* about;        // for the help; empty for another key of the same command
};

std::span<const KeySpec> key_table();

/// Actions of the mouse and of held keys.
struct HandSpec {
  const char *name, *help;
};
std::span<const HandSpec> hand_table();

/// A key of the help, and the other keys of its command.
std::vector<const char*> key_names(const KeySpec& key);

/// Both tables in English, for a terminal.
std::string list_of_keys();

}  // namespace raio::core::app
