// Scenes for POV-Ray 3.7, so that an independent program can be asked for the same picture.
#pragma once

#include <string>
#include <string_view>

#include "scene/scene.h"

namespace raio {

struct PovPicture {
  std::string name = "scene";  // of the file without suffix, for the command in its first lines
  int width = 512, height = 512;
  int depth = 5;  // levels of rays, the eye ray's included
};

/// The scene in POV-Ray's language: the shapes themselves, each number with the fewest digits that
/// read back to the same float, and the classic shading (docs/shading.md) as nearly as POV-Ray has
/// it. What it has otherwise stands in docs/verify.md. Coordinates are those of the scene, without
/// its origin. Not exported: lenses, and which side of a surface is seen.
std::string write_pov(const Scene& scene, const PovPicture& picture, std::string_view comment = {});

}  // namespace raio
