#include "shape/triangle.h"

#include <array>
#include <limits>

namespace raio::core {
namespace {

/// The sum of absolute components.
double norm1(Vec3d v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

}  // namespace

bool overlaps(const Triangle& triangle, const Box3d& box) {
  const std::array<Vec3d, 3> corner{Vec3d(triangle.a), Vec3d(triangle.b), Vec3d(triangle.c)};
  const Vec3d center = box.center(), half = box.size() * 0.5;
  const std::array<Vec3d, 3> p{corner[0] - center, corner[1] - center, corner[2] - center};

  // The subtractions round vertices and half sizes by half an ulp of the largest coordinate, and
  // each dot product adds a few more: 8 ulps times the length of the axis exceed any rounding of a
  // projection. So a "no" is right even for boxes that only touch.
  const double largest = std::max(
      {norm1(corner[0]), norm1(corner[1]), norm1(corner[2]), norm1(box.lo), norm1(box.hi)});
  const double ulps = 8 * std::numeric_limits<double>::epsilon() * largest;
  const auto separates = [&](Vec3d axis, double axis_size) {
    const double s0 = dot(axis, p[0]), s1 = dot(axis, p[1]), s2 = dot(axis, p[2]);
    const double reach = dot(abs(axis), half) + ulps * axis_size;
    return std::min({s0, s1, s2}) > reach || std::max({s0, s1, s2}) < -reach;
  };

  for (int a = 0; a < 3; ++a) {
    const double lo = std::min({corner[0][a], corner[1][a], corner[2][a]});
    const double hi = std::max({corner[0][a], corner[1][a], corner[2][a]});
    if (lo > box.hi[a] || hi < box.lo[a]) return false;
  }
  // An axis of length zero (of a degenerate edge or triangle) separates nothing; the others suffice
  // for a segment or a point.
  const std::array<Vec3d, 3> edge{corner[1] - corner[0], corner[2] - corner[1],
                                  corner[0] - corner[2]};
  if (separates(cross(edge[0], edge[1]), norm1(edge[0]) * norm1(edge[1]))) return false;
  for (const Vec3d& e : edge) {
    const double size = norm1(e);
    if (separates({0, -e.z, e.y}, size)) return false;
    if (separates({e.z, 0, -e.x}, size)) return false;
    if (separates({-e.y, e.x, 0}, size)) return false;
  }
  return true;
}

}  // namespace raio::core
