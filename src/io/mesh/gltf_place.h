// Transformations of glTF nodes in double, for reader and writer.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/placement.h"
#include "base/vec.h"
#include "io/points.h"

namespace raio::core::gltf {

/// Like Matrix, in double.
struct Transform {
  std::array<double, 12> m;

  Vec3d point(Vec3d p) const { return vector(p) + Vec3d(m[3], m[7], m[11]); }
  Vec3d vector(Vec3d v) const {
    const auto row = [&](size_t i) { return m[i] * v.x + m[i + 1] * v.y + m[i + 2] * v.z; };
    return {row(0), row(4), row(8)};
  }
  // Uses cofactors: the inverse transpose up to a factor.
  Vec3d normal(Vec3d n) const {
    const auto row = [&](size_t i) { return Vec3d(m[i], m[i + 1], m[i + 2]); };
    return {dot(cross(row(4), row(8)), n), dot(cross(row(8), row(0)), n),
            dot(cross(row(0), row(4)), n)};
  }
  // Relative to an origin.
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

/// A node's transformation: scale, then rotation by the quaternion x, y, z, w, then translation.
struct NodePlace {
  Vec3d shift;
  std::array<double, 4> rotation{0, 0, 0, 1};
  Vec3d scale{1, 1, 1};
};

/// Rows as in Matrix.
std::array<double, 12> placement_matrix(const NodePlace& place);

/// The quaternion, with w >= 0, that rotates the axes to these orthonormal vectors (Shepperd 1978,
/// "Quaternion from Rotation Matrix").
std::array<double, 4> rotation_to(Vec3d x, Vec3d y, Vec3d z);

/// The node of an instance; nothing if its matrix shears, which nodes cannot express.
std::optional<NodePlace> place_of(const Matrix& m);

}  // namespace raio::core::gltf
