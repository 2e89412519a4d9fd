// Scenes for formats with only materials and triangles.
#pragma once

#include "scene/scene.h"

namespace raio::core {

/// Whether the scene is already plain.
bool is_plain(const Scene& scene);

/// A scene of the same appearance: colours of primitives become materials, meshes become triangles
/// of the scene. Without the features that text_of() names for kNotPlain.
Scene plain_scene(const Scene& scene);

/// The number of materials with the parameters of glTF, which a plain scene has not, either.
size_t count_standard_surfaces(const Scene& scene);

inline constexpr std::initializer_list<Feature> kNotPlain = {
    Feature::opacity,    Feature::vertex_colors, Feature::texture_coordinates,
    Feature::textures,   Feature::object_names,  Feature::physical_lights,
    Feature::environment};

}  // namespace raio::core
