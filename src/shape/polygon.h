// Planar polygons, convex or concave, as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace raio {

/// The unit normal by Newell's method (Sutherland, Sproull and Schumacker 1974): the sum of the
/// corners' cross products, right for concave polygons and the best plane for corners that are a
/// little off it. Corners run counter-clockwise as seen from its tip. Zero for a polygon without
/// area.
Vec3f polygon_normal(std::span<const Vec3f> corners);

/// Cuts a simple polygon, in the plane of its normal, into corners.size() - 2 triangles of its own
/// corners with the polygon's winding. Corners that repeat or are in line, and corners a little off
/// the plane, are allowed; a polygon that crosses itself gives triangles that cover it in some way.
/// Time near-linear for polygons that occur; never worse than quadratic.
std::vector<std::array<uint32_t, 3>> triangulate(std::span<const Vec3f> corners);

}  // namespace raio
