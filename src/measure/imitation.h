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

/// What shadow rays find: what there is; nothing; always something; also what is beyond the light.
/// Or, as with rays that start on their surface, in some pixels always something: the picture to
/// imitate tells in which.
enum class ShadowRays { right, none, always, beyond, speckled };

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

/// A picture of width x height pixels with that at place(column, row) of `from` in each.
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

/// The picture, in display values, with noise like that of any other. `of`: the picture to imitate;
/// if it is of another size, shadows are not speckled. Nothing if it cannot be rendered, for lack
/// of memory. Throws Stopped.
std::optional<Image> imitate(const Imitation& what, const Image& of);

}  // namespace raio::core
