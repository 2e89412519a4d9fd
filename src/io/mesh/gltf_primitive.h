// Vertices and triangles of glTF primitives. Internal to the reader.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/gltf_nodes.h"
#include "scene/scene.h"

namespace raio::core::gltf {

inline bool draws_triangles(const MeshPrimitive& p) { return p.mode >= 4; }

/// The position in an accessor's element i; fails beyond kFarthestPlace.
Vec3f position(const Elements& from, size_t i);
/// The colour, clamped to 0 to 1.
Rgb color(const Elements& from, size_t i);
/// Normalized; z for a zero vector.
Vec3f unit(Vec3d v);
/// Returns the position; fails beyond kFarthestPlace. `what`: its JSON pointer.
Vec3f checked(Vec3f p, std::string_view what);

class PrimitiveReader {
 public:
  PrimitiveReader(const Document& document, const Buffers& buffers, NodeTree& nodes,
                  Notices& notices)
      : document_(document), buffers_(buffers), nodes_(nodes), notices_(notices) {}

  /// The triangles, without a material: in the mesh's space, or posed and relative to `origin` if a
  /// skin places it. `what`: the JSON pointer of the primitive.
  Mesh read(const MeshPrimitive& p, const std::string& what, const PosedUse* pose, Vec3d origin);

 private:
  Mesh mesh_of(const MeshPrimitive& p, const std::string& what);
  void take_pose(Mesh& mesh, const MeshPrimitive& p, const PosedUse& pose, Vec3d origin,
                 const std::string& what);

  const Document& document_;
  const Buffers& buffers_;
  NodeTree& nodes_;
  Notices& notices_;
  std::vector<uint32_t> numbers_, named_;  // vertex indices in the mesh; kNoNormal: unused
};

}  // namespace raio::core::gltf
