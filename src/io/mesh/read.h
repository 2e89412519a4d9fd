// Readers of files of meshes and points: SceneReader each.
#pragma once

#include "io/read_scene.h"

namespace raio {

/// PLY, of text or binary: a mesh, or, where there are no faces, its vertices as spheres
/// (docs/files.md).
std::expected<ReadScene, Diagnostics> read_ply(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

/// STL, of text or binary: flat triangles.
std::expected<ReadScene, Diagnostics> read_stl(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);
/// Is this the beginning of a binary STL file of so many bytes?
bool is_binary_stl(std::string_view start, size_t size);

/// OFF as text, with normals, colours and texture coordinates where it has them.
std::expected<ReadScene, Diagnostics> read_off(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

/// OBJ, with the colours, opacities and textures of the MTL files that it names.
std::expected<ReadScene, Diagnostics> read_obj(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

/// glTF 2.0, as text or binary: meshes where its nodes place them, with base colours, textures and
/// the first camera (docs/files.md).
std::expected<ReadScene, Diagnostics> read_gltf(const TextBuffer& bytes, std::string_view file,
                                                const ReadOptions& options);

}  // namespace raio
