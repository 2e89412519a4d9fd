#include "io/mesh/gltf_place.h"

#include "base/exact_math.h"

namespace raio::core::gltf {

std::array<double, 12> placement_matrix(const NodePlace& place) {
  auto [x, y, z, w] = place.rotation;
  const double size = exact_hypot(exact_hypot(x, y), exact_hypot(z, w));
  if (size > 0)
    x /= size, y /= size, z /= size, w /= size;
  else
    w = 1;
  const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                             {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                             {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
  std::array<double, 12> out;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t column = 0; column < 3; ++column)
      out[4 * row + column] = rows[row][column] * place.scale[int(column)];
    out[4 * row + 3] = place.shift[int(row)];
  }
  return out;
}

std::array<double, 4> rotation_to(Vec3d x, Vec3d y, Vec3d z) {
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
      std::copysign(exact_hypot(exact_hypot(q[0], q[1]), exact_hypot(q[2], q[3])), q[3]);
  for (double& part : q) part /= size;
  return q;
}

std::optional<NodePlace> place_of(const Matrix& m) {
  std::array<Vec3d, 3> axes;
  NodePlace place;
  for (size_t k = 0; k < 3; ++k) {
    axes[k] = Vec3d(m[k], m[k + 4], m[k + 8]);
    place.scale[int(k)] = length(axes[k]);
    place.shift[int(k)] = m[4 * k + 3];
    axes[k] = axes[k] / place.scale[int(k)];
  }
  // Tolerance of the precision of floats.
  constexpr double kSlack = 1e-5;
  for (size_t k = 0; k < 3; ++k)
    if (std::abs(dot(axes[k], axes[(k + 1) % 3])) > kSlack) return std::nullopt;
  if (dot(cross(axes[0], axes[1]), axes[2]) < 0) place.scale.x *= -1, axes[0] = -axes[0];
  const Vec3d z = normalize(cross(axes[0], axes[1]));
  place.rotation = rotation_to(axes[0], cross(z, axes[0]), z);
  return place;
}

}  // namespace raio::core::gltf
