// The options that say which part of a picture there is and on what ground: their texts, and what
// they do not go with. The table of options (render/options.h) names them.
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <string_view>

#include "render/options.h"

namespace raio {

/// "X0,Y0,X1,Y1", as OptionSpec::Parse and OptionSpec::text have it.
std::expected<void, std::string> parse_crop(RenderOptions& options, std::string_view text);
std::string crop_text(const RenderOptions& options);

/// Likewise, as parse_color() has it.
std::expected<void, std::string> parse_background(RenderOptions& options, std::string_view text);
std::string background_text(const RenderOptions& options);

/// What rays bring that hit nothing; the scene's own where the options do not say, or show none.
/// Display values are the light of which a tone curve makes them again.
Rgb background_of(const RenderOptions& options, const Scene& scene);

/// Their share of option_conflict(). Without a scene, what depends on it passes.
std::optional<Error> picture_conflict(const RenderOptions& options, const Scene* scene);

}  // namespace raio
