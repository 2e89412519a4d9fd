// Computations that the NFF reader and writer must share to the last bit, so that scenes survive
// writing and reading.
#pragma once

#include <array>
#include <numbers>
#include <optional>

#include "base/exact_math.h"
#include "scene/scene.h"

namespace raio::core::nff {

/// Rows of a picture whose file gives no resolution.
inline constexpr int kDefaultRows = 512;

/// Side of a pixel in the plane through `at`, P3F's unit for the lens.
inline double pixel_size(const Camera& camera) {
  const double distance = length(Vec3d(camera.at) - Vec3d(camera.from));
  const double half_angle = double(camera.fov_deg) * (std::numbers::pi / 360);
  return 2 * distance * exact_tan(half_angle) / (camera.height > 0 ? camera.height : kDefaultRows);
}

/// Distance from the eye to `at`, P3F's unit for the focus.
inline double view_distance(const Camera& camera) {
  return length(Vec3d(camera.at) - Vec3d(camera.from));
}

/// Whether these edges of a triangle are collinear. The tolerance covers the last digits of a
/// double, since decimal fractions are not exact.
inline bool in_line(Vec3d u, Vec3d v) {
  const double area = length(cross(u, v));
  return !(area > 1e-12 * length(u) * length(v));
}

/// The unit normal of the plane of three points, which are counter-clockwise seen from its tip;
/// nothing if they are collinear.
inline std::optional<Vec3f> plane_normal(Vec3d a, Vec3d b, Vec3d c) {
  if (in_line(b - a, c - a)) return std::nullopt;
  // Normalized first, so that products of large numbers do not overflow.
  return Vec3f(normalize(cross(normalize(b - a), normalize(c - a))));
}

/// The faces of a box, each counter-clockwise seen from outside: per axis the lower one, then the
/// upper one.
inline std::array<std::array<Vec3f, 4>, 6> box_faces(Vec3f lo, Vec3f hi) {
  std::array<std::array<Vec3f, 4>, 6> faces;
  for (int a = 0; a < 3; ++a) {
    const int u = (a + 1) % 3, v = (a + 2) % 3;
    for (const bool high : {false, true}) {
      std::array<Vec3f, 4>& face = faces[2 * size_t(a) + high];
      for (int i = 0; i < 4; ++i) {
        // On the lower face the other two axes, in cyclic order, run clockwise.
        const bool across = i == 1 || i == 2, along = i >= 2;
        face[size_t(i)][a] = high ? hi[a] : lo[a];
        face[size_t(i)][high ? u : v] = across ? hi[high ? u : v] : lo[high ? u : v];
        face[size_t(i)][high ? v : u] = along ? hi[high ? v : u] : lo[high ? v : u];
      }
    }
  }
  return faces;
}

/// The normal of a vertex, normalized; nothing for zero. A vector that is already normalized to
/// float precision is returned unchanged, so that writing and reading it again does not alter it.
inline std::optional<Vec3f> unit_normal(Vec3d n) {
  const double len = length(n);
  if (!(len > 0)) return std::nullopt;
  return Vec3f(std::abs(len - 1) < 1e-6 ? n : n / len);
}

}  // namespace raio::core::nff
