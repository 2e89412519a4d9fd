// Traverses the nodes of a glTF file. Internal to its reader.
#pragma once

#include <optional>
#include <vector>

#include "io/mesh/gltf.h"
#include "io/mesh/gltf_place.h"

namespace raio::core::gltf {

/// A mesh, camera or light with its transformation.
struct Use {
  uint32_t number = 0;
  Transform place;
};

/// A posed mesh, with its own morph weights and a skin, which places it (glTF 2.0, 3.7.2.2 and
/// 3.7.3.1).
struct PosedUse : Use {
  const std::vector<double>* weights = nullptr;
  Index skin;
};

/// The nodes of the default scene. The constructor adds notices about skipped data and throws
/// ReadFailure if the nodes are not a tree.
class NodeTree {
 public:
  NodeTree(const Document& document, const Buffers& buffers, MemoryCount& memory, Notices& notices);

  const std::vector<Use>& meshes() const { return meshes_; }
  const std::vector<PosedUse>& posed() const { return posed_; }
  const std::vector<Use>& cameras() const { return cameras_; }
  const std::vector<Use>& lights() const { return lights_; }

  /// The transformation from mesh to scene of each joint of a skin.
  const std::vector<Transform>& bones_of(uint32_t number);

 private:
  void add_mesh_uses(uint32_t number);
  std::vector<Transform> copies_of(uint32_t number) const;

  const Document& document_;
  const Buffers& buffers_;
  MemoryCount& memory_;
  Notices& notices_;
  std::vector<Use> meshes_, cameras_, lights_;
  std::vector<PosedUse> posed_;
  std::vector<std::vector<Transform>> bones_;     // by skin, computed on first use
  std::vector<std::optional<Transform>> places_;  // by node; none outside the scene
};

/// A camera at this transformation, directed at the scene; nothing if it would see nothing.
std::optional<Camera> camera_through(const Lens& lens, const Transform& place, const Scene& scene);

}  // namespace raio::core::gltf
