#include "integrate/film.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/parallel.h"
#include "integrate/settings.h"

namespace raio::core {

RayCounts& RayCounts::operator+=(const RayCounts& b) {
  eye += b.eye, eye_hits += b.eye_hits;
  reflection += b.reflection, refraction += b.refraction;
  shadow += b.shadow, shadow_hits += b.shadow_hits;
  tests += b.tests, steps += b.steps;
  return *this;
}

CountedSamples& CountedSamples::operator+=(const CountedSamples& b) {
  if (b.count > 0 && (count == 0 || std::tie(b.y, b.x) < std::tie(y, x))) x = b.x, y = b.y;
  count += b.count;
  return *this;
}

namespace {

// Leaves room for the sum of the maximum number of samples below 2^62; the unit is at least 2^-40,
// since pictures need no finer one.
double scale_for(double bound) {
  int exponent = 0;
  std::frexp(bound * kMaxSamples, &exponent);
  return std::ldexp(1.0, std::min(62 - exponent, 40));
}

}  // namespace

Film::Film(int width, int height, double bound, int tile_side, ChannelSet channels, bool is_sparse,
           SampleRounds rounds)
    : width_(width),
      height_(height),
      tile_side_(tile_side),
      columns_((width + tile_side - 1) / tile_side),
      bound_(std::clamp(bound, kMinBound, kMaxBound)),
      scale_(scale_for(bound_)),
      layout_(channels),
      rounds_(rounds),
      states_(size_t(columns_) * size_t((height + tile_side - 1) / tile_side)),
      sums_(tiles(), tile_sums(), is_sparse),
      last_round_(tiles(), rounds.first > 0 ? tile_sums() : 0, is_sparse),
      means_(tiles(), size_t(layout_.means()) * tile_sums(), is_sparse),
      squares_(tiles(), size_t(layout_.squares()) * tile_sums(), is_sparse),
      firsts_(tiles(), size_t(layout_.firsts()) * tile_sums(), is_sparse) {}

Tile Film::tile(size_t index) const {
  const int x = int(index % size_t(columns_)) * tile_side_;
  const int y = int(index / size_t(columns_)) * tile_side_;
  return {x, y, std::min(x + tile_side_, width_), std::min(y + tile_side_, height_)};
}

SampleSet Film::samples(size_t tile) const {
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

SampleFaults Film::faults() const {
  SampleFaults all;
  for (size_t t = 0; t < tiles(); ++t) {
    const std::lock_guard lock(mutex(t));
    all += states_[t].faults;
  }
  return all;
}

Film::Sums Film::begin(size_t tile) {
  const std::lock_guard lock(mutex(tile));
  TileState& state = states_[tile];
  if (!state.samples.empty()) return {};
  if (state.begun) clear(tile);
  state.begun = true;
  return {sums_.of(tile), means_.of(tile), squares_.of(tile), firsts_.of(tile)};
}

void Film::clear(size_t tile) {
  sums_.clear(tile), last_round_.clear(tile);
  means_.clear(tile), squares_.clear(tile), firsts_.clear(tile);
}

bool Film::continues_last_round(size_t tile, uint32_t samples_end) {
  const SampleSet& samples = states_[tile].samples;
  const uint32_t last = samples.empty() ? 0 : rounds_.start(samples.end() - 1);
  const uint32_t round = rounds_.start(samples_end - 1);
  if (round > last) last_round_.clear(tile);
  return round > 0 && round >= last;
}

void Film::add_to_state(size_t tile, const SampleSet& samples, const RayCounts& rays,
                        const SampleFaults& faults) {
  TileState& state = states_[tile];
  state.samples.add(samples);
  state.rays += rays;
  state.faults += faults;
}

void Film::add(size_t tile, SampleSpan samples, const Sums& by, const RayCounts& rays,
               const SampleFaults& faults) {
  const std::lock_guard lock(mutex(tile));
  const auto add = [&](PixelSums* to) {
    for (size_t i = 0; i < tile_sums(); ++i)
      for (size_t c = 0; c < to[i].size(); ++c) to[i][c] += by.sums[i][c];
  };
  if (continues_last_round(tile, samples.end)) add(last_round_.of(tile));
  if (PixelSums* const held = sums_.of(tile); held != by.sums) {
    add(held);
    for (size_t i = 0; i < means_.each; ++i) means_.of(tile)[i] += by.means[i];
    for (size_t i = 0; i < squares_.each; ++i) squares_.of(tile)[i] += by.squares[i];
    if (by.firsts) std::copy_n(by.firsts, firsts_.each, firsts_.of(tile));
  }
  add_to_state(tile, samples, rays, faults);
}

TileSamples Film::copy(size_t tile) const {
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  const TileState& state = states_[tile];
  TileSamples out{state.samples, state.rays, state.faults, {}, {}, {}, {}, {}};
  if (out.samples.empty()) return out;
  const auto copy_sums = [&](const PixelSums* from, std::vector<int64_t>& to) {
    for_numbers(t, 1, [&](size_t i) { to.insert(to.end(), from[i].begin(), from[i].end()); });
  };
  copy_sums(sums_.of(tile), out.sums);
  if (rounds_.first > 0) copy_sums(last_round_.of(tile), out.last_round);
  const auto copy = [&](const auto& from, int planes, auto& to) {
    for_numbers(t, planes, [&](size_t i) { to.push_back(from.of(tile)[i]); });
  };
  copy(means_, layout_.means(), out.means);
  copy(squares_, layout_.squares(), out.squares);
  copy(firsts_, layout_.firsts(), out.firsts);
  return out;
}

void Film::add(size_t tile, const TileSamples& by) {
  if (by.samples.empty()) return;
  const Tile t = this->tile(tile);
  const std::lock_guard lock(mutex(tile));
  TileState& state = states_[tile];
  if (state.samples.empty() && state.begun) clear(tile);
  state.begun = true;
  const auto add = [&](const auto& from, int planes, const auto& to) {
    const auto* number = from.data();
    for_numbers(t, planes, [&](size_t i) { to.of(tile)[i] += *number++; });
  };
  const auto add_sums = [&](const std::vector<int64_t>& from, PixelSums* to) {
    const int64_t* number = from.data();
    for_numbers(t, 1, [&](size_t i) {
      for (int64_t& sum : to[i]) sum += *number++;
    });
  };
  add_sums(by.sums, sums_.of(tile));
  if (continues_last_round(tile, by.samples.end())) add_sums(by.last_round, last_round_.of(tile));
  add(by.means, layout_.means(), means_);
  add(by.squares, layout_.squares(), squares_);
  if (by.samples.first() < state.samples.first()) {
    firsts_.clear(tile);
    add(by.firsts, layout_.firsts(), firsts_);
  }
  add_to_state(tile, by.samples, by.rays, by.faults);
}

void Film::replace(size_t tile, const TileSamples& by) {
  {
    const std::lock_guard lock(mutex(tile));
    states_[tile] = {};
    clear(tile);
  }
  add(tile, by);
}

bool Film::can_hold(const TileSamples& numbers) const {
  const uint32_t samples = numbers.samples.count();
  // A sample may add to a value several times, rounded each time.
  constexpr double kSlack = 1 + 1e-3;
  const double sample = bound_ * scale_ + 1, most = samples * sample;
  const double coverage = samples * double(kFullCoverage);
  const size_t pixels = numbers.sums.size() / 4;
  for (const auto* const sums : {&numbers.sums, &numbers.last_round})
    for (size_t i = 0; i < sums->size(); ++i) {
      const auto sum = double((*sums)[i]);
      if (i % 4 < 3 ? std::abs(sum) > most : sum < 0 || sum > coverage) return false;
    }
  for (size_t i = 0; i < numbers.squares.size(); ++i) {
    const Uint128 squares = numbers.squares[i];
    if (double(squares) > most * sample) return false;
    // The variance is not negative.
    const int64_t sum = numbers.sums[i % pixels * 4 + i / pixels];
    const auto magnitude = Uint128(sum < 0 ? -sum : sum);
    if (squares * samples < magnitude * magnitude) return false;
  }
  for (const ChannelSpec& spec : kChannels) {
    if (spec.rule != ChannelRule::mean || !layout_.has_planes(spec.channel)) continue;
    // Several rays of a path can add to a light group.
    const double most_here =
        std::min(samples * bound(spec) * scale(spec) * (spec.bound > 0 ? kSlack : 64), 0x1p61);
    const size_t begin = layout_.plane(spec.channel) * pixels;
    for (size_t i = begin; i < begin + spec.components.size() * pixels; ++i)
      if (std::abs(double(numbers.means[i])) > most_here) return false;
  }
  return true;
}

template <class F>
void Film::for_numbers(const Tile& tile, int planes, F&& f) const {
  for (size_t plane = 0; plane < size_t(planes); ++plane)
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) f(plane * tile_sums() + pixel_of(x, y));
}

// Calls f(tile, its index) for all tiles that have samples.
template <class F>
void Film::for_tiles(F&& f) const {
  parallel_for(tiles(), [&](size_t t) {
    const std::lock_guard lock(mutex(t));
    if (!states_[t].samples.empty()) f(t, tile(t));
  });
}

Image Film::resolve() const {
  Image image(width_, height_);
  for_tiles([&](size_t t, const Tile& tile) {
    const double unit = 1 / (scale_ * states_[t].samples.count());
    const auto light = [&](int64_t sum) { return float(double(sum) * unit); };
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const PixelSums& s = sums_.of(t)[pixel_of(x, y)];
        image.at(x, y) = {light(s[0]), light(s[1]), light(s[2])};
      }
  });
  return image;
}

