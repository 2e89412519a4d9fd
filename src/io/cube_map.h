// Reads skies: folders of six pictures.
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "scene/cube_map.h"

namespace raio::core {

/// Reads right, left, top, bottom, front and back, each .jpg, .jpeg or .png in lower or upper case;
/// of several the first of these. Faces are square and equally large, at most kLargestFace texels
/// per side; 16 bits become 8, and alpha is dropped. The map's folder is `name`, or the path if
/// that is empty. The error (bad_input, or no_resource) names the faces, what was found and what
/// was expected. The files are not trusted.
std::expected<std::shared_ptr<const CubeMap>, Error> read_cube_map(
    const std::filesystem::path& folder, std::string_view name = {});

inline constexpr int kLargestFace = 16384;

/// Finds the folder named by a scene file: in the file's folder, or in the nearest parent that has
/// one of that name. Empty if there is none.
std::filesystem::path find_sky(std::string_view folder, const std::filesystem::path& scene);

}  // namespace raio::core
