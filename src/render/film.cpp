#include "render/film.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "render/options.h"

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
      sums_(map_sums(size_t(width) * size_t(height))),
      samples_(size_t(columns_) * size_t((height + tile_side - 1) / tile_side)),
      rays_(samples_.size()) {
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
  return samples_[tile];
}

RayCounts Film::rays() const {
  RayCounts all;
  for (size_t t = 0; t < tiles(); ++t) {
    const std::lock_guard lock(mutex(t));
    all += rays_[t];
  }
  return all;
}

void Film::add(size_t tile, uint32_t samples, const PixelSums* sums, const RayCounts& rays) {
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  for (int y = t.y0; y < t.y1; ++y, sums += kMostTileSide) {
    int64_t* const row = pixel(t.x0, y);
    for (int x = 0; x < t.x1 - t.x0; ++x)
      for (int c = 0; c < 3; ++c) row[3 * x + c] += sums[x][size_t(c)];
  }
  samples_[tile] += samples;
  rays_[tile] += rays;
}

TileSamples Film::copy(size_t tile) const {
  const Tile t = this->tile(tile);
  TileSamples out;
  const std::lock_guard lock(mutex(tile));
  out.samples = samples_[tile], out.rays = rays_[tile];
  if (out.samples > 0)
    for (int y = t.y0; y < t.y1; ++y)
      out.sums.insert(out.sums.end(), pixel(t.x0, y), pixel(t.x1, y));
  return out;
}

void Film::replace(size_t tile, const TileSamples& by) {
  const Tile t = this->tile(tile);
  const size_t row = size_t(t.x1 - t.x0) * 3;
  const std::lock_guard lock(mutex(tile));
  samples_[tile] = by.samples, rays_[tile] = by.rays;
  for (int y = t.y0; y < t.y1; ++y) {
    if (by.samples > 0)
      std::copy_n(by.sums.begin() + ptrdiff_t(size_t(y - t.y0) * row), row, pixel(t.x0, y));
    else
      std::fill_n(pixel(t.x0, y), row, 0);
  }
}

Image Film::resolve() const {
  Image image(width_, height_);
  tbb::parallel_for(size_t(0), tiles(), [&](size_t t) {
    const std::lock_guard lock(mutex(t));
    if (samples_[t] == 0) return;
    const Tile tile = this->tile(t);
    const double unit = 1 / (scale_ * samples_[t]);
    const auto light = [&](int64_t sum) { return float(double(sum) * unit); };
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const int64_t* s = pixel(x, y);
        image.at(x, y) = {light(s[0]), light(s[1]), light(s[2])};
      }
  });
  return image;
}

}  // namespace raio
