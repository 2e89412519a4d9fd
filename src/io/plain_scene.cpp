#include "io/plain_scene.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "base/hash.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

/// Materials with other colours, each stored once.
class Recolored {
 public:
  explicit Recolored(Scene& scene) : scene_(scene) {}

  MaterialId operator()(MaterialId material, Rgb color) {
    if (std::as_const(scene_).materials[material].color == color) return material;
    const auto next = MaterialId(scene_.materials.size());
    const auto [known, added] = ids_.try_emplace({material, color}, next);
    if (added) {
      Material other = std::as_const(scene_).materials[material];
      other.color = color;
      scene_.add_material(other, std::as_const(scene_).specular_of(material),
                          std::as_const(scene_).roughness_of(material));
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
    // Colours are not negative, so equal ones have equal bits except for zeros.
    size_t operator()(const Key& k) const {
      const float numbers[] = {k.color.x + 0.0f, k.color.y + 0.0f, k.color.z + 0.0f,
                               std::bit_cast<float>(k.material)};
      return hash128({reinterpret_cast<const char*>(numbers), sizeof numbers}).first;
    }
  };

  Scene& scene_;
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

size_t count_standard_surfaces(const Scene& scene) {
  return size_t(std::ranges::count_if(scene.standard_surfaces,
                                      [](const StandardSurface& s) { return s.is_standard != 0; }));
}

Scene plain_scene(const Scene& scene) {
  Scene plain = scene;
  Recolored recolored(plain);
  for_each_pool(plain, [&](PoolKind, auto&, auto& materials, auto& colors, auto& opacity) {
    for (size_t i = 0; i < colors.size(); ++i)
      materials[i] = recolored(materials[i], std::as_const(colors)[i]);
    colors.clear(), opacity.clear();
  });
  for (const Mesh& mesh : scene.meshes) append(mesh, plain);
  plain.meshes.clear();
  plain.object_names.clear(), plain.object_ranges.clear();
  plain.material_texture.clear(), plain.standard_surfaces.clear(), plain.textures.clear(),
      plain.texels.clear();
  plain.physical_lights.clear(), plain.environment.clear(), plain.environment_texels.clear();
  return plain;
}

}  // namespace raio::core
