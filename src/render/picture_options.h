// The options that say which part of a picture there is: their texts, and what they do not go
// with. The table of options (render/options.h) names them.
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

/// Their share of option_conflict(). Without a scene, what depends on it passes.
std::optional<Error> picture_conflict(const RenderOptions& options, const Scene* scene);

}  // namespace raio
