// Colours of atoms, chosen by `color_by` of ReadOptions.
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/read_scene.h"

namespace raio::core {

/// The material of each atom, at least one; adds them to the scene, with the legend or the colour
/// scale. The error names the missing data of the file.
std::expected<std::vector<MaterialId>, std::string> color_atoms(const Atoms& atoms,
                                                                const ReadOptions& options,
                                                                AtomStyle style, ReadScene& to);

}  // namespace raio::core
