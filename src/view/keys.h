// The keys of the window: one table for what they do, for the list on the screen and for the docs.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <span>

namespace raio::view {

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
  show_view,  // the one that the key's digit names
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

/// What is held while a key is pressed.
struct Modifiers {
  bool shift = false, ctrl = false, alt = false;  // alt: also the key with the system's sign

  friend auto operator<=>(const Modifiers&, const Modifiers&) = default;
};

struct KeySpec {
  int key;         // GLFW's number: of letters the capital, of digits the digit
  Modifiers held;  // no more and no less
  Command command;
  const char *name, *help;  // on the screen, in English; a second key for the same has none
  const char* about;        // what it does, for the help
};

std::span<const KeySpec> key_table();

/// Null where the key does nothing.
const KeySpec* find_key(int key, Modifiers held = {});
/// The first key of a command.
const KeySpec& key_of(Command command);

/// What is held for walking: -1, 0 or 1 along the camera's axes.
struct Steps {
  int right = 0, up = 0, forward = 0;

  bool any() const { return right != 0 || up != 0 || forward != 0; }
};
/// `is_held` is asked by GLFW's numbers. Letters walk only while someone looks around.
Steps walking_steps(const std::function<bool(int)>& is_held, bool is_looking);

/// What the mouse and the keys that are held do, for the help.
struct HandSpec {
  const char *name, *help;
};
std::span<const HandSpec> hand_table();

}  // namespace raio::view
