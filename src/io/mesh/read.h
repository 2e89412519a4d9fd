// Readers of files of meshes and points; each is a SceneReader.
#pragma once

#include "io/read_scene.h"

namespace raio::core {

/// PLY, as text or binary: a mesh or, without faces, its vertices as spheres (docs/files.md).
std::expected<ReadScene, Diagnostics> read_ply(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

/// STL, as text or binary: flat triangles.
std::expected<ReadScene, Diagnostics> read_stl(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);
/// Whether this is the beginning of a binary STL file of this size.
bool is_binary_stl(std::string_view start, size_t size);

/// OFF as text, with optional normals, colours and texture coordinates.
std::expected<ReadScene, Diagnostics> read_off(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

/// OBJ, with colours, opacities and textures from its MTL files.
std::expected<ReadScene, Diagnostics> read_obj(const TextBuffer& bytes, std::string_view file,
                                               const ReadOptions& options);

/// glTF 2.0, as text or binary: meshes placed by nodes, base colours, textures and the first camera
/// (docs/files.md).
std::expected<ReadScene, Diagnostics> read_gltf(const TextBuffer& bytes, std::string_view file,
                                                const ReadOptions& options);

}  // namespace raio::core
