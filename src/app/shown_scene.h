// The scene and options of a command line, so that the window can show them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/read_scene.h"
#include "render/options.h"

namespace raio::core::app {

struct ShownScene {
  std::string scene;      // file, as it was given
  RenderOptions options;  // without those of size, file and threads, which the window chooses
  ReadOptions read = kForPictures;
  std::optional<std::array<int, 2>> pixel = {};  // that `raio explain` explains: column, row
  std::optional<std::array<int, 2>> size = {};   // of the picture with that pixel, if given

  friend bool operator==(const ShownScene&, const ShownScene&) = default;
};

/// For the words after "raio": those of `view`, `render` or `explain` with one scene. Nothing for
/// other commands, for several scenes or pictures, and for options that are invalid or not of the
/// window. Nothing is run.
std::optional<ShownScene> shown_scene(const std::vector<std::string>& words);

}  // namespace raio::core::app
