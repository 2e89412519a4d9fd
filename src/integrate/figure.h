// The style of figures: user settings of the integrator `ambient`.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/vec.h"

namespace raio::core {

/// Named styles. The number is the version, which pictures store: a changed style gets a new one,
/// so an old name gives the old picture. The enumerators' values are stored in files.
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

/// A style's light: a white surface receives `sky` from an unobstructed sky and `key` from the key
/// light facing it.
struct StyleParams {
  Rgb background;  // linear
  float sky, key;
  float highlight, shine;  // of the key light, as `ks` and `shine` of a Material
  float outline;           // width, pixels
  float depth_cue;
  /// Bright colours c become c (1 - soft max(c)), so that white contrasts with paper and saturated
  /// colours do not clip.
  float soft = 0;
  /// Sky mirrored by black surfaces at grazing angles, so that dark meshes keep their form.
  float rim = 0;
  /// Whether the outline probes rotate from sample to sample. Half of them suffice then.
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

/// The light of figures besides the sky: none, one over the viewer's left shoulder, or the scene's
/// own lights.
enum class KeyLight : uint8_t { off, on, scene };

/// The settings of a figure, besides those of all pictures.
struct FigureSettings {
  FigureStyle look = FigureStyle::paper_2;
  Rgb sky_light = Rgb(params_of(FigureStyle::paper_2).sky);  // radiance
  int occlusion_rays = 2;                                    // per visible surface and sample
  float occlusion_distance = 0;  // farther occluders are ignored, scene units; 0: any distance
  KeyLight key_light = KeyLight::on;
  float outline = 0;    // width, pixels
  float depth_cue = 0;  // the fraction of the background at the farthest point
  bool shadow_catcher = false;

  friend bool operator==(const FigureSettings&, const FigureSettings&) = default;
};

}  // namespace raio::core
