// The colours of atoms, by what `color_by` of ReadOptions names.
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "io/atoms/atoms.h"
#include "io/read_scene.h"

namespace raio {

/// The materials of the atoms, of which there is at least one; adds them to the scene, with their
/// legend or the scale of their numbers. The error says what the file does not have.
std::expected<std::vector<MaterialId>, std::string> color_atoms(const Atoms& atoms,
                                                                const ReadOptions& options,
                                                                AtomStyle style, ReadScene& to);

}  // namespace raio
