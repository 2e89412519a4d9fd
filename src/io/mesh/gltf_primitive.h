// The vertices and triangles of the primitives of a glTF file. Internal to its reader.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/gltf_nodes.h"
#include "scene/scene.h"

namespace raio::gltf {

inline bool draws_triangles(const MeshPrimitive& p) { return p.mode >= 4; }

/// The position in element i of an accessor; fails beyond kFarthestPlace.
Vec3f position(const Elements& from, size_t i);
/// The colour, each part from 0 to 1.
Rgb color(const Elements& from, size_t i);
/// Of length 1; z where it has none.
Vec3f unit(Vec3d v);
/// The place itself; fails if it is beyond kFarthestPlace. `what`: its JSON pointer.
Vec3f checked(Vec3f p, std::string_view what);

class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, const Buffers& buffers, NodeTree& nodes,
                  Notices& notices)
      : document_(document), buffers_(buffers), nodes_(nodes), notices_(notices) {}

  /// The triangles without a material: in the space of the mesh, or in a pose, which is relative to
  /// `origin` where a skin places it. `what`: the JSON pointer of the primitive.
  Mesh read(const MeshPrimitive& p, const std::string& what, const PosedUse* pose, Vec3d origin);

 private:
  Mesh mesh_of(const MeshPrimitive& p, const std::string& what);
  void take_pose(Mesh& mesh, const MeshPrimitive& p, const PosedUse& pose, Vec3d origin,
                 const std::string& what);

  const Document& document_;
  const Buffers& buffers_;
  NodeTree& nodes_;
  Notices& notices_;
  std::vector<uint32_t> numbers_, named_;  // of vertices in a mesh; kNoNormal: none
};

}  // namespace raio::gltf
