// Where the nodes of a glTF file place its meshes and cameras. Internal to its reader.
#pragma once

#include <optional>
#include <vector>

#include "io/mesh/gltf.h"
#include "io/mesh/gltf_place.h"

namespace raio::gltf {

/// A mesh or camera where a node places it.
struct Use {
  uint32_t number = 0;
  Transform place;
};

/// A mesh in a pose of its own: with the weights of its morph targets, and with its skin, which
/// places it (glTF 2.0, 3.7.2.2 and 3.7.3.1).
struct PosedUse : Use {
  const std::vector<double>* weights = nullptr;
  Index skin;
};

/// The nodes of the scene that is shown. What the constructor leaves out it tells; it throws
/// ReadFailure where the nodes are no tree.
class NodeTree {
 public:
  NodeTree(const Document& document, const Buffers& buffers, MemoryCount& memory, Notices& notices);

  const std::vector<Use>& meshes() const { return meshes_; }
  const std::vector<PosedUse>& posed() const { return posed_; }
  const std::vector<Use>& cameras() const { return cameras_; }

  /// From the mesh to the scene, for each joint of a skin by its number.
  const std::vector<Transform>& bones_of(uint32_t number);

 private:
  void add_mesh_uses(uint32_t number);
  std::vector<Transform> copies_of(uint32_t number) const;

  const Document& document_;
  const Buffers& buffers_;
  MemoryCount& memory_;
  Notices& notices_;
  std::vector<Use> meshes_, cameras_;
  std::vector<PosedUse> posed_;
  std::vector<std::vector<Transform>> bones_;     // of each skin, once they are asked for
  std::vector<std::optional<Transform>> places_;  // of the nodes that the scene has
};

/// The camera with a lens in a place, which looks at the scene; nothing: it would see nothing.
std::optional<Camera> camera_through(const Lens& lens, const Transform& place, const Scene& scene);

}  // namespace raio::gltf
