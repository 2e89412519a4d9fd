// Writers of files of meshes and points.
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace raio {

/// What begins a comment with the camera of data: from, at and up, the vertical angle and the one
/// across (Camera::horizontal_fov_deg).
inline constexpr std::string_view kPlyCamera = "raio camera ";

/// The scene as binary PLY. Triangles and polygons as a mesh with the colours of its vertices, and
/// normals and texture coordinates where there are any; in a scene without them its spheres, as
/// vertices with radius, colour and, where there is any, opacity. Places are those of the file that
/// the scene is from, as doubles where the scene has an origin. Colours are display values, as
/// read_ply() takes them.
std::string write_ply(const Scene& scene, std::string_view comment = {});

/// Is there a triangle or polygon for a mesh?
bool has_faces(const Scene& scene);

/// What of the scene write_ply() leaves out, in one line, as text_of() has it; empty: nothing.
std::string not_in_ply(const Scene& scene);

/// In one binary file, .glb, or as text with its numbers in it.
enum class GltfForm : uint8_t { binary, text };

/// The scene as glTF 2.0, in light of linear numbers as that has it: triangles by their materials
/// with the floats of the scene, under a node that is shifted by its origin; copies as nodes with
/// the meshes of their objects; materials of metallic-roughness; camera and lights. Triangles stand
/// for spheres, cones, ellipsoids and discs: shared ones, in the nodes of up to 10,000 of them,
/// else ones of their own. The error is a sentence: there is nothing to write, or too much, or
/// copies of which gltf_keeps_copies() is false.
std::expected<std::string, std::string> write_gltf(const Scene& scene, GltfForm form,
                                                   std::string_view comment = {});
/// Can nodes of glTF be its copies? None shears.
bool gltf_keeps_copies(const Scene& scene);
/// What of the scene write_gltf() leaves out, as not_in_ply().
std::string not_in_gltf(const Scene& scene);

}  // namespace raio
