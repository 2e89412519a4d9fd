// Writers of files of meshes and points.
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace raio::core {

/// The start of a comment with the camera: from, at and up, the vertical angle and the horizontal
/// one (Camera::horizontal_fov_deg).
inline constexpr std::string_view kPlyCamera = "raio camera ";

/// The scene as binary PLY. Triangles and polygons become a mesh with vertex colours and optional
/// normals and texture coordinates. A scene without them writes its spheres as vertices with
/// radius, colour and, if present, opacity. Positions are those of the scene's file, as doubles if
/// the scene has an origin. Colours are display values, as read_ply() expects them.
std::string write_ply(const Scene& scene, std::string_view comment = {});

/// Whether the scene has a triangle or polygon.
bool has_faces(const Scene& scene);

/// Features that write_ply() loses, in one line, as from text_of(); empty: none.
std::string not_in_ply(const Scene& scene);

/// One binary .glb file, or text with embedded buffers.
enum class GltfForm : uint8_t { binary, text };

/// The scene as glTF 2.0 in linear light: triangles grouped by material, with the scene's floats,
/// under a root node translated by its origin; instances as nodes with their object's meshes;
/// metallic-roughness materials; camera and lights. Spheres, cones, ellipsoids and discs become
/// triangles: up to 10,000 of them share meshes through nodes, more have their own triangles. The
/// error is a sentence: nothing to write, too much, or instances for which gltf_keeps_copies() is
/// false.
std::expected<std::string, std::string> write_gltf(const Scene& scene, GltfForm form,
                                                   std::string_view comment = {});
/// Whether nodes can express all instances, that is, none shears.
bool gltf_keeps_copies(const Object& scene);
/// Features that write_gltf() loses, as not_in_ply().
std::string not_in_gltf(const Scene& scene);

}  // namespace raio::core
