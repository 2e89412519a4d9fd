// Look-up of the window's keys, and walking by held ones.
#pragma once

#include <functional>

#include "app/window_keys.h"

namespace raio::core::view {

using app::Command, app::HandSpec, app::KeySpec, app::Modifiers;
using app::hand_table, app::key_table;

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

}  // namespace raio::core::view
