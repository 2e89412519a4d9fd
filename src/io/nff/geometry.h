// What the NFF reader and writer must compute with the same bits, so that what one writes the other
// reads back.
#pragma once

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

/// A corner's normal at unit length; nothing for zero. One that has unit length but for the
/// rounding of a float stays as it is, so that it can be written and read any number of times.
inline std::optional<Vec3f> unit_normal(Vec3d n) {
  const double len = length(n);
  if (!(len > 0)) return std::nullopt;
  return Vec3f(std::abs(len - 1) < 1e-6 ? n : n / len);
}

}  // namespace raio::nff
