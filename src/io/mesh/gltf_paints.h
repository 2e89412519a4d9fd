// Materials of a glTF file with their textures. Internal to its reader.
#pragma once

#include <optional>
#include <vector>

#include "io/mesh/gltf_nodes.h"
#include "scene/scene.h"

namespace raio::core::gltf {

/// Maps the materials of the file to those of the scene.
class Paints {
 public:
  /// Adds the materials of meshes in use, with their textures.
  Paints(const Document& document, const Buffers& buffers, const ReadOptions& options,
         const NodeTree& nodes, Scene& scene, Notices& notices);

  MaterialId of(const MeshPrimitive& p) const { return p.material ? of_[*p.material] : plain_; }

 private:
  std::vector<MaterialId> of_;  // for materials in use
  MaterialId plain_ = 0;
};

}  // namespace raio::core::gltf
