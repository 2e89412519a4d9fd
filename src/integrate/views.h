// Diagnostic pictures, for finding mistakes and for teaching: the surfaces that eye rays hit, and
// the cost of finding them. Pixels, lens and antialiasing are as in any other picture.
#pragma once

#include "integrate/prepared_scene.h"

namespace raio::core {

/// The integrator `views` shows, by RenderSettings::view:
///
///   normals    x, y and z of the normal towards the eye, -1 to 1 as red, green and blue 0 to 1
///   depth      grey D / (D + z): z is the surface's distance along the line of sight, D that of
///              the point looked at
///   ids        a colour for every primitive that rays hit (polygons: their triangles)
///   materials  a colour for every material
///   steps      heat_color() of the cells or nodes visited
///   tests      heat_color() of the primitives tested
///   focus      green where the lens blurs by less than a pixel; more and more red in front of the
///              focal plane, blue behind it
double views_bound(const Scene& scene, const RenderSettings& settings);

/// 0 black, 1 blue, 4 cyan, 16 green, 64 yellow, 256 red, 1024 and more white.
Rgb heat_color(double count);

}  // namespace raio::core
