// Options of figures, with the integrator `ambient`; for the table of options.cpp, like
// picture_options.h.
#pragma once

#include <array>

#include "render/options.h"

namespace raio::core {

/// As users write them: the newest version of a style has no number.
inline constexpr auto kLooks = std::to_array<std::string_view>({"paper", "dark", "flat", "matte"});
inline constexpr std::array<std::string_view, 2> kOnOff = {"off", "on"};

std::expected<void, std::string> parse_look(RenderOptions& options, std::string_view text);
std::string look_text(const RenderOptions& options);
std::expected<void, std::string> parse_key_light(RenderOptions& options, std::string_view text);
std::string key_light_text(const RenderOptions& options);
std::expected<void, std::string> parse_opacity(RenderOptions& options, std::string_view text);
std::string opacity_text(const RenderOptions& options);
std::expected<void, std::string> parse_outline(RenderOptions& options, std::string_view text);
std::string outline_text(const RenderOptions& options);
std::expected<void, std::string> parse_depth_cue(RenderOptions& options, std::string_view text);
std::string depth_cue_text(const RenderOptions& options);

/// Samples per pixel if neither the user nor the scene says.
inline constexpr int kFigureSamples = 64;

FigureSettings figure_settings(const RenderOptions& options, const Scene& scene);
/// The options that resolve to these settings.
void set_figure(RenderOptions& options, const FigureSettings& figure);

/// An option that has no effect with the selected integrator.
std::optional<Error> figure_conflict(const RenderOptions& options, const Scene& scene);
/// Removes options that figure_conflict() refuses.
void drop_figure_conflicts(RenderOptions& options, const Scene& scene);

}  // namespace raio::core
