// What a scene file says, as plain data: no pointers, no virtual calls, one pool per kind of thing
// and indices between them. Readers and generators fill it, accel/ bakes it for tracing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/box.h"
#include "base/vec.h"
#include "shape/cone.h"
#include "shape/disc.h"
#include "shape/ellipsoid.h"
#include "shape/kinds.h"
#include "shape/plane.h"
#include "shape/sphere.h"

namespace raio {

using MaterialId = uint32_t;

/// A pinhole or thin-lens camera. Right is `to_at` x `up`; `up` need not be perpendicular.
struct Camera {
  Vec3f from{0, 0, 0};
  Vec3f at{0, 0, -1};
  Vec3f up{0, 1, 0};
  float fov_deg = 45;         // vertical, from edge to edge, in (0, 180)
  float hither = 0;           // kept for writing; a ray tracer needs no front plane
  int width = 0, height = 0;  // pixels; 0: the file does not say

  // The thin lens, where the file gives one (P3F): radius and distance of the plane in focus, scene
  // units.
  std::optional<float> lens_radius, focus_distance;
};

/// The surface of `f` in NFF; see docs/shading.md for what it does with light.
struct Material {
  Rgb color{0.8f, 0.8f, 0.8f};
  float kd = 0.8f;         // diffuse part
  float ks = 0;            // highlight and mirror part
  float shine = 1;         // the highlight's cosine power
  float transmission = 0;  // T: part of the refracted ray
  float ior = 1;           // index of refraction inside

  friend bool operator==(const Material&, const Material&) = default;
};

/// A point light, which soft shadows make a square.
struct Light {
  Vec3f position;
  std::optional<Rgb> color;  // without: 1 / sqrt(number of lights), white
};

/// A triangle or polygon corner list is indices into `Scene::positions`.
using TriangleIndices = std::array<uint32_t, 3>;
inline constexpr uint32_t kNoNormal = 0xffffffffu;

/// A polygon's corners are positions[first] ... positions[first + count - 1]; count >= 4 (three
/// corners make a triangle).
struct Polygon {
  uint32_t first = 0, count = 0;
};

struct Scene {
  std::string name;  // of the file, without folder and suffix

  /// All coordinates are stored as floats relative to this point, so that a scene far from zero
  /// keeps its digits. Zero unless a reader finds the camera far away compared with what it looks
  /// at.
  Vec3d origin;

  Camera camera;
  Rgb background;
  std::vector<Light> lights;
  std::vector<Material> materials;  // never empty in a valid scene
  int samples_per_pixel = 0;        // the file's wish (P3F `spp`); 0: none

  std::vector<Plane> planes;
  std::vector<MaterialId> plane_materials;

  std::vector<Sphere> spheres;
  std::vector<MaterialId> sphere_materials;

  std::vector<Cone> cones;  // and cylinders
  std::vector<MaterialId> cone_materials;

  std::vector<Ellipsoid> ellipsoids;
  std::vector<MaterialId> ellipsoid_materials;

  std::vector<Disc> discs;
  std::vector<MaterialId> disc_materials;

  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  // unit

  std::vector<TriangleIndices> triangles;
  std::vector<MaterialId> triangle_materials;
  /// Indices into `normals`, parallel to `triangles`, or empty when no triangle is smooth. A flat
  /// triangle among smooth ones has kNoNormal three times.
  std::vector<TriangleIndices> triangle_normals;

  std::vector<Polygon> polygons;
  std::vector<MaterialId> polygon_materials;

  size_t primitive_count() const;
};

/// A pool and its materials, as members of Scene, with the name of what is in it.
template <class Shape>
struct PoolMembers {
  std::string_view name;
  std::vector<Shape> Scene::* shapes;
  std::vector<MaterialId> Scene::* materials;
};

/// All pools, named once: everything that treats them alike goes by this list.
inline constexpr std::tuple kScenePools = {
    PoolMembers{"plane", &Scene::planes, &Scene::plane_materials},
    PoolMembers{"sphere", &Scene::spheres, &Scene::sphere_materials},
    PoolMembers{"cone", &Scene::cones, &Scene::cone_materials},
    PoolMembers{"triangle", &Scene::triangles, &Scene::triangle_materials},
    PoolMembers{"polygon", &Scene::polygons, &Scene::polygon_materials},
    PoolMembers{"ellipsoid", &Scene::ellipsoids, &Scene::ellipsoid_materials},
    PoolMembers{"disc", &Scene::discs, &Scene::disc_materials},
};
template <class Shape>
inline constexpr PoolMembers<Shape> kPoolOf = std::get<PoolMembers<Shape>>(kScenePools);

/// Calls f(members) for each.
template <class F>
constexpr void for_each_pool(F&& f) {
  std::apply([&](const auto&... members) { (f(members), ...); }, kScenePools);
}

inline size_t Scene::primitive_count() const {
  size_t sum = 0;
  for_each_pool([&](auto pool) { sum += (this->*pool.shapes).size(); });
  return sum;
}

constexpr ShapeKind shape_kind(const TriangleIndices&) { return ShapeKind::triangle; }
constexpr ShapeKind shape_kind(const Polygon&) { return ShapeKind::polygon; }

/// How many primitives of each kind, indexed by ShapeKind.
std::array<size_t, kShapeKinds> count_primitives(const Scene& scene);

/// Around all primitives but infinite planes.
Box3f bounds(const Scene& scene);

/// The sum of the sizes of the pools, in bytes.
size_t memory_bytes(const Scene& scene);

/// Why a camera with finite numbers looks nowhere, or nothing.
std::string camera_problem(const Camera& camera);

/// A name of all that a picture can depend on, 32 hexadecimal digits: the same for two files that
/// differ in comments, spelling or name only. `hither` does not count.
std::string content_hash(const Scene& scene);

/// What makes a scene unfit for rendering, one sentence each, naming the element by its index;
/// empty for a sound scene. Readers report the same with line and column before it comes to this;
/// scenes made in code meet it first. Checks that all numbers are finite, sizes positive, indices
/// in range, pools of equal length, and that the camera has a direction.
std::vector<std::string> validate(const Scene& scene);

}  // namespace raio
