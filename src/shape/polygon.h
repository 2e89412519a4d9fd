// Triangulation of planar polygons, convex or concave.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace raio::core {

/// The unit normal by Newell's method (Sutherland, Sproull and Schumacker 1974): the normalized sum
/// of the vertices' cross products. It is right for concave polygons and fits the best plane to
/// vertices a little off it. Vertices appear counter-clockwise from its tip. Zero for a polygon
/// without area.
Vec3f polygon_normal(std::span<const Vec3f> corners);

/// Triangulates a simple polygon in the plane of its normal: corners.size() - 2 triangles of its
/// own vertices, with the polygon's winding. Repeated or collinear vertices and vertices a little
/// off the plane are allowed; a self-intersecting polygon gets triangles that cover it somehow.
/// Near-linear time for usual polygons, never worse than quadratic.
std::vector<std::array<uint32_t, 3>> triangulate(std::span<const Vec3f> corners);

}  // namespace raio::core
