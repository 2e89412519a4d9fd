// Draws the blocks of a page: headings, text, lists, tables, formulas, and commands with buttons.
#pragma once

#include <optional>
#include <string>

#include "app/shown_scene.h"
#include "view/lesson.h"
#include "view/page_pictures.h"

namespace raio::core::view {

/// Buttons and links that the user pressed.
struct PageEvents {
  std::optional<app::ShownScene> show;
  std::optional<std::string> page;    // another lesson
  std::optional<std::string> copied;  // for the clipboard
};

/// Draws them at the cursor, as wide as the window.
void draw_blocks(const Blocks& blocks, PagePictures& pictures, PageEvents& events);

}  // namespace raio::core::view
