// Imitates programs with faults: renders the picture that such a program makes of a scene. Most
// faults are changes of the scene or its settings; this file has the others.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "integrate/settings.h"
#include "io/image/image.h"
#include "scene/scene.h"

namespace raio::core {

/// The results of shadow rays.
enum class ShadowRays {
  right,
  none,      // nothing is hit
  always,    // everything is occluded
  beyond,    // objects beyond the light occlude it
  speckled,  // some pixels are occluded, as by their own surface; the imitated picture says which
};

struct Imitation {
  Scene scene;
  RenderSettings settings;

  ShadowRays shadows = ShadowRays::right;
  float light_scale = 1;    // of all that lights add
  int falloff = 0;          // at the first hit, lights decrease with this power of the distance
  bool black_rays = false;  // mirrored and refracted rays that hit nothing get black
  // Eye rays pass through a pixel's side instead of its middle: from the left or the upper one (0)
  // to the right or the lower one (2).
  std::array<int, 2> within_pixel{1, 1};
  bool ignores_shape = false;  // the picture shows as many degrees across as from top to bottom
  // Applied to the finished picture, in this order.
  std::vector<Image (*)(const Image&)> transforms;
};

/// A picture of width x height pixels: the pixel (x, y) is that of `from` at place(x, y).
template <class Place>
Image picked(const Image& from, int width, int height, const Place& place) {
  Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto [column, row] = place(x, y);
      out.at(x, y) = from.at(column, row);
    }
  return out;
}

/// Renders the picture, in display values. `of`: the picture to imitate; if it has another size,
/// shadows are not speckled. Nothing if there is too little memory. Throws Stopped.
std::optional<Image> imitate(const Imitation& what, const Image& of);

}  // namespace raio::core
