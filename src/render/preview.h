// Previews of figures: pictures of one sample per pixel, without its noise.
#pragma once

#include <cstdint>
#include <span>

#include "io/image/image.h"

namespace raio::core {

/// Averages each pixel with its neighbours of a similar depth that show the same primitive: their
/// light, from few rays to the sky, is noisy. Where primitives are about as small as pixels, so
/// that nearly every pixel shows another one, it averages pixels of such primitives: their colours
/// would be noise, too. The background and the outlines of objects stay as they are. `depth` is
/// infinite and `id` 0 where nothing is hit, row by row.
Image without_noise(const Image& image, std::span<const float> depth, std::span<const uint32_t> id);

}  // namespace raio::core
