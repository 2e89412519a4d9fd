// Materials and lights as tables, which the integrator `path` prepares once per picture.
#pragma once

#include <optional>
#include <vector>

#include "accel/geometry.h"
#include "integrate/energy.h"
#include "integrate/environment_distribution.h"
#include "integrate/light_tree.h"
#include "integrate/lights.h"
#include "integrate/settings.h"

namespace raio::core {

/// A material of either kind, as 32-bit words that are gathered by their offsets.
struct PathMaterial {
  float metallic = 0, roughness = 0;
  float diffuse = 1;  // scales the base colour of the diffuse lobe
  Rgb mirror;         // reflectance in addition to that of metal
  Rgb specular;       // scales the dielectric reflection
  float transmission = 0;
  float is_thin = 0;
  float ior = 1;
  float is_white = 0;  // glass: it is not tinted by the base colour
  Rgb attenuation{1, 1, 1};
  float per_attenuation_distance = 0;
  Rgb emission;
  float is_two_sided = 1;
  float normal_scale = 1;
  float clearcoat = 0, clearcoat_roughness = 0;
  Rgb sheen;
  float sheen_roughness = 0;
  // EnergyTables; `inner`: of the surface without layers, seen from inside glass.
  uint32_t conductor = 0, reflection = 0, entering = 0, leaving = 0;
  uint32_t layers = 0, inner_conductor = 0, inner_reflection = 0, inner_entering = 0;
  uint32_t metallic_roughness_texture = kNoTexture, normal_texture = kNoTexture,
           emission_texture = kNoTexture, transmission_texture = kNoTexture;
};
static_assert(sizeof(PathMaterial) % 4 == 0);

/// A triangle that emits light.
struct TriangleLight {
  Vec3f corner, edge1, edge2;
  Vec3f normal;  // unit; of the side that emits
  Rgb emission;
  float area = 0;
  float is_two_sided = 0;
  uint32_t triangle = 0;  // its index in `geometry`
  MaterialId material = 0;
  const Geometry* geometry = nullptr;
  uint32_t emission_texture = kNoTexture;
};

/// All lights of a scene, and the probability of choosing each.
class PathLights {
 public:
  PathLights(const Scene& scene, const Geometry& geometry, const std::vector<SampledLight>& lights);

  /// Lights that decrease with distance, and those that do not.
  const std::vector<SampledLight>& near() const { return near_; }
  const std::vector<TriangleLight>& triangles() const { return triangles_; }
  const std::vector<SampledLight>& distant() const { return distant_; }
  /// Null if there is no environment with texels.
  const EnvironmentDistribution* environment() const {
    return environment_ ? &*environment_ : nullptr;
  }
  bool empty() const { return kinds_ == 0; }

  struct Choice {
    enum class Kind : uint8_t { none, near, triangle, distant, environment };
    Kind kind = Kind::none;
    uint32_t index = 0;
    float probability = 0;
  };
  /// `u` in [0, 1).
  Choice choose(Vec3f point, Vec3f normal, float u) const;
  float environment_probability() const { return environment_ ? far_probability_ : 0; }
  /// Of the light triangle of a hit, and its index; nothing if the primitive is no light.
  std::optional<uint32_t> triangle_at(const Hit& hit) const;
  float triangle_probability(Vec3f point, Vec3f normal, uint32_t triangle) const;

 private:
  void add_triangles(const Geometry& geometry, const std::vector<Placement>& places,
                     InstanceId instance);

  std::vector<SampledLight> near_, distant_;
  std::vector<TriangleLight> triangles_;
  std::vector<std::pair<uint64_t, uint32_t>> numbers_;  // key of the hit, triangle; sorted
  std::optional<EnvironmentDistribution> environment_;
  std::optional<LightTree> tree_;  // of near lights, then triangles
  size_t kinds_ = 0;               // the tree, if there are lights in it, and each distant light
  float far_probability_ = 0;      // of each kind
};

/// Immutable.
struct PathScene {
  /// `lights`: those that are not in the geometry.
  PathScene(const Scene& scene, const Geometry& geometry, const std::vector<SampledLight>& lights);

  EnergyTables energy;
  std::vector<PathMaterial> materials;
  PathLights lights;
  bool any_textures = false;  // besides those of base colours and normals
  bool any_normal_maps = false;
  bool any_layers = false;
};

}  // namespace raio::core