float Film::value(Channel channel, size_t tile, int x, int y, size_t component) const {
  const ChannelSpec& spec = spec_of(channel);
  const size_t pixel = pixel_of(x, y);
  if (channel == Channel::variance) return variance(tile, pixel, component);
  const size_t at = (layout_.plane(channel) + component) * tile_sums() + pixel;
  if (spec.rule == ChannelRule::mean) {
    const int64_t sum = channel == Channel::alpha ? sums_.of(tile)[pixel][3] : means_.of(tile)[at];
    return float(double(sum) / (scale(spec) * states_[tile].samples.count()));
  }
  const uint32_t first = firsts_.of(tile)[at];
  // No surface is at distance zero: nothing was hit.
  if (channel == Channel::depth && first == 0) return std::numeric_limits<float>::infinity();
  return std::bit_cast<float>(first);
}

// In integers, which lose nothing between a large mean and a small variance.
float Film::variance(size_t tile, size_t pixel, size_t component) const {
  const uint32_t n = states_[tile].samples.count();
  if (n < 2) return 0;
  const int64_t sum = sums_.of(tile)[pixel][component];
  const auto magnitude = Uint128(sum < 0 ? -sum : sum);
  const Uint128 squares = squares_.of(tile)[component * tile_sums() + pixel];
  return float(double(squares * n - magnitude * magnitude) /
               (double(n) * (n - 1) * scale_ * scale_));
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
    return fill(Column<uint32_t>(),
                [&](size_t t, int, int, size_t) { return states_[t].samples.count(); });
  if (spec.integer)
    return fill(Column<uint32_t>(), [&](size_t t, int x, int y, size_t c) {
      return firsts_.of(t)[(layout_.plane(channel) + c) * tile_sums() + pixel_of(x, y)];
    });
  return fill(Column<float>(),
              [&](size_t t, int x, int y, size_t c) { return value(channel, t, x, y, c); });
}

}  // namespace raio::core
