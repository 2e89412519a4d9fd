// The standard procedural scenes, made from their published descriptions: Haines 1987, "A Proposal
// for Standard Graphics Environments", IEEE CG&A 7(11), and the Standard Procedural Databases that
// followed.
//
// To add a scene: a function from the size to a Scene in one of the generate_*.cpp, its declaration
// in io/generate/parts.h, a line in the table of io/generate/generate.cpp.
#pragma once

#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "scene/scene.h"

namespace raio {

/// A scene that can be generated.
struct SceneRecipe {
  std::string_view name;
  int default_size;          // 0: the scene has one size
  int max_size;              // about ten million primitives; 0: the scene has one size
  std::string_view summary;  // one line for people, with the number of primitives by size N
  Scene (*make)(int size);   // unchecked: callers want generate_scene
};

/// All recipes, in the order of `raio generate --help`.
std::span<const SceneRecipe> scene_recipes();

/// The scene `name` of size factor `size` (0: its default). The error is one line: an unknown name,
/// with the names there are, or a size out of range, with the range.
std::expected<Scene, Error> generate_scene(std::string_view name, int size = 0);

}  // namespace raio
