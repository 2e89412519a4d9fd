// Converts materials to glTF; internal to its writer.
#pragma once

#include <nlohmann/json.hpp>

#include "io/mesh/gltf_parts.h"

namespace raio::core::gltf {

/// A standard surface as it is, else the metallic-roughness material with the same reflectance.
/// Texture indices are those of the scene.
nlohmann::json material_of(const Scene& scene, const GltfAppearance& look);

}  // namespace raio::core::gltf
