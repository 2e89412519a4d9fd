// What each pixel of a picture shows, for people who wonder why two pictures of a scene differ.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "integrate/control.h"
#include "integrate/settings.h"
#include "scene/scene.h"

namespace raio {

/// What the ray through a pixel's centre meets; the first that applies.
enum class Region : uint8_t {
  background,
  edge,           // of an object: a neighbour shows another, the background, or a crease
  mirror,         // or glass: Ks or T is above 0
  shadow_border,  // a neighbour sees other lights
  shadow,         // some light that the surface faces is hidden
  lit,
};
inline constexpr std::array<std::string_view, 6> kRegionNames = {
    "background", "edges", "mirrors and glass", "borders of shadows", "shadows", "lit surfaces"};

/// Row by row, of settings.width x settings.height pixels; without lens and jitter, lights as
/// points. Empty when it was told to stop.
std::vector<Region> regions_of(const Scene& scene, const Accel& accel,
                               const RenderSettings& settings, const RenderControl& control);

}  // namespace raio
