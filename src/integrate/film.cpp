#include "integrate/film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "integrate/settings.h"

namespace raio {

RayCounts& RayCounts::operator+=(const RayCounts& b) {
  eye += b.eye, eye_hits += b.eye_hits;
  reflection += b.reflection, refraction += b.refraction;
  shadow += b.shadow, shadow_hits += b.shadow_hits;
  tests += b.tests, steps += b.steps;
  return *this;
}

namespace {

// The sum of the most samples that there can be stays below 2^62; and no finer than 2^-40, where a
// picture has no more to say.
double scale_for(double bound) {
  int exponent = 0;
  std::frexp(bound * kMaxSamples, &exponent);
  return std::ldexp(1.0, std::min(62 - exponent, 40));
}

}  // namespace

Film::Film(int width, int height, double bound, int tile_side, ChannelSet channels)
    : width_(width),
      height_(height),
      tile_side_(tile_side),
      columns_((width + tile_side - 1) / tile_side),
      bound_(std::clamp(bound, kMinBound, kMaxBound)),
      scale_(scale_for(bound_)),
      square_scale_(scale_for(bound_ * bound_)),
      layout_(channels),
      states_(size_t(columns_) * size_t((height + tile_side - 1) / tile_side)),
      sums_(tiles(), tile_sums()),
      means_(tiles(), size_t(layout_.means()) * tile_sums()),
      squares_(tiles(), size_t(layout_.squares()) * tile_sums()),
      firsts_(tiles(), size_t(layout_.firsts()) * tile_sums()) {}

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

Film::Sums Film::begin(size_t tile) {
  const std::lock_guard lock(mutex(tile));
  TileState& state = states_[tile];
  if (state.samples > 0) return {};
  if (state.begun) clear(tile);
  state.begun = true;
  return {sums_.of(tile), means_.of(tile), squares_.of(tile), firsts_.of(tile)};
}

void Film::clear(size_t tile) {
  sums_.clear(tile), means_.clear(tile), squares_.clear(tile), firsts_.clear(tile);
}

// Those of a tile with one sample.
void Film::add_squares_of_sums(size_t tile) {
  for (size_t plane = 0; plane < size_t(layout_.squares()); ++plane)
    for (size_t i = 0; i < tile_sums(); ++i) {
      const double value = double(sums_.of(tile)[i][plane]) / scale_;
      squares_.of(tile)[plane * tile_sums() + i] +=
          int64_t(std::nearbyint(value * value * square_scale_));
    }
}

void Film::add(size_t tile, uint32_t samples, const Sums& by, const RayCounts& rays) {
  const std::lock_guard lock(mutex(tile));
  if (PixelSums* const held = sums_.of(tile); held != by.sums) {  // has sample 0
    if (states_[tile].samples == 1) add_squares_of_sums(tile);
    for (size_t i = 0; i < tile_sums(); ++i)
      for (size_t c = 0; c < held[i].size(); ++c) held[i][c] += by.sums[i][c];
    for (size_t i = 0; i < means_.each; ++i) means_.of(tile)[i] += by.means[i];
    for (size_t i = 0; i < squares_.each; ++i) squares_.of(tile)[i] += by.squares[i];
  }
  states_[tile].samples += samples;
  states_[tile].rays += rays;
}

TileSamples Film::copy(size_t tile) const {
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  TileSamples out{states_[tile].samples, states_[tile].rays, {}, {}};
  if (out.samples == 0) return out;
  const size_t width = size_t(t.x1 - t.x0), pixels = width * size_t(t.y1 - t.y0);
  out.sums.reserve(4 * pixels), out.planes.reserve(size_t(layout_.planes()) * pixels);
  for (int y = t.y0; y < t.y1; ++y)
    for (size_t x = 0; x < width; ++x)
      out.sums.insert(out.sums.end(), row(tile, y)[x].begin(), row(tile, y)[x].end());
  for_numbers(t, [&](Channel channel, size_t component, int x, int y) {
    out.planes.push_back(held(channel, tile, x, y, component));
  });
  return out;
}

void Film::replace(size_t tile, const TileSamples& by) {
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  states_[tile] = {by.samples, false, by.rays};
  clear(tile);
  if (by.samples == 0) return;
  const size_t width = size_t(t.x1 - t.x0);
  const int64_t* s = by.sums.data();
  for (int y = t.y0; y < t.y1; ++y)
    for (size_t x = 0; x < width; ++x, s += 4) std::copy_n(s, 4, row(tile, y)[x].begin());
  const int64_t* p = by.planes.data();
  for_numbers(t, [&](Channel channel, size_t component, int x, int y) {
    hold(channel, tile, x, y, component, *p++);
  });
  if (by.samples == 1) squares_.clear(tile);
}

bool Film::can_hold(size_t tile, const TileSamples& numbers) const {
  const double samples = numbers.samples;
  // A sample may add to a number several times, each time rounded.
  constexpr double kSlack = 1 + 1e-3;
  const double most = samples * (bound_ * scale_ + 1), coverage = samples * double(kFullCoverage);
  for (size_t i = 0; i < numbers.sums.size(); ++i)
    if (std::abs(double(numbers.sums[i])) > (i % 4 < 3 ? most : coverage)) return false;
  const double square = samples * (bound_ * bound_ * square_scale_ + 1);
  const int64_t* p = numbers.planes.data();
  bool can = true;
  for_numbers(this->tile(tile), [&](Channel channel, size_t, int, int) {
    const auto number = double(*p++);
    const ChannelSpec& spec = spec_of(channel);
    switch (spec.rule) {
      case ChannelRule::first:
        can &= number >= 0 && number <= double(std::numeric_limits<uint32_t>::max());
        break;
      case ChannelRule::mean:
        can &= std::abs(number) <= samples * spec.bound * fixed_scale(spec) * kSlack;
        break;
      case ChannelRule::derived:
        can &= number >= 0 && number <= square;
        break;
    }
  });
  return can;
}

template <class F>
void Film::for_numbers(const Tile& tile, F&& f) const {
  for (const ChannelSpec& spec : kChannels) {
    if (!layout_.has_planes(spec.channel)) continue;
    for (size_t c = 0; c < spec.components.size(); ++c)
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) f(spec.channel, c, x, y);
  }
}

