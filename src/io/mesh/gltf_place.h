// Where nodes of glTF place things, in double: for its reader and its writer.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/placement.h"
#include "base/vec.h"
#include "io/points.h"

namespace raio::gltf {

/// As Matrix, in double.
struct Transform {
  std::array<double, 12> m;

  Vec3d point(Vec3d p) const { return vector(p) + Vec3d(m[3], m[7], m[11]); }
  Vec3d vector(Vec3d v) const {
    const auto row = [&](size_t i) { return m[i] * v.x + m[i + 1] * v.y + m[i + 2] * v.z; };
    return {row(0), row(4), row(8)};
  }
  // By the cofactors, which are the inverse transposed but for the length.
  Vec3d normal(Vec3d n) const {
    const auto row = [&](size_t i) { return Vec3d(m[i], m[i + 1], m[i + 2]); };
    return {dot(cross(row(4), row(8)), n), dot(cross(row(8), row(0)), n),
            dot(cross(row(0), row(4)), n)};
  }
  // To places relative to an origin.
  Matrix matrix(Vec3d origin = {}) const {
    Matrix out;
    for (size_t i = 0; i < 12; ++i) out[i] = float(i % 4 == 3 ? m[i] - origin[int(i / 4)] : m[i]);
    return out;
  }
  bool is_sound() const {
    const auto is_near = [](double x) { return std::abs(x) <= double(kFarthestPlace); };
    return std::ranges::all_of(m, is_near) && Placement(matrix()).is_sound();
  }
};

inline Transform operator*(const Transform& a, const Transform& b) {
  Transform out{};
  for (size_t column = 0; column < 4; ++column) {
    const Vec3d v(b.m[column], b.m[column + 4], b.m[column + 8]);
    const Vec3d to = column == 3 ? a.point(v) : a.vector(v);
    out.m[column] = to.x, out.m[column + 4] = to.y, out.m[column + 8] = to.z;
  }
  return out;
}

inline constexpr Transform kHere{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};

/// What a node says: it scales, then rotates by the quaternion x, y, z, w, then shifts.
struct NodePlace {
  Vec3d shift;
  std::array<double, 4> rotation{0, 0, 0, 1};
  Vec3d scale{1, 1, 1};
};

/// Rows as in raio::Matrix.
std::array<double, 12> placement_matrix(const NodePlace& place);

/// The quaternion, whose w is not negative, of the rotation that takes the axes to these unit
/// vectors at right angles (Shepperd 1978, "Quaternion from Rotation Matrix").
inline std::array<double, 4> rotation_to(Vec3d x, Vec3d y, Vec3d z) {
  const double four[] = {1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z, 1 - x.x - y.y + z.z,
                         1 + x.x + y.y + z.z};  // four times the squares
  const double sums[3] = {x.y + y.x, y.z + z.y, z.x + x.z};
  const double differences[3] = {y.z - z.y, z.x - x.z, x.y - y.x};
  std::array<double, 4> q;
  switch (std::ranges::max_element(four) - four) {
    case 0:
      q = {four[0], sums[0], sums[2], differences[0]};
      break;
    case 1:
      q = {sums[0], four[1], sums[1], differences[1]};
      break;
    case 2:
      q = {sums[2], sums[1], four[2], differences[2]};
      break;
    default:
      q = {differences[0], differences[1], differences[2], four[3]};
  }
  const double size =
      std::copysign(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])), q[3]);
  for (double& part : q) part /= size;
  return q;
}

/// The node of a copy; nothing where its matrix shears, which no node can.
inline std::optional<NodePlace> place_of(const Matrix& m) {
  std::array<Vec3d, 3> axes;
  NodePlace place;
  for (size_t k = 0; k < 3; ++k) {
    axes[k] = Vec3d(m[k], m[k + 4], m[k + 8]);
    place.scale[int(k)] = length(axes[k]);
    place.shift[int(k)] = m[4 * k + 3];
    axes[k] = axes[k] / place.scale[int(k)];
  }
  // Turned as far as the digits of a float go.
  constexpr double kSlack = 1e-5;
  for (size_t k = 0; k < 3; ++k)
    if (std::abs(dot(axes[k], axes[(k + 1) % 3])) > kSlack) return std::nullopt;
  if (dot(cross(axes[0], axes[1]), axes[2]) < 0) place.scale.x *= -1, axes[0] = -axes[0];
  const Vec3d z = normalize(cross(axes[0], axes[1]));
  place.rotation = rotation_to(axes[0], cross(z, axes[0]), z);
  return place;
}

}  // namespace raio::gltf
