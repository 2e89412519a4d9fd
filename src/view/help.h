// The help of F1: every key and mouse action, with a search field.
#pragma once

#include <string>
#include <vector>

#include "view/layout.h"

namespace raio::core::view {

struct HelpLine {
  std::string keys, about;  // in the window's language
  bool is_mouse = false;
};

/// The lines that match all words of `sought`, in any case, in the order of the tables; all lines
/// if it is empty.
std::vector<HelpLine> help_lines(const std::string& sought);

/// Draws it over the picture; returns whether it stays open.
bool draw_help(const Layout& layout, std::string& sought);

}  // namespace raio::core::view