// Calls f(tile, its place) for all tiles that have samples.
template <class F>
void Film::for_tiles(F&& f) const {
  parallel_for(tiles(), [&](size_t t) {
    const std::lock_guard lock(mutex(t));
    if (states_[t].samples > 0) f(t, tile(t));
  });
}

Image Film::resolve() const {
  Image image(width_, height_);
  for_tiles([&](size_t t, const Tile& tile) {
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

int64_t Film::held(Channel channel, size_t tile, int x, int y, size_t component) const {
  const size_t pixel = row_start(y) + size_t(x % tile_side_);
  if (channel == Channel::alpha) return sums_.of(tile)[pixel][3];
  const size_t at = (layout_.plane(channel) + component) * tile_sums() + pixel;
  switch (spec_of(channel).rule) {
    case ChannelRule::first:
      return firsts_.of(tile)[at];
    case ChannelRule::mean:
      return means_.of(tile)[at];
    case ChannelRule::derived:
      break;
  }
  return squares_.of(tile)[at];
}

void Film::hold(Channel channel, size_t tile, int x, int y, size_t component, int64_t value) {
  const size_t at =
      (layout_.plane(channel) + component) * tile_sums() + row_start(y) + size_t(x % tile_side_);
  switch (spec_of(channel).rule) {
    case ChannelRule::first:
      firsts_.of(tile)[at] = uint32_t(value);
      break;
    case ChannelRule::mean:
      means_.of(tile)[at] = value;
      break;
    case ChannelRule::derived:
      squares_.of(tile)[at] = value;
      break;
  }
}

float Film::value(Channel channel, size_t tile, int x, int y, size_t component) const {
  const ChannelSpec& spec = spec_of(channel);
  const int64_t held = this->held(channel, tile, x, y, component);
  const double n = states_[tile].samples;
  if (channel == Channel::variance) {
    if (n < 2) return 0;
    const double mean = double(row(tile, y)[x % tile_side_][component]) / (scale_ * n);
    const double of_squares = double(held) / (square_scale_ * n);
    return float(std::max(0.0, (of_squares - mean * mean) * n / (n - 1)));
  }
  if (spec.rule == ChannelRule::mean) return float(double(held) / (fixed_scale(spec) * n));
  // No surface is at distance zero: nothing was found.
  if (channel == Channel::depth && held == 0) return std::numeric_limits<float>::infinity();
  return std::bit_cast<float>(uint32_t(held));
}

Film::Values Film::resolve(Channel channel) const {
  const ChannelSpec& spec = spec_of(channel);
  const size_t components = spec.components.size();
  const auto fill = [&](auto column, auto&& value) -> Values {
    column.assign(size_t(width_) * size_t(height_) * components, 0);
    for_tiles([&](size_t t, const Tile& tile) {
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
          for (size_t c = 0; c < components; ++c)
            column[(size_t(y) * size_t(width_) + size_t(x)) * components + c] = value(t, x, y, c);
    });
    return column;
  };
  if (channel == Channel::samples)
    return fill(Column<uint32_t>(), [&](size_t t, int, int, size_t) { return states_[t].samples; });
  if (spec.integer)
    return fill(Column<uint32_t>(), [&](size_t t, int x, int y, size_t c) {
      return uint32_t(held(channel, t, x, y, c));
    });
  return fill(Column<float>(),
              [&](size_t t, int x, int y, size_t c) { return value(channel, t, x, y, c); });
}

}  // namespace raio
