#include "render/noise.h"

#include <algorithm>
#include <array>

namespace raio::core {
namespace {

constexpr int kBlock = 8;
// Pixels count as at least this bright, with 1 for white: nobody sees noise that is small compared
// to darkness.
constexpr double kDarkest = 1.0 / 32;

}  // namespace

double square_noise(const Film& film, size_t tile) {
  const TileSamples numbers = film.copy(tile);
  const uint32_t all = numbers.samples.count();
  const uint32_t before = film.rounds().start(numbers.samples.end() - 1), last = all - before;
  // If the samples of the last round and those before it have independent means A and B, the mean
  // of all has the variance weight * (A - B)^2, in expectation.
  const double weight = double(last) * before / (double(all) * all);
  const bool has_alpha = film.layout().has(Channel::alpha);
  const double darkest = 3 * kDarkest * film.scale();

  struct Sum {
    double noise = 0;
    int pixels = 0;
  };
  constexpr size_t kAcross = kMaxTileSide / kBlock;
  std::array<Sum, kAcross * kAcross> blocks;
  const Tile place = film.tile(tile);
  const auto width = size_t(place.x1 - place.x0), height = size_t(place.y1 - place.y0);
  for (size_t y = 0; y < height; ++y)
    for (size_t x = 0; x < width; ++x) {
      const int64_t* const sums = &numbers.sums[4 * (y * width + x)];
      const int64_t* const in_last = &numbers.last_round[4 * (y * width + x)];
      const auto square = [&](int c) {
        const double apart = double(in_last[c]) / last - double(sums[c] - in_last[c]) / before;
        return weight * apart * apart;
      };
      const double bright = double(sums[0] + sums[1] + sums[2]) / all;
      const double light = std::max(bright, darkest);
      Sum& block = blocks[y / kBlock * kAcross + x / kBlock];
      block.noise += 3 * (square(0) + square(1) + square(2)) / (light * light);
      if (has_alpha) block.noise += square(3) / (double(kFullCoverage) * kFullCoverage);
      ++block.pixels;
    }
  double most = 0;
  for (const Sum& block : blocks)
    if (block.pixels > 0) most = std::max(most, block.noise / block.pixels);
  return most;
}

TileNeed need_of(const Film& film, size_t tile, const PlainOptions& options) {
  const auto most = uint32_t(options.samples_per_pixel());
  if (options.noise == 0) return {most, most};
  const SampleRounds rounds = film.rounds();
  const uint32_t fewest = std::min(2 * rounds.first, most);
  const SampleSet has = film.samples(tile);
  const uint32_t round_end = has.empty() ? 0 : rounds.end(rounds.start(has.end() - 1));
  const uint32_t end = std::clamp(round_end, fewest, most);
  if (end == most || !has.missing({0, end}).empty()) return {end, std::min(4 * end, most)};
  const double noise = square_noise(film, tile), wanted = double(options.noise) * options.noise;
  if (noise <= wanted) return {end, end};
  const uint32_t next = std::min(2 * end, most);
  const double likely = std::clamp(end * noise / wanted, double(next), double(most));
  return {next, uint32_t(likely)};
}

}  // namespace raio::core
