// Parses the materials of a glTF file. Internal to its reader.
#pragma once

#include "io/mesh/gltf.h"
#include "io/mesh/gltf_json.h"

namespace raio::core::gltf {

/// `textures`: the number of textures in the file. Notices report textures that Paint has no room
/// for.
Paint paint_of(const Value& material, size_t textures, Notices& notices);

}  // namespace raio::core::gltf
