// Materials as glTF has them, internal to its writer.
#pragma once

#include <nlohmann/json.hpp>

#include "io/mesh/gltf_parts.h"

namespace raio::gltf {

/// The material of metallic-roughness that reflects as much light. Textures have the numbers that
/// they have in the scene.
nlohmann::json material_of(const Scene& scene, const GltfAppearance& look);

}  // namespace raio::gltf
