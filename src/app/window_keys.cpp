#include "app/window_keys.h"

#include <fmt/ranges.h>

#include <array>
#include <utility>

#include "app/help.h"

namespace raio::core::app {
namespace {

// GLFW's codes of non-character keys; this file is tested without GLFW.
constexpr int kSpace = 32, kEnter = 257, kEscape = 256, kHome = 268, kF1 = 290, kF2 = 291,
              kF3 = 292, kF11 = 300;

constexpr Modifiers kShift{.shift = true}, kCtrl{.ctrl = true},
    kCtrlShift{.shift = true, .ctrl = true};

constexpr auto kKeys = std::to_array<KeySpec>({
    {'A', {}, Command::antialiasing, "a", "antialiasing", "Antialiasing, on and off"},
    {'S', {}, Command::soft_shadows, "s", "soft shadows", "Soft shadows, on and off"},
    {'D', {}, Command::depth_of_field, "d", "depth of field", "Depth of field, on and off"},
    {'G',
     {},
     Command::structure,
     "g",
     "structure",
     "Next acceleration structure: bvh, grid, embree, none"},
    {'R', {}, Command::reflection, "r", "reflection", "Reflection, on and off"},
    {'T', {}, Command::refraction, "t", "refraction", "Refraction, on and off"},
    {'R', kShift, Command::gloss, "R", "gloss", "Gloss: rough mirrors, on and off"},
    {'T', kShift, Command::translucency, "T", "translucency",
     "Translucency: rough glass, on and off"},
    {'V', {}, Command::motion, "v", "motion blur", "Motion blur, on and off"},
    {'X',
     {},
     Command::split,
     "x",
     "split view",
     "Split view: with and without the effect switched last; drag the bar. While comparing: both "
     "pictures, "
     "or their differences"},
    {kF3,
     {},
     Command::compare,
     "F3",
     "compare",
     "Compares with a picture of another program, such as yours; again: ends it"},
    {'M',
     {},
     Command::measure,
     "m",
     "measure 16",
     "Measures all combinations of effects in the background; again: stops"},
    {'K',
     {},
     Command::boxes,
     "k",
     "show boxes",
     "The structure's boxes over the picture: cells of the grid, nodes of the tree"},
    {'I',
     {},
     Command::inspect,
     "i",
     "inspect rays",
     "Shows the rays of the next pixel clicked; again: cancels"},
    {'E',
     {},
     Command::focus,
     "e",
     "focus",
     "Focus tool: a click focuses, the wheel sets the aperture; again: leaves it"},
    {',', {}, Command::walk_back, ",", "step back", "In the ray inspector: one step back"},
    {'.', {}, Command::walk_on, ".", "step forward", "In the ray inspector: one step forward"},
    {kEnter,
     {},
     Command::walk_play,
     "enter",
     "play steps",
     "In the ray inspector: plays the steps, and stops"},
    {'N',
     {},
     Command::curve,
     "n",
     "measure grids",
     "Measures grids from coarse to fine in the background; again: stops"},
    {kSpace, {}, Command::pause, "space", "pause", "Pauses and resumes refining"},
    {'H', {}, Command::panel, "h", "panel", "Hides or shows the panel"},
    {'F', {}, Command::fit, "f", "fit", "Moves back until the whole scene fits"},
    {'O', {}, Command::home, "o", "own camera", "The scene's own camera"},
    {kHome, {}, Command::home, "Home", "", ""},
    {'P', {}, Command::save_png, "p", "save picture", "Saves the picture as PNG"},
    {'P', kShift, Command::save_exr, "P", "save EXR", "Saves the picture as EXR"},
    {'C', {}, Command::copy, "c", "copy command", "Copies the command line of this picture"},
    {'1', {}, Command::show_view, "1", "picture", "The picture"},
    {'2', {}, Command::show_view, "2", "normals", "View: normals as colours"},
    {'3', {}, Command::show_view, "3", "depth", "View: depth"},
    {'4', {}, Command::show_view, "4", "ids", "View: a colour for each primitive"},
    {'5', {}, Command::show_view, "5", "materials", "View: a colour for each material"},
    {'6', {}, Command::show_view, "6", "steps", "View: nodes or cells visited by each ray"},
    {'7', {}, Command::show_view, "7", "tests", "View: primitives tested by each ray"},
    {'8', {}, Command::show_view, "8", "focus", "View: what is in focus"},
    {'9', {}, Command::show_view, "9", "samples", "View: samples of each pixel"},
    {kF2,
     {},
     Command::lesson,
     "F2",
     "lesson",
     "A lesson of the course beside the picture; again: closes it"},
    {'O', kCtrl, Command::open, "Ctrl+O", "open", "Opens a scene"},
    {'S', kCtrl, Command::save_scene, "Ctrl+S", "save scene",
     "Saves the scene with its camera, background, lights and materials"},
    {'Z', kCtrl, Command::undo, "Ctrl+Z", "undo", "Undoes the last change"},
    {'Y', kCtrl, Command::redo, "Ctrl+Y", "redo", "Redoes the change undone last"},
    {'Z', kCtrlShift, Command::redo, "Ctrl+Shift+Z", "", ""},
    {'L', {}, Command::theme, "l", "light or dark", "Light or dark window"},
    {'B', {}, Command::projector, "b", "big type", "Projector mode: big type, on and off"},
    {kF11, {}, Command::full_screen, "F11", "full screen", "Full screen, on and off"},
    {kF1, {}, Command::help, "F1", "help", "Keys and mouse, with search"},
    {'Q', {}, Command::quit, "q", "quit", "Quits"},
    {kEscape,
     {},
     Command::quit,
     "Esc",
     "close",
     "Closes what is open: help, a dialog, the ray inspector, full screen; then quits"},
});

constexpr auto kHands = std::to_array<HandSpec>({
    {"drag", "Orbits about the point under the cursor; data, about its middle"},
    {"shift or middle button", "Drags the scene"},
    {"wheel", "Moves towards the point under the cursor, or away"},
    {"click", "Selects what is under the cursor, and tells what it is"},
    {"ctrl and click", "Selects up to four: distance, angle, dihedral angle"},
    {"double click", "Turns about that point; beside the scene: as before"},
    {"shift and click", "Shows the rays of the pixel"},
    {"i, then shift and drag", "Shows the rays of a region or a row of pixels"},
    {"ctrl and wheel", "The aperture, at any time"},
    {"right button", "Looks around; with W A S D E Q: walks"},
    {"arrows", "Walk"},
    {"drop a file", "Opens a scene, or compares with a picture"},
});

}  // namespace

std::span<const KeySpec> key_table() { return kKeys; }
std::span<const HandSpec> hand_table() { return kHands; }

std::vector<const char*> key_names(const KeySpec& key) {
  std::vector<const char*> names = {key.name};
  for (const KeySpec& other : kKeys)
    if (other.command == key.command && !*other.about) names.push_back(other.name);
  return names;
}

std::string list_of_keys() {
  std::vector<std::pair<std::string, std::string>> keys, hands;
  for (const KeySpec& key : kKeys)
    if (*key.about)
      keys.emplace_back(fmt::format("{}", fmt::join(key_names(key), ", ")), key.about);
  for (const HandSpec& hand : kHands) hands.emplace_back(hand.name, hand.help);
  return fmt::format("Keys in the window:\n{}\nMouse:\n{}", two_columns(keys), two_columns(hands));
}

}  // namespace raio::core::app
