// What the NFF reader and writer must compute with the same bits, so that what one writes the other
// reads back.
#pragma once

#include <array>
#include <numbers>
#include <optional>

#include "scene/scene.h"

namespace raio::nff {

/// Rows of a picture whose file gives no resolution.
inline constexpr int kDefaultRows = 512;

/// The side of a pixel in the plane through `at`: P3F measures the lens in these.
inline double pixel_size(const Camera& camera) {
  const double distance = length(Vec3d(camera.at) - Vec3d(camera.from));
  const double half_angle = double(camera.fov_deg) * (std::numbers::pi / 360);
  return 2 * distance * std::tan(half_angle) / (camera.height > 0 ? camera.height : kDefaultRows);
}

/// The distance from the eye to the point looked at: P3F measures the focus in these.
inline double view_distance(const Camera& camera) {
  return length(Vec3d(camera.at) - Vec3d(camera.from));
}

/// Are these edges of a triangle in line? Decimal fractions are not exact, hence the last digits of
/// a double are left out.
inline bool in_line(Vec3d u, Vec3d v) {
  const double area = length(cross(u, v));
  return !(area > 1e-12 * length(u) * length(v));
}

/// The unit normal of the plane of three points, from whose tip they run counter-clockwise; nothing
/// if they are in line.
inline std::optional<Vec3f> plane_normal(Vec3d a, Vec3d b, Vec3d c) {
  if (in_line(b - a, c - a)) return std::nullopt;
  // At unit length first: products of large numbers stay in range.
  return Vec3f(normalize(cross(normalize(b - a), normalize(c - a))));
}

/// The sides of a box, their corners counter-clockwise as seen from outside: per axis the low side
/// and the high one.
inline std::array<std::array<Vec3f, 4>, 6> box_faces(Vec3f lo, Vec3f hi) {
  std::array<std::array<Vec3f, 4>, 6> faces;
  for (int a = 0; a < 3; ++a) {
    const int u = (a + 1) % 3, v = (a + 2) % 3;
    for (const bool high : {false, true}) {
      std::array<Vec3f, 4>& face = faces[2 * size_t(a) + high];
      for (int i = 0; i < 4; ++i) {
        // On the low side the other two axes in turn run clockwise.
        const bool across = i == 1 || i == 2, along = i >= 2;
        face[size_t(i)][a] = high ? hi[a] : lo[a];
        face[size_t(i)][high ? u : v] = across ? hi[high ? u : v] : lo[high ? u : v];
        face[size_t(i)][high ? v : u] = along ? hi[high ? v : u] : lo[high ? v : u];
      }
    }
  }
  return faces;
}

/// A corner's normal at unit length; nothing for zero. One that has unit length but for the
/// rounding of a float stays as it is, so that it can be written and read any number of times.
inline std::optional<Vec3f> unit_normal(Vec3d n) {
  const double len = length(n);
  if (!(len > 0)) return std::nullopt;
  return Vec3f(std::abs(len - 1) < 1e-6 ? n : n / len);
}

}  // namespace raio::nff
