// Where samples are added up.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <mutex>
#include <variant>
#include <vector>

#include "base/memory.h"
#include "integrate/channels.h"
#include "io/image/image.h"

namespace raio {

/// How many rays of each kind were traced. A hit is counted where the ray met something.
struct RayCounts {
  uint64_t eye = 0, eye_hits = 0;
  uint64_t reflection = 0, refraction = 0;
  uint64_t shadow = 0, shadow_hits = 0;
  uint64_t tests = 0, steps = 0;  // with AccelOptions::counters

  uint64_t total() const { return eye + reflection + refraction + shadow; }
  RayCounts& operator+=(const RayCounts& b);
  friend bool operator==(const RayCounts&, const RayCounts&) = default;
};

/// A rectangle of pixels, at most kMaxTileSide wide and high.
struct Tile {
  int x0, y0, x1, y1;
};
inline constexpr int kTileSide = 32, kMaxTileSide = 64;

/// Of a pixel's samples: red, green, blue and coverage, so that one SIMD instruction adds to all.
struct alignas(32) PixelSums : std::array<int64_t, 4> {};

/// What a sample that something covers adds to the coverage.
inline constexpr int64_t kFullCoverage = int64_t(1) << 24;

/// A value v of a channel whose rule is `mean` counts as the integer nearest to v * this, which
/// leaves room for the sum of kMaxSamples of them.
constexpr double fixed_scale(const ChannelSpec& spec) {
  double scale = double(1 << 24);
  while (scale * spec.bound > double(int64_t(1) << 38)) scale /= 2;
  return scale;
}

/// Where the channels of a film are among its planes, each of which holds one number a pixel: sums
/// of what the samples bring, sums of its squares, and what sample 0 brought. Alpha is in
/// PixelSums, the number of samples with the tile.
class FilmLayout {
 public:
  explicit FilmLayout(ChannelSet channels) : channels_(channels) {
    for (const ChannelSpec& spec : kChannels) {
      if (!has_planes(spec.channel)) continue;
      int& planes = spec.rule == ChannelRule::first  ? firsts_
                    : spec.rule == ChannelRule::mean ? means_
                                                     : squares_;
      plane_[size_t(spec.channel)] = planes;
      planes += int(spec.components.size());
    }
  }
  ChannelSet channels() const { return channels_; }
  bool has(Channel channel) const { return channels_.has(channel); }
  bool has_planes(Channel channel) const {
    return has(channel) && channel != Channel::alpha && channel != Channel::samples;
  }
  /// How many there are of each.
  int means() const { return means_; }
  int squares() const { return squares_; }
  int firsts() const { return firsts_; }
  int planes() const { return means_ + squares_ + firsts_; }
  /// The first plane of a channel among those of its rule.
  size_t plane(Channel channel) const { return size_t(plane_[size_t(channel)]); }

 private:
  ChannelSet channels_;
  std::array<int, kChannels.size()> plane_{};
  int means_ = 0, squares_ = 0, firsts_ = 0;
};

/// What a film holds of a tile.
struct TileSamples {
  uint32_t samples = 0;  // 0 .. samples - 1 of all its pixels
  RayCounts rays;
  // Row by row, empty without samples: r, g, b and coverage for each pixel; and plane by plane, in
  // the order of kChannels, the numbers of the channels.
  std::vector<int64_t> sums, planes;

  friend bool operator==(const TileSamples&, const TileSamples&) = default;
};

/// The sums of a picture's samples and, for each tile, how many there are: a tile holds samples
/// 0 .. n - 1 of all its pixels or it would not be here, so that a film is a sound picture at any
/// moment, and all that is needed to go on with it.
///
/// Sums are integers (fixed point): adding integers is associative, so that the same samples give
/// the same bytes in whatever order, tiles, threads, shards or resumes they are added. The unit is
/// a power of two chosen from an upper bound of what a sample can bring, so that no sum overflows.
///
/// Safe to read and to copy from while others add to it.
class Film {
 public:
  static constexpr double kMinBound = 1e-30, kMaxBound = 1e38;

  /// No sample of a pixel brings more than `bound`, which is moved between these two. The tiles'
  /// side is a multiple of 8, at most kMaxTileSide; the picture is the same with any.
  Film(int width, int height, double bound, int tile_side = kTileSide, ChannelSet channels = {});

  int width() const { return width_; }
  int height() const { return height_; }
  /// A value v counts as the integer nearest to min(v, bound) * scale.
  double bound() const { return bound_; }
  double scale() const { return scale_; }
  /// Likewise for the square of a value, of which the channel `variance` is made.
  double square_scale() const { return square_scale_; }
  int tile_side() const { return tile_side_; }
  const FilmLayout& layout() const { return layout_; }

