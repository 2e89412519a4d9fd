// Affine transformations of instances.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/box.h"
#include "base/exact_math.h"
#include "base/ray.h"
#include "base/vec.h"

namespace raio::core {

/// The transformation x -> A x + b: three rows of A, each followed by its component of b.
using Matrix = std::array<float, 12>;
inline constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// A matrix with its inverse, in double: from an object's space to the enclosing one.
class Placement {
 public:
  using Inverse = std::array<Vec3d, 3>;  // rows of the inverse of A

  explicit Placement(const Matrix& m) : Placement(m, Inverse()) {
    const double by = determinant();
    for (size_t i = 0; i < 3; ++i)
      inverse_[i] = cross(column((i + 1) % 3), column((i + 2) % 3)) / by;
  }
  Placement(const Matrix& m, const Inverse& inverse)
      : shift_(m[3], m[7], m[11]), inverse_(inverse) {
    for (size_t i = 0; i < 3; ++i) rows_[i] = Vec3d(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
  }

  const Inverse& inverse() const { return inverse_; }
  double determinant() const { return dot(column(0), cross(column(1), column(2))); }
  /// Whether all numbers are finite and the matrix is invertible in float precision.
  bool is_sound() const {
    return std::isfinite(determinant()) && is_finite(Vec3f(shift_)) &&
           std::abs(determinant()) >
               1e-9 * length(column(0)) * length(column(1)) * length(column(2));
  }
  /// The maximum factor by which a length grows.
  double longest() const {
    return std::sqrt(dot(column(0), column(0)) + dot(column(1), column(1)) +
                     dot(column(2), column(2)));
  }
  /// An upper bound of the ratio of the longest to the shortest axis of a transformed ball. Errors
  /// grow by this factor on the way to the object and back.
  double condition() const {
    return longest() * std::sqrt(dot(inverse_[0], inverse_[0]) + dot(inverse_[1], inverse_[1]) +
                                 dot(inverse_[2], inverse_[2]));
  }
  /// The factor by which all lengths grow, exactly 1 if almost 1; 0 if the scaling is not uniform.
  double scale() const {
    const double s = exact_cbrt(std::abs(determinant())), slack = 1e-4 * s * s;
    for (size_t i = 0; i < 3; ++i)
      if (std::abs(dot(column(i), column(i)) - s * s) > slack ||
          std::abs(dot(column(i), column((i + 1) % 3))) > slack)
        return 0;
    return std::abs(s - 1) < 1e-4 ? 1 : s;
  }

  Vec3d point(Vec3d p) const { return vector(p) + shift_; }
  Vec3d vector(Vec3d v) const { return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)}; }
  /// The unit normal of the transformed surface, on the same side as n.
  Vec3d normal(Vec3d n) const {
    return normalize(inverse_[0] * n.x + inverse_[1] * n.y + inverse_[2] * n.z);
  }
  /// The bounding box of the transformed box.
  Box3d box(const Box3f& b) const {
    Box3d out;
    if (b.empty()) return out;
    for (int k = 0; k < 8; ++k)
      out.extend(
          point(Vec3d(k & 1 ? b.hi.x : b.lo.x, k & 2 ? b.hi.y : b.lo.y, k & 4 ? b.hi.z : b.lo.z)));
    return out;
  }

  /// The ray in the object's space, with a direction of length 1. A distance t there is t /
  /// `stretch` on the original ray. With `slack`, the ray reaches a little further.
  Ray to_object(const Ray& ray, double& stretch, double slack = 0) const {
    const Vec3d from = Vec3d(ray.origin) - shift_, along(ray.dir);
    const auto back = [this](Vec3d v) {
      return Vec3d(dot(inverse_[0], v), dot(inverse_[1], v), dot(inverse_[2], v));
    };
    const Vec3d dir = back(along);
    stretch = length(dir);
    return {Vec3f(back(from)), Vec3f(dir / stretch),
            float(double(ray.tmax) * stretch * (1 + slack)), ray.time};
  }

 private:
  Vec3d column(size_t i) const { return {rows_[0][int(i)], rows_[1][int(i)], rows_[2][int(i)]}; }

  Vec3d rows_[3], shift_;
  Inverse inverse_;
};

/// The product: first `b`, then `a`.
inline Matrix joined(const Matrix& a, const Matrix& b) {
  const Placement first(a), second(b);
  Matrix out;
  const Vec3d shift = first.point(Vec3d(b[3], b[7], b[11]));
  for (size_t j = 0; j < 3; ++j) {
    const Vec3d column = first.vector(Vec3d(b[j], b[j + 4], b[j + 8]));
    for (int i = 0; i < 3; ++i) out[4 * size_t(i) + j] = float(column[i]);
  }
  for (int i = 0; i < 3; ++i) out[4 * size_t(i) + 3] = float(shift[i]);
  return out;
}

}  // namespace raio::core
