// Building blocks and declarations of the recipes of procedural scenes. Internal to this folder;
// others include io/generate/generate.h.
//
// Recipes compute in double and round once, when a primitive enters the scene: a recursion of ten
// levels then gives the published coordinates to their last printed digit.
#pragma once

#include <initializer_list>
#include <span>
#include <utility>

#include "scene/scene.h"

namespace raio::core {

/// A linear map, by the images of the three axes.
struct LinearMap {
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  Vec3d operator()(Vec3d v) const { return x * v.x + y * v.y + z * v.z; }
  /// First `inner`, then `outer`.
  friend LinearMap operator*(const LinearMap& outer, const LinearMap& inner) {
    return {outer(inner.x), outer(inner.y), outer(inner.z)};
  }
};

/// The right-handed rotation by `angle` about the unit vector `axis` (Rodrigues' formula).
LinearMap rotation(Vec3d axis, double angle);
LinearMap rotation(Vec3d axis, double cosine, double sine);

inline constexpr Vec3d kAxisX{1, 0, 0}, kAxisY{0, 1, 0}, kAxisZ{0, 0, 1};

/// The exponent at which a material's highlight is invisible.
inline constexpr float kNoHighlight = 100000;

/// A scene under construction. Added primitives have the material last passed to `use`.
class SceneMaker {
 public:
  /// With the sky blue and the 512 x 512 pixels of all these scenes.
  SceneMaker(Vec3d from, Vec3d at, Vec3d up, float fov_deg, float hither);

  void light(Vec3d position);
  void white_light(Vec3d position);

  /// Equal materials are stored once.
  void use(const Material& material);

  void sphere(Vec3d center, double radius);
  void cone(Vec3d base, double base_radius, Vec3d apex, double apex_radius);
  void cylinder(Vec3d from, Vec3d to, double radius) { cone(from, radius, to, radius); }

  /// A flat face of three or more vertices, counter-clockwise from outside.
  void face(std::span<const Vec3d> corners);
  void face(std::initializer_list<Vec3d> corners) { face({corners.begin(), corners.size()}); }

  /// Vertices and unit normals shared by triangles, by index.
  uint32_t position(Vec3d p);
  uint32_t normal(Vec3d n);
  void triangle(TriangleIndices positions);
  /// All triangles of a scene are smooth, or none.
  void smooth_triangle(TriangleIndices positions, TriangleIndices normals);

  /// Returns the scene; add nothing afterwards.
  Scene finish() { return std::move(scene_); }

 private:
  Scene scene_;
  MaterialId material_ = 0;
};

// Spheres, cylinders and cones: io/generate/round.cpp.
Scene make_balls(int size);
Scene make_rings(int size);
Scene make_tree(int size);
Scene make_lattice(int size);
Scene make_sphereflake(int size);
Scene make_balls_low(int);
Scene make_balls_medium(int);
Scene make_balls_high(int);

// Triangles and polygons: io/generate/flat.cpp.
Scene make_gears(int size);
Scene make_tetra(int size);
Scene make_mount(int size);
Scene make_mount_low(int);
Scene make_mount_high(int);
Scene make_mount_very_high(int);

// io/generate/teapot.cpp.
Scene make_teapot(int size);

}  // namespace raio::core
