#include "io/plain_scene.h"

#include <bit>
#include <unordered_map>

#include "base/hash.h"
#include "scene/columns.h"

namespace raio {
namespace {

/// A material with another colour, each once.
class Recolored {
 public:
  explicit Recolored(Array<Material>& materials) : materials_(materials) {}

  MaterialId operator()(MaterialId material, Rgb color) {
    if (materials_[material].color == color) return material;
    const auto [known, added] = ids_.try_emplace({material, color}, MaterialId(materials_.size()));
    if (added) {
      Material other = materials_[material];
      other.color = color;
      materials_.push_back(other);
    }
    return known->second;
  }

 private:
  struct Key {
    MaterialId material;
    Rgb color;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct KeyHash {
    // Colours are not negative, so equal ones have equal bits but for zeros.
    size_t operator()(const Key& k) const {
      const float numbers[] = {k.color.x + 0.0f, k.color.y + 0.0f, k.color.z + 0.0f,
                               std::bit_cast<float>(k.material)};
      return hash128({reinterpret_cast<const char*>(numbers), sizeof numbers}).first;
    }
  };

  Array<Material>& materials_;
  std::unordered_map<Key, MaterialId, KeyHash> ids_;
};

constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};

TriangleIndices moved(TriangleIndices indices, size_t by) {
  for (uint32_t& i : indices)
    if (i != kNoNormal) i += uint32_t(by);
  return indices;
}

void append(const Mesh& mesh, Scene& to) {
  const auto& normals = mesh.normal_indices.empty() ? mesh.triangles : mesh.normal_indices;
  const bool smooth = !mesh.normals.empty();
  if (smooth || !to.triangle_normals.empty())
    to.triangle_normals.resize(to.triangles.size(), kFlat);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (smooth)
      to.triangle_normals.push_back(moved(normals[i], to.normals.size()));
    else if (!to.triangle_normals.empty())
      to.triangle_normals.push_back(kFlat);
    to.triangles.push_back(moved(mesh.triangles[i], to.positions.size()));
    to.triangle_materials.push_back(mesh.materials[mesh.materials.size() == 1 ? 0 : i]);
  }
  to.positions.insert(to.positions.end(), mesh.positions.begin(), mesh.positions.end());
  to.normals.insert(to.normals.end(), mesh.normals.begin(), mesh.normals.end());
}

}  // namespace

bool is_plain(const Scene& scene) { return !any_colors(scene) && scene.meshes.empty(); }

Scene plain_scene(const Scene& scene) {
  Scene plain = scene;
  Recolored recolored(plain.materials);
  for_each_pool(plain, [&](PoolKind, auto&, Array<MaterialId>& materials, Array<Rgb>& colors,
                           Array<float>& opacity) {
    for (size_t i = 0; i < colors.size(); ++i)
      materials[i] = recolored(materials[i], std::as_const(colors)[i]);
    colors.clear(), opacity.clear();
  });
  for (const Mesh& mesh : scene.meshes) append(mesh, plain);
  plain.meshes.clear();
  plain.object_names.clear(), plain.object_ranges.clear();
  return plain;
}

}  // namespace raio
