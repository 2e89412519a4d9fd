// The help of F1: every key and what the mouse does, with a field that searches them.
#pragma once

#include <string>
#include <vector>

#include "view/layout.h"

namespace raio::view {

struct HelpLine {
  std::string keys, about;  // in the language of the screen
  bool is_mouse = false;
};

/// Those that have all words of `sought`, in any case, in the order of the tables; all of them
/// where it is empty.
std::vector<HelpLine> help_lines(const std::string& sought);

/// Draws it over the picture. Whether it stays open.
bool draw_help(const Layout& layout, std::string& sought);

}  // namespace raio::view
