// Readers of files of meshes and points: SceneReader each.
#pragma once

#include "io/read_scene.h"

namespace raio {

/// PLY, of text or binary: a mesh, or, where there are no faces, its vertices as spheres
/// (docs/files.md).
std::expected<ReadScene, Diagnostics> read_ply(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

}  // namespace raio
