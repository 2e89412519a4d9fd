// Writers of files of meshes and points.
#pragma once

#include <string>
#include <string_view>

#include "scene/scene.h"

namespace raio {

/// What begins a comment with the camera of data: from, at and up, the vertical angle and the one
/// across (Camera::across_deg).
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

}  // namespace raio
