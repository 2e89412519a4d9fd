// Output of a film: a picture with its channels, in a format that can store them, or the film
// itself in a part file.
#pragma once

#include <expected>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "integrate/film.h"
#include "integrate/settings.h"
#include "io/image/image.h"
#include "render/part.h"

namespace raio::core {

/// The film's picture, as picture_of(film, settings.view), with the channels of the settings: alpha
/// as its alpha, the others as layers with names and components of kChannels, as given by
/// Film::resolve(). If it has alpha, its colours have no background. Its noise is not filtered.
Picture picture_of(const Film& film, const RenderSettings& settings);

/// Converts colours to display values by exposure and tone curve; they are premultiplied by `alpha`
/// (which may be empty) and stay so. `none` and 0 leave them unchanged. Returns the exposure in
/// stops.
float tone_map(Image& image, std::span<const float> alpha, Tone tone, const Exposure& exposure);

/// Draws on a picture before it is written. Its colours are display values or, if `linear`, light
/// for the sRGB curve.
using Overlay = std::function<std::expected<void, Error>(Picture&, bool linear)>;

/// write_image() with tone and exposure of the settings, settings_of() the picture, in display
/// formats: PNG and PPM. `overlay`, if any, is drawn last.
std::expected<void, Error> write_picture(Picture picture, const std::filesystem::path& path,
                                         const Metadata& settings, const Overlay& overlay = {});

/// What is stored of a part as a picture.
struct FinishedPicture {
  Picture picture;
  Metadata settings;               // with the filter that removed its noise
  std::vector<std::string> notes;  // sentences about what was chosen: filter, exposure
};

/// The picture of a part with its settings, without noise if they say so, as write_picture() writes
/// it to a file of this name.
std::expected<FinishedPicture, Error> finished_picture(const Part& part,
                                                       const std::filesystem::path& name,
                                                       const Overlay& overlay = {});

/// Why this filter cannot be used (no_resource), or nothing.
std::optional<Error> denoiser_problem(Denoiser denoiser);

/// The channels in a part's settings; its film may have more, for the denoiser.
std::expected<ChannelSet, Error> channels_of(const Part& part);

/// Why a picture with these channels, or a part file if the suffix is that of one, cannot be
/// written to `path`: an unknown suffix, a format without the channels (bad_input), an unwritable
/// place. Some failures cannot be predicted. Call it before long computations.
std::optional<Error> output_problem(const std::filesystem::path& path, ChannelSet channels = {});

/// Writes a part file if the suffix is that of one, else the picture with its channels as
/// write_picture() does; both with the settings. A part file stores which samples are missing; a
/// picture does not, and completeness is not checked here. A part file has no overlay. Returns the
/// notes of the picture.
std::expected<std::vector<std::string>, Error> write_result(const std::filesystem::path& path,
                                                            const Part& part,
                                                            const Overlay& overlay = {});

}  // namespace raio::core
