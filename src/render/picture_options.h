// The options of crop and background: their texts, and conflicts with others. The table of options
// (render/options.h) refers to them.
#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "io/read_scene.h"
#include "render/options.h"

namespace raio::core {

/// "X0,Y0,X1,Y1", for OptionValue.
std::expected<void, std::string> set_crop(RenderOptions& options, const OptionSpec&,
                                          std::string_view text);
std::string crop_text(const RenderOptions& options, const OptionSpec&);

/// The same for a colour as in parse_color(), or the folder of a sky, which is read.
std::expected<void, std::string> set_background(RenderOptions& options, const OptionSpec&,
                                                std::string_view text);
std::string background_text(const RenderOptions& options, const OptionSpec&);

/// Moves a background that lights the scene to the options by which the scene is read: `sky` to the
/// clear sky that eye rays see, a picture to the environment. Returns the conflict, or nothing.
std::optional<Error> read_background(RenderOptions& options, ReadOptions& read);

/// The tone curve of display formats. The default is srgb for figures, else none.
Tone tone_of(const RenderOptions& options, const Scene& scene);

/// The light of rays that hit nothing: RenderSettings::background and sky. By default the scene's;
/// data has none, so it gets the style's. No sky unless the picture shows light. Display values
/// become the light from which the tone curve produces them.
struct Background {
  Rgb color;
  std::shared_ptr<const CubeMap> sky;

  friend bool operator==(const Background&, const Background&) = default;
};
Background background_of(const RenderOptions& options, const Scene& scene);

/// Whether eye rays see the scene's environment: with the integrator `ambient`, unless a background
/// is given.
bool sees_environment(const RenderOptions& options, const Scene& scene);

/// Part of option_conflict(). Without a scene, checks that depend on it pass.
std::optional<Error> picture_conflict(const RenderOptions& options, const Scene* scene);

}  // namespace raio::core
