// The standard procedural scenes, implemented from their published descriptions: Haines 1987, "A
// Proposal for Standard Graphics Environments", IEEE CG&A 7(11), and the Standard Procedural
// Databases that followed.
//
// To add a scene: a function from the size to a Scene in a source file of this folder, its
// declaration in io/generate/parts.h, a line in the table of io/generate/generate.cpp.
#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "scene/scene.h"

namespace raio::core {

/// A scene that can be generated.
struct SceneRecipe {
  std::string_view name;
  int default_size;          // 0: the scene has only one size
  int max_size;              // about ten million primitives; 0: the scene has only one size
  std::string_view summary;  // one line, with the number of primitives by size N
  Scene (*make)(int size);   // unchecked: call generate_scene
};

/// All recipes, in the order of `raio generate --help`.
std::span<const SceneRecipe> scene_recipes();

/// The scene `name` with the size factor `size` (0: its default). The error is one line: an unknown
/// name, with the known ones, or a size out of range, with the range.
std::expected<Scene, Error> generate_scene(std::string_view name, int size = 0);

}  // namespace raio::core
