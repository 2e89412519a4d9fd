// Classifies the pixels of a picture, to explain where two pictures of a scene differ.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "base/executor.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio::core {

/// The kind of region at a pixel's centre; the first that applies.
enum class Region : uint8_t {
  background,
  edge,           // of an object: a neighbour shows another one, the background, or a crease
  mirror,         // or glass: T is above 0, or Ks is at least Kd
  shiny,          // Ks is above 0: shaded, and faintly a mirror
  shadow_border,  // a neighbour is lit by other lights
  shadow,         // a light that the surface faces is occluded
  lit,
};
inline constexpr std::array<std::string_view, 7> kRegionNames = {
    "background",         "edges",   "mirrors and glass", "shiny surfaces",
    "borders of shadows", "shadows", "lit surfaces"};

/// Row by row, for settings.width x settings.height pixels; without lens and jitter, lights as
/// points. Empty if stopped.
std::vector<Region> regions_of(const Scene& scene, const Accel& accel,
                               const RenderSettings& settings, const WorkControl& control);

}  // namespace raio::core
