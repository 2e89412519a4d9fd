// Which samples a tile needs: with the option `noise` as many as its noise demands, otherwise all.
// docs/adaptive.md derives the estimate.
#pragma once

#include <cstddef>
#include <cstdint>

#include "integrate/film.h"
#include "integrate/settings.h"

namespace raio::core {

/// Of the tiles of pictures with `noise`.
inline constexpr int kNoiseTileSide = 16;

struct TileNeed {
  uint32_t end = 0;     // needs samples 0 .. end - 1 now; with all of them, it is finished
  uint32_t likely = 0;  // an estimate of the end of its last sample
};

/// Depends on the tile's own samples only, so tiles can be rendered in any order and on different
/// machines. `options` are resolved, and the film has their rounds.
TileNeed need_of(const Film& film, size_t tile, const PlainOptions& options);

/// The estimated noise of a tile: the mean square of the standard errors of pixels, each relative
/// to its brightness, in the block of 8 x 8 pixels where it is largest. The tile has all samples of
/// two or more rounds, except that the last may be incomplete.
double square_noise(const Film& film, size_t tile);

}  // namespace raio::core
