#include "integrate/film.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "integrate/options.h"

namespace raio {

RayCounts& RayCounts::operator+=(const RayCounts& b) {
  eye += b.eye, eye_hits += b.eye_hits;
  reflection += b.reflection, refraction += b.refraction;
  shadow += b.shadow, shadow_hits += b.shadow_hits;
  tests += b.tests, steps += b.steps;
  return *this;
}

Film::Film(int width, int height, double bound, int tile_side)
    : width_(width),
      height_(height),
      tile_side_(tile_side),
      columns_((width + tile_side - 1) / tile_side),
      bound_(std::clamp(bound, kLeastBound, kMostBound)),
      states_(size_t(columns_) * size_t((height + tile_side - 1) / tile_side)),
      sums_(map_sums()) {
  // The sum of the most samples that there can be stays below 2^62; and no finer than 2^-40, where
  // a picture has no more to say.
  int exponent = 0;
  std::frexp(bound_ * kMaxSamples, &exponent);
  scale_ = std::ldexp(1.0, std::min(62 - exponent, 40));
}

Tile Film::tile(size_t index) const {
  const int x = int(index % size_t(columns_)) * tile_side_;
  const int y = int(index / size_t(columns_)) * tile_side_;
  return {x, y, std::min(x + tile_side_, width_), std::min(y + tile_side_, height_)};
}

uint32_t Film::samples(size_t tile) const {
  const std::lock_guard lock(mutex(tile));
  return states_[tile].samples;
}

RayCounts Film::rays() const {
  RayCounts all;
  for (size_t t = 0; t < tiles(); ++t) {
    const std::lock_guard lock(mutex(t));
    all += states_[t].rays;
  }
  return all;
}

PixelSums* Film::begin(size_t tile) {
  const std::lock_guard lock(mutex(tile));
  TileState& state = states_[tile];
  if (state.samples > 0) return nullptr;
  if (state.begun) std::fill_n(sums(tile), tile_sums(), PixelSums());
  state.begun = true;
  return sums(tile);
}

void Film::add(size_t tile, uint32_t samples, const PixelSums* sums, const RayCounts& rays) {
  const std::lock_guard lock(mutex(tile));
  if (PixelSums* const held = this->sums(tile); held != sums)
    for (size_t i = 0; i < tile_sums(); ++i)
      for (size_t c = 0; c < sums[i].size(); ++c) held[i][c] += sums[i][c];
  states_[tile].samples += samples;
  states_[tile].rays += rays;
}

TileSamples Film::copy(size_t tile) const {
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  TileSamples out{states_[tile].samples, states_[tile].rays, {}};
  if (out.samples == 0) return out;
  for (int y = t.y0; y < t.y1; ++y)
    for (int x = 0; x < t.x1 - t.x0; ++x) {
      const PixelSums& s = row(tile, y)[x];
      out.sums.insert(out.sums.end(), {s[0], s[1], s[2]});
    }
  return out;
}

void Film::replace(size_t tile, const TileSamples& by) {
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  states_[tile] = {by.samples, false, by.rays};
  std::fill_n(sums(tile), tile_sums(), PixelSums());
  const int64_t* s = by.sums.data();
  for (int y = t.y0; y < t.y1 && by.samples > 0; ++y)
    for (int x = 0; x < t.x1 - t.x0; ++x, s += 3) row(tile, y)[x] = {{s[0], s[1], s[2]}};
}

Image Film::resolve() const {
  Image image(width_, height_);
  parallel_for(tiles(), [&](size_t t) {
    const std::lock_guard lock(mutex(t));
    if (states_[t].samples == 0) return;
    const Tile tile = this->tile(t);
    const double unit = 1 / (scale_ * states_[t].samples);
    const auto light = [&](int64_t sum) { return float(double(sum) * unit); };
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const PixelSums& s = row(t, y)[x - tile.x0];
        image.at(x, y) = {light(s[0]), light(s[1]), light(s[2])};
      }
  });
  return image;
}

}  // namespace raio
