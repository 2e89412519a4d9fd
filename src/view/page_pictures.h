// The pictures of the course's pages, loaded when they are first drawn.
#pragma once

#include <imgui.h>

#include <expected>
#include <filesystem>
#include <map>
#include <string>

#include "io/image/image.h"
#include "view/stage.h"

namespace raio::core::view {

/// Reads a picture of read_image(), or draws an SVG on white, with two pixels for each of its own.
/// The error is one line.
std::expected<Image, std::string> read_page_picture(const std::filesystem::path& file);

class PagePictures {
 public:
  struct Entry {
    Texture texture;  // empty: the file has no picture
    float width = 0, height = 0;
  };

  /// Reads a file at the first call.
  const Entry& of(const std::filesystem::path& file);

  /// Draws the picture as an item of the given width; while it is off the screen, only leaves room
  /// for it. A missing picture is shown as its description.
  void draw(const std::filesystem::path& file, const std::string& description, float width);

 private:
  std::map<std::filesystem::path, Entry> entries_;
};

}  // namespace raio::core::view
