// Options of figures, with the integrator `ambient`; for the table of options.cpp, like
// picture_options.h.
#pragma once

#include <array>

#include "render/options.h"

namespace raio::core {

/// As users write them: the newest version of a style has no number.
inline constexpr auto kLooks = std::to_array<std::string_view>({"paper", "dark", "flat", "matte"});
inline constexpr std::array<std::string_view, 3> kKeyLights = {"off", "on", "scene"};

std::expected<void, std::string> set_look(RenderOptions& options, const OptionSpec&,
                                          std::string_view text);
std::string look_text(const RenderOptions& options, const OptionSpec&);

/// A number, or a colour as in parse_color(), display values converted to light; for OptionValue.
/// The text is "0.5", or "R,G,B" if the components differ.
std::expected<void, std::string> set_sky_light(RenderOptions& options, const OptionSpec&,
                                               std::string_view text);
std::string sky_light_text(const RenderOptions& options, const OptionSpec&);

/// Samples per pixel if neither the user nor the scene sets them.
inline constexpr int kFigureSamples = 64;

FigureSettings figure_settings(const RenderOptions& options, const Scene& scene);
/// The options that resolve to these settings.
void set_figure(RenderOptions& options, const FigureSettings& figure, const Scene& scene);

/// Whether surfaces emit more than white paper reflects, so that they are lights, not displays or
/// glowing signs.
bool has_bright_surfaces(const Scene& scene);

/// Whether `path` takes light from the scene: all but figures have some, even if it is only the
/// background.
bool has_own_light(const Scene& scene);

/// Whether depth cueing was requested without a colour to fade into.
bool fades_into_nothing(const RenderOptions& options, const Scene& scene);

}  // namespace raio::core
