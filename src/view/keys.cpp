#include "view/keys.h"

#include <algorithm>
#include <array>

namespace raio::view {
namespace {

// GLFW's numbers of keys that are no characters; this file is tested without GLFW.
constexpr int kSpace = 32, kEscape = 256, kHome = 268, kRight = 262, kLeft = 263, kDown = 264,
              kUp = 265;

constexpr auto kKeys = std::to_array<KeySpec>({
    {'A', false, Command::antialiasing, "a", "antialiasing"},
    {'S', false, Command::soft_shadows, "s", "soft shadows"},
    {'D', false, Command::depth_of_field, "d", "depth of field"},
    {'G', false, Command::structure, "g", "structure"},
    {'R', false, Command::reflection, "r", "reflection"},
    {'T', false, Command::refraction, "t", "refraction"},
    {'X', false, Command::split, "x", "split"},
    {'M', false, Command::measure, "m", "measure 16"},
    {kSpace, false, Command::pause, "space", "pause"},
    {'H', false, Command::panel, "h", "panel"},
    {'F', false, Command::fit, "f", "fit"},
    {'O', false, Command::home, "o", "own camera"},
    {kHome, false, Command::home, "", ""},
    {'P', false, Command::save_png, "p", "save"},
    {'P', true, Command::save_exr, "P", "save EXR"},
    {'C', false, Command::copy, "c", "copy command"},
    {'1', false, Command::show_view, "1", "picture"},
    {'2', false, Command::show_view, "2", "normals"},
    {'3', false, Command::show_view, "3", "depth"},
    {'4', false, Command::show_view, "4", "ids"},
    {'5', false, Command::show_view, "5", "materials"},
    {'6', false, Command::show_view, "6", "steps"},
    {'7', false, Command::show_view, "7", "tests"},
    {'8', false, Command::show_view, "8", "focus"},
    {'9', false, Command::show_view, "9", "samples"},
    {'Q', false, Command::quit, "q", "quit"},
    {kEscape, false, Command::quit, "", ""},
});

constexpr auto kHands = std::to_array<HandSpec>({
    {"drag", "turn about the point there"},
    {"shift or middle", "drag the scene along"},
    {"wheel", "to the point there, or away"},
    {"click", "focus on what is there;\nthen the wheel: the aperture"},
    {"ctrl and wheel", "the aperture, at any time"},
    {"right button", "look around;\nwith W A S D E Q: walk"},
    {"arrows", "walk"},
});

}  // namespace

std::span<const KeySpec> key_table() { return kKeys; }
std::span<const HandSpec> hand_table() { return kHands; }

const KeySpec* find_key(int key, bool shift) {
  const auto found = std::ranges::find_if(
      kKeys, [&](const KeySpec& k) { return k.key == key && k.shift == shift; });
  return found == kKeys.end() ? nullptr : &*found;
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

}  // namespace raio::view