  size_t tiles() const { return states_.size(); }
  Tile tile(size_t index) const;
  uint32_t samples(size_t tile) const;

  /// From row to row of a tile's sums: a power of two.
  size_t row_stride() const { return std::bit_ceil(size_t(std::min(tile_side_, width_))); }
  /// Of a tile, with those between its rows and, of tiles at the edge, beyond them; and so many
  /// more that SIMD instructions never end between two tiles.
  size_t tile_sums() const {
    constexpr size_t kLanes = 16;
    const size_t sums = row_stride() * size_t(std::min(tile_side_, height_));
    return (sums + kLanes - 1) / kLanes * kLanes;
  }

  /// What the samples of a tile add up to: tile_sums() sums, and as many numbers for each plane of
  /// the layout. A single sample has no squares yet: they follow from its sums.
  struct Sums {
    PixelSums* sums = nullptr;
    int64_t *means = nullptr, *squares = nullptr;
    uint32_t* firsts = nullptr;
  };

  /// Those of a tile that has no samples yet, all zero, to be filled where they are; the film has
  /// nothing of them before add(), and all is as it was if that never comes. Null where there are
  /// samples.
  Sums begin(size_t tile);

  /// Adds `samples` samples of a tile and what they have cost. The sums are those of begin() unless
  /// it had samples.
  void add(size_t tile, uint32_t samples, const Sums& by, const RayCounts& rays);

  /// A tile as it is, to be kept elsewhere, and a tile as it shall be.
  TileSamples copy(size_t tile) const;
  void replace(size_t tile, const TileSamples& by);
  /// Whether numbers.samples samples can add up to these numbers, of which there are as many as the
  /// tile holds. Larger ones could overflow when more samples are added.
  bool can_hold(size_t tile, const TileSamples& numbers) const;

  /// The mean of each pixel's samples; black where there are none.
  Image resolve() const;

  /// A channel that the film has, `components` numbers a pixel, row by row.
  using Values = std::variant<Column<float>, Column<uint32_t>>;
  Values resolve(Channel channel) const;

  RayCounts rays() const;

 private:
  // Zeroes that cost nothing before they are used.
  template <class T>
  struct Unmap {
    size_t bytes;
    void operator()(T* memory) const { unmap_zeroes(memory, bytes); }
  };
  template <class T>
  using Zeroes = std::unique_ptr<T[], Unmap<T>>;
  // Numbers of all tiles, tile by tile.
  template <class T>
  struct Tiles {
    Tiles(size_t tiles, size_t of_each)
        : each(of_each), numbers(map(tiles * each * sizeof(T)), {tiles * each * sizeof(T)}) {}
    static T* map(size_t bytes) {
      return bytes == 0 ? nullptr : static_cast<T*>(map_zeroes(bytes));
    }
    T* of(size_t tile) const { return numbers.get() + tile * each; }
    void clear(size_t tile) const { std::fill_n(of(tile), each, T()); }

    size_t each;
    Zeroes<T> numbers;
  };

  struct TileState {
    uint32_t samples = 0;
    bool begun = false;  // without samples its numbers may not be zero
    RayCounts rays;
  };

  std::mutex& mutex(size_t tile) const { return mutexes_[tile % mutexes_.size()]; }
  void clear(size_t tile);
  void add_squares_of_sums(size_t tile);
  // Of a pixel of the picture in a tile that has samples.
  int64_t held(Channel channel, size_t tile, int x, int y, size_t component) const;
  void hold(Channel channel, size_t tile, int x, int y, size_t component, int64_t value);
  float value(Channel channel, size_t tile, int x, int y, size_t component) const;
  // Of row `y` of the picture.
  size_t row_start(int y) const { return size_t(y % tile_side_) * row_stride(); }
  PixelSums* row(size_t tile, int y) const { return sums_.of(tile) + row_start(y); }
  // Calls f(channel, component, x, y) for all numbers of a tile's channels, in the order in which
  // TileSamples has them.
  template <class F>
  void for_numbers(const Tile& tile, F&& f) const;

  template <class F>
  void for_tiles(F&& f) const;

  int width_, height_, tile_side_, columns_;
  double bound_, scale_, square_scale_;
  FilmLayout layout_;
  // Of what follows, each for some of the tiles: a prime number, so that threads that work half or
  // a third of the picture apart do not wait for each other.
  mutable std::array<std::mutex, 61> mutexes_;
  std::vector<TileState> states_;
  Tiles<PixelSums> sums_;
  // Plane by plane of each tile; apart, so that what is not used yet takes no memory.
  Tiles<int64_t> means_, squares_;
  Tiles<uint32_t> firsts_;
};

}  // namespace raio
