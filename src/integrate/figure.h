// How figures look: what the integrator `ambient` takes from users.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/vec.h"

namespace raio {

/// Named looks. The number is the version, which pictures store: a look that changes becomes a new
/// one, so that an old name gives the old picture. The numbers stand in files.
enum class Look : uint8_t { paper, dark, flat, matte };

inline constexpr std::array<std::string_view, 4> kLookNames = {"paper-1", "dark-1", "flat-1",
                                                               "matte-1"};

/// What a look says, as light: a white surface has as much of it from a whole sky as `sky`, from
/// the key light in front of it as `key`.
struct LookNumbers {
  Rgb background;  // linear
  float sky, key;
  float highlight, shine;  // of the key light, as `ks` and `shine` of a Material
  float outline;           // width, pixels
  float depth_cue;
};

constexpr LookNumbers numbers_of(Look look) {
  switch (look) {
    case Look::paper:
      break;
    case Look::dark:
      return {Rgb(0.006f, 0.007f, 0.01f), 0.3f, 0.8f, 0.12f, 40, 0, 0.3f};
    case Look::flat:
      return {Rgb(1), 0.95f, 0, 0, 1, 1.6f, 0};
    case Look::matte:
      return {Rgb(0.86f), 0.75f, 0.4f, 0, 1, 0, 0};
  }
  return {Rgb(1), 0.6f, 0.6f, 0.05f, 30, 0, 0};
}

/// What a figure is made with, besides what all pictures have.
struct FigureSettings {
  Look look = Look::paper;
  int occlusion_rays = 2;        // of each surface that is seen, for a sample
  float occlusion_distance = 0;  // what is farther away hides no sky, scene units; 0: any distance
  bool key_light = true;
  float outline = 0;    // width, pixels
  float depth_cue = 0;  // the part of the background in what is farthest away
  bool shadow_catcher = false;

  friend bool operator==(const FigureSettings&, const FigureSettings&) = default;
};

}  // namespace raio
