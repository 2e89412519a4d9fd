// Classifies the pixels of a picture, to explain where two pictures of a scene differ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "accel/accel.h"
#include "base/executor.h"
#include "integrate/settings.h"
#include "io/image/image.h"
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

/// How a picture B differs from the reference A in a region.
struct RegionDifference {
  size_t pixels = 0;
  size_t apart = 0;  // pixels with a channel that differs by more than 8 of 255
  double mean = 0;   // B minus A, over channels and pixels apart, of 255
};
using RegionDifferences = std::array<RegionDifference, kRegionNames.size()>;

/// The pictures have the size of `regions`.
RegionDifferences differences(const Image& a, const Image& b, const std::vector<Region>& regions);

/// The region to examine first: where most pixels differ. Mirrors and shiny surfaces also show what
/// is wrong elsewhere, so they count only if matt surfaces hardly differ. Nothing for equal
/// pictures.
std::optional<Region> suspect(const RegionDifferences& found);

/// Parts of a program that may be wrong if its picture differs there; one line.
std::string_view likely_cause(Region region);

}  // namespace raio::core
