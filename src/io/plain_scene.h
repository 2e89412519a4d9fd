// Scenes in the words of formats that know materials and triangles only.
#pragma once

#include "scene/scene.h"

namespace raio {

/// Is the scene one already?
bool is_plain(const Scene& scene);

/// The scene that looks the same with colours of primitives made materials and meshes made
/// triangles of the scene. Without what text_of() says of kNotPlain.
Scene plain_scene(const Scene& scene);

inline constexpr std::initializer_list<Feature> kNotPlain = {
    Feature::opacity, Feature::vertex_colors, Feature::texture_coordinates, Feature::textures,
    Feature::object_names};

}  // namespace raio
