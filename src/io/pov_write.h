// Exports scenes to POV-Ray 3.7, so that an independent program can render the same picture.
#pragma once

#include <string>
#include <string_view>

#include "scene/scene.h"

namespace raio::core {

struct PovPicture {
  std::string name = "scene";  // of the file without suffix, for the command in its first lines
  int width = 512, height = 512;
  int depth = 5;  // levels of rays, including the eye ray
};

/// The scene in POV-Ray's language: the shapes themselves, with the shortest numbers that read back
/// to the same float, and the classic shading (docs/shading.md) as closely as POV-Ray can. The
/// differences are in docs/verify.md. Coordinates are relative to the scene's origin. Not exported:
/// lenses, and which side of a surface is visible.
std::string write_pov(const Scene& scene, const PovPicture& picture, std::string_view comment = {});

}  // namespace raio::core
