// Skies: folders of six pictures to CubeMap.
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "scene/cube_map.h"

namespace raio {

/// Reads right, left, top, bottom, front and back, each .jpg, .jpeg or .png in small or capital
/// letters, the first of these where there are several. They are square and equally large, of at
/// most kLargestFace texels a side; 16 bits become 8, and alpha is dropped. The map's folder is
/// `name`, or the path where that is empty. The error (bad_input, or no_resource) names the faces,
/// what was found and what was expected. The files need not be trusted.
std::expected<std::shared_ptr<const CubeMap>, Error> read_cube_map(
    const std::filesystem::path& folder, std::string_view name = {});

inline constexpr int kLargestFace = 16384;

/// The folder that a scene file means: in the file's own folder, or in the nearest above that has
/// one of that name. Empty: there is none.
std::filesystem::path find_sky(std::string_view folder, const std::filesystem::path& scene);

}  // namespace raio
