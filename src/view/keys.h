// The keys of the window: one table for what they do, for the list on the screen and for the docs.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

namespace raio::view {

enum class Command : uint8_t {
  antialiasing,
  soft_shadows,
  depth_of_field,
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
  quit,
};

struct KeySpec {
  int key;     // GLFW's number: of letters the capital, of digits the digit
  bool shift;  // must be held
  Command command;
  std::string_view name, help;  // on the screen; a second key for the same has none
};

std::span<const KeySpec> key_table();

/// Null where the key does nothing.
const KeySpec* find_key(int key, bool shift);

/// What is held for walking: -1, 0 or 1 along the camera's axes.
struct Steps {
  int right = 0, up = 0, forward = 0;

  bool any() const { return right != 0 || up != 0 || forward != 0; }
};
/// `is_held` is asked by GLFW's numbers. Letters walk only while someone looks around.
Steps walking_steps(const std::function<bool(int)>& is_held, bool is_looking);

/// What the mouse and the keys that are held do, for the list on the screen.
struct HandSpec {
  std::string_view name, help;
};
std::span<const HandSpec> hand_table();

}  // namespace raio::view
