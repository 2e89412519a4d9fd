// The settings that determine a picture, as names and texts stored in pictures and part files:
// Raio's version, the scene's name and hash, and every option that affects the picture. They
// exclude time, machine and threads, which may differ between equal pictures.
#pragma once

#include <expected>
#include <filesystem>
#include <string>
#include <string_view>

#include "io/image/image.h"
#include "io/read_scene.h"
#include "render/options.h"

namespace raio::core {

/// The settings of a picture of a scene read with `read`, for pictures (write_image) and part files
/// (render/part.h). Omits switches that are off and unused numbers. `scene_hash`: the scene's
/// content_hash(), if known.
Metadata settings_of(const Scene& scene, const RenderSettings& used,
                     const ReadOptions& read = kForPictures, const std::string& scene_hash = {});

/// Replaces the setting of one option by its value in `options`.
void set_setting(Metadata& settings, const OptionSpec& spec, const RenderOptions& options);

/// How the scene's file was read; the error (bad_input) is a sentence about the settings.
std::expected<ReadOptions, Error> read_options_from(const Metadata& settings);

/// The value of a setting; empty if absent.
std::string_view setting(const Metadata& settings, std::string_view key);

/// The options in the settings of a picture or a part file, which are not trusted; the error
/// (bad_input) is a sentence about them. They are resolved; resolving them again for the same scene
/// changes nothing. A sky is a folder, which may be gone; without `reads_sky` the background then
/// stays open.
std::expected<RenderOptions, Error> options_from(const Metadata& settings, bool reads_sky = true);

/// A picture of any program as it is displayed: an EXR of Raio's holds light, which gets the tone
/// curve and exposure in its settings. The file is not trusted.
std::expected<Image, Error> read_displayed(const std::filesystem::path& path);

/// The differences of two pictures' settings, as in "`aa` 2, not 3; without `samples`, not 7" for
/// the values of `a` and `b`, for Error::message; empty if there are none. The scene's name is
/// ignored.
std::string difference(const Metadata& a, const Metadata& b);

}  // namespace raio::core
