#include "view/keys.h"

#include <algorithm>

namespace raio::core::view {
namespace {

// GLFW's codes; this file is tested without GLFW.
constexpr int kRight = 262, kLeft = 263, kDown = 264, kUp = 265;

}  // namespace

const KeySpec* find_key(int key, Modifiers held) {
  const auto found = std::ranges::find_if(
      key_table(), [&](const KeySpec& k) { return k.key == key && k.held == held; });
  return found == key_table().end() ? nullptr : &*found;
}

const KeySpec& key_of(Command command) {
  return *std::ranges::find(key_table(), command, &KeySpec::command);
}

Steps walking_steps(const std::function<bool(int)>& is_held, bool is_looking) {
  const auto pair = [&](int forth, int back) { return int(is_held(forth)) - int(is_held(back)); };
  Steps steps;
  steps.right = pair(kRight, kLeft);
  steps.forward = pair(kUp, kDown);
  if (!is_looking) return steps;
  steps.right += pair('D', 'A');
  steps.forward += pair('W', 'S');
  steps.up = pair('E', 'Q');
  return steps;
}

}  // namespace raio::core::view
