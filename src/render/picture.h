// What becomes of a film: the picture with its channels, in a file of the format that keeps them,
// or the film itself in a part file.
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>

#include "base/error.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "io/image/image.h"
#include "render/part.h"

namespace raio {

/// What the film shows, as picture_of(film, settings.view) has it, with all the channels that the
/// film has: alpha as such, the others as layers with the names and components of kChannels, as
/// Film::resolve() gives them. A picture with alpha has no background in its colours.
Picture picture_of(const Film& film, const RenderSettings& settings);

/// Makes colours those of a display, by exposure and tone curve; they are premultiplied by `alpha`
/// (which may be empty) and stay so. With `none` and 0 they stay as they are.
void tone_map(Image& image, std::span<const float> alpha, Tone tone, float exposure_ev);

/// Draws on a picture that is about to be written. Its colours are those of a display, or, if
/// `linear`, the light that the sRGB curve makes such.
using Overlay = std::function<std::expected<void, Error>(Picture&, bool linear)>;

/// write_image() with the tone and exposure of the settings, which are settings_of() the picture,
/// in the formats that are for displays: PNG and PPM. `overlay`, if any, comes last.
std::expected<void, Error> write_picture(Picture picture, const std::filesystem::path& path,
                                         const Metadata& settings, const Overlay& overlay = {});

/// Why a picture with these channels cannot go to `path`, nor a part file if the name is that of
/// one, as far as can be told now: an unknown suffix, a format that does not keep the channels
/// (bad_input), a place that cannot be written to. For callers that are about to compute for long.
std::optional<Error> output_problem(const std::filesystem::path& path, ChannelSet channels = {});

/// Writes a part file where the name is that of one, else the picture with its channels as
/// write_picture() does, and the settings either way. A part file cannot say less than all of its
/// tiles; whether the tiles of a picture are complete is not asked here. A part file has no
/// overlay.
std::expected<void, Error> write_result(const std::filesystem::path& path, const Part& part,
                                        const Overlay& overlay = {});

}  // namespace raio
