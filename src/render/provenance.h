// What a picture was made of, as the names and texts that pictures and part files keep: the version
// of Raio, the scene's name and hash, and every option that the picture depends on. Nothing that
// may differ between equal pictures (time, machine, threads).
#pragma once

#include <expected>
#include <string>
#include <string_view>

#include "io/image/image.h"
#include "io/read_scene.h"
#include "render/options.h"

namespace raio {

/// The settings of a picture, of a scene that was read as `read` says, for pictures (write_image)
/// and part files (render/part.h). Switches that are off and numbers that played no part are left
/// out.
Metadata settings_of(const Scene& scene, const RenderSettings& used,
                     const ReadOptions& read = kForPictures);

/// How the scene's file was read; the error (bad_input) is a sentence about the settings.
std::expected<ReadOptions, Error> read_options_from(const Metadata& settings);

/// The value of a setting; empty when it is not there.
std::string_view setting(const Metadata& settings, std::string_view key);

/// The options in the settings that a picture or a part file brought. They need not be trusted; the
/// error (bad_input) is a sentence about them. That they are resolved does not harm: resolving them
/// again for the same scene changes nothing. A sky is a folder, which may have gone since; without
/// `reads_sky` the background stays open where it is one.
std::expected<RenderOptions, Error> options_from(const Metadata& settings, bool reads_sky = true);

/// How the settings differ that decide a picture, as in "`aa` 2, not 3; without `samples`, not 7"
/// with the values of `a` and `b`, to stand in Error::message; empty when they do not. The scene's
/// name does not count.
std::string difference(const Metadata& a, const Metadata& b);

}  // namespace raio
