// The options that say which part of a picture there is and on what ground: their texts, and what
// they do not go with. The table of options (render/options.h) names them.
#pragma once

#include <expected>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "render/options.h"

namespace raio {

/// "X0,Y0,X1,Y1", as OptionSpec::Parse and OptionSpec::text have it.
std::expected<void, std::string> parse_crop(RenderOptions& options, std::string_view text);
std::string crop_text(const RenderOptions& options);

/// Likewise, as parse_color() has it, or the folder of a sky, which is read.
std::expected<void, std::string> parse_background(RenderOptions& options, std::string_view text);
std::string background_text(const RenderOptions& options);

/// The curve of display formats: that of displays for figures, else none, unless the options say.
Tone tone_of(const RenderOptions& options, const Scene& scene);

/// What rays bring that hit nothing: RenderSettings::background and sky. The scene's own where the
/// options do not say, and for data, which has none, that of the look; no sky where they do not
/// show light. Display values of colours are the light
/// of which a tone curve makes them again.
struct Background {
  Rgb color;
  std::shared_ptr<const CubeMap> sky;

  friend bool operator==(const Background&, const Background&) = default;
};
Background background_of(const RenderOptions& options, const Scene& scene);

/// Their share of option_conflict(). Without a scene, what depends on it passes.
std::optional<Error> picture_conflict(const RenderOptions& options, const Scene* scene);

}  // namespace raio
