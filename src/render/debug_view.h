// Pictures of what is behind a picture, for those who look for a mistake or explain how it is done:
// what the eye ray through the centre of each pixel meets, and what it costs to find that.
#pragma once

#include <optional>

#include "accel/accel.h"
#include "integrate/film.h"
#include "integrate/options.h"
#include "io/image/image.h"
#include "render/render.h"
#include "scene/scene.h"

namespace raio {

/// The picture that resolved options with another view than `picture` or `samples` ask for. Nothing
/// when told to stop.
///
///   normals    x, y and z of the normal towards the eye, -1 to 1 as red, green and blue 0 to 1
///   depth      grey D / (D + t), D from the eye to the point looked at, t to the surface
///   ids        a colour of its own for every item that rays meet (polygons: their triangles)
///   materials  a colour of its own for every material
///   steps      heat_color() of the cells or nodes visited
///   tests      heat_color() of the primitives tested
///   focus      green where the lens blurs by less than a pixel; more and more red in front of the
///              plane in focus, blue behind it
std::optional<Image> render_debug_view(const Scene& scene, const Accel& accel,
                                       const RenderOptions& options, RenderControl& control);

constexpr bool is_debug_view(View view) { return view != View::picture && view != View::samples; }

/// What the film shows: its picture, or for View::samples heat_color() of the samples of each
/// pixel.
Image picture_of(const Film& film, const RenderOptions& options);

/// 0 black, 1 blue, 4 cyan, 16 green, 64 yellow, 256 red, 1024 and more white.
Rgb heat_color(double count);

}  // namespace raio
