// How figures look: what the integrator `ambient` takes from users.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/vec.h"

namespace raio {

/// Named looks. The number is the version, which pictures store: a look that changes becomes a new
/// one, so that an old name gives the old picture. The numbers of the enumerators stand in files.
enum class FigureStyle : uint8_t {
  paper_1,
  dark_1,
  flat_1,
  matte_1,
  paper_2,
  dark_2,
  matte_2,
  flat_2
};

inline constexpr auto kLookNames = std::to_array<std::string_view>(
    {"paper-1", "dark-1", "flat-1", "matte-1", "paper-2", "dark-2", "matte-2", "flat-2"});

/// A look as light: a white surface has as much of it from a whole sky as `sky`, from the key light
/// in front of it as `key`.
struct StyleParams {
  Rgb background;  // linear
  float sky, key;
  float highlight, shine;  // of the key light, as `ks` and `shine` of a Material
  float outline;           // width, pixels
  float depth_cue;
  /// Bright colours c become c (1 - soft max(c)), so that white stands out from paper and saturated
  /// colours do not clip.
  float soft = 0;
  /// Sky that black surfaces mirror at grazing angles, so that dark meshes keep their form.
  float rim = 0;
  /// Do the rays that look for outlines turn from sample to sample? Half of them suffice then.
  bool turns = false;
};

constexpr StyleParams params_of(FigureStyle look) {
  const Rgb dark(0.006f, 0.007f, 0.01f), grey(0.86f);
  switch (look) {
    case FigureStyle::paper_1:
      return {Rgb(1), 0.6f, 0.6f, 0.05f, 30, 0, 0};
    case FigureStyle::dark_1:
      return {dark, 0.3f, 0.8f, 0.12f, 40, 0, 0.3f};
    case FigureStyle::flat_1:
      return {Rgb(1), 0.95f, 0, 0, 1, 1.6f, 0};
    case FigureStyle::matte_1:
      return {grey, 0.75f, 0.4f, 0, 1, 0, 0};
    case FigureStyle::dark_2:
      return {dark, 0.35f, 0.75f, 0.1f, 40, 0, 0.3f, 0.2f, 0.1f, true};
    case FigureStyle::matte_2:
      return {grey, 0.75f, 0.4f, 0, 1, 0, 0, 0.2f, 0.05f, true};
    case FigureStyle::flat_2:
      return {Rgb(1), 0.95f, 0, 0, 1, 1.6f, 0, 0, 0, true};
    case FigureStyle::paper_2:
      break;
  }
  return {Rgb(1), 0.62f, 0.5f, 0.06f, 30, 0, 0, 0.22f, 0.12f, true};
}

/// What a figure is made with, besides what all pictures have.
struct FigureSettings {
  FigureStyle look = FigureStyle::paper_2;
  int occlusion_rays = 2;        // of each surface that is seen, for a sample
  float occlusion_distance = 0;  // what is farther away hides no sky, scene units; 0: any distance
  bool key_light = true;
  float outline = 0;    // width, pixels
  float depth_cue = 0;  // the part of the background in what is farthest away
  bool shadow_catcher = false;

  friend bool operator==(const FigureSettings&, const FigureSettings&) = default;
};

}  // namespace raio
