// The keys of the window: one table for their actions, the on-screen list and the docs.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <span>

namespace raio::core::view {

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
  walk_back,
  walk_on,
  walk_play,
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
  const char *name, *help;  // on the screen, in English; empty for a second key of the same command
  const char* about;        // for the help
};

std::span<const KeySpec> key_table();

/// Null if the key does nothing.
const KeySpec* find_key(int key, Modifiers held = {});
/// The first key of a command.
const KeySpec& key_of(Command command);

/// Walking directions: -1, 0 or 1 along the camera's axes.
struct Steps {
  int right = 0, up = 0, forward = 0;

  bool any() const { return right != 0 || up != 0 || forward != 0; }
};
/// `is_held` takes GLFW's codes. Letters walk only while the right button is held.
Steps walking_steps(const std::function<bool(int)>& is_held, bool is_looking);

/// Actions of the mouse and of held keys, for the help.
struct HandSpec {
  const char *name, *help;
};
std::span<const HandSpec> hand_table();

}  // namespace raio::core::view
