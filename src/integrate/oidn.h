// Open Image Denoise 2 (https://www.openimagedenoise.org), loaded on demand where it is installed.
#pragma once

#include <expected>
#include <string>

#include "integrate/denoise.h"

namespace raio::core {

/// The version of the library, as in "2.3.0". It is the file that the environment variable
/// RAIO_OIDN names, else the system's. The error says in one line why there is none.
std::expected<std::string, std::string> oidn_version();

/// Like denoise() with this library, on the processor. Its results may differ between machines,
/// versions and numbers of threads in the last bits. Needs oidn_version(); the error is its own
/// message.
std::expected<void, std::string> denoise_by_oidn(Image& color, const PixelGuides& guides);

}  // namespace raio::core
