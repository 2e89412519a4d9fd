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
#include "integrate/sample_set.h"
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

/// Samples whose colour was not a number and counts as black.
struct NanSamples {
  uint64_t count = 0;
  uint32_t x = 0, y = 0;  // the first pixel of the film that has one, row by row; 0 without any

  NanSamples& operator+=(const NanSamples& b);
  friend bool operator==(const NanSamples&, const NanSamples&) = default;
};

/// A rectangle of pixels, at most kMaxTileSide wide and high.
struct Tile {
  int x0, y0, x1, y1;
};
inline constexpr int kTileSide = 32, kMaxTileSide = 64;

/// Of a pixel's samples: red, green, blue and coverage, so that one SIMD instruction adds to all.
struct alignas(32) PixelSums : std::array<int64_t, 4> {};

__extension__ typedef unsigned __int128 Uint128;

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
/// of what the samples bring, sums of the squares of their colours, and what the lowest sample
/// brought. Alpha is in PixelSums, the number of samples with the tile.
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

/// What a film holds of a tile. Row by row, all empty without samples: r, g, b and coverage for
/// each pixel; and plane by plane, as FilmLayout numbers them, the numbers of the channels.
struct TileSamples {
  SampleSet samples;
  RayCounts rays;
  NanSamples nans;
  std::vector<int64_t> sums, means;
  std::vector<Uint128> squares;
  std::vector<uint32_t> firsts;

  friend bool operator==(const TileSamples&, const TileSamples&) = default;
};

/// The sums of a picture's samples and, for each tile, which samples these are: of all its pixels
/// the same. A film is a sound picture at any moment, and all that is needed to go on with it.
///
/// Sums are integers (fixed point): adding integers is associative, so that the same samples give
/// the same bytes in whatever order, tiles, threads, shards or resumes they are added. The unit is
/// a power of two chosen from an upper bound of what a sample can bring, so that no sum overflows.
/// Squares are exact: with a sample below 2^39 units, 2^24 of them stay below 2^102.
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
  int tile_side() const { return tile_side_; }
  const FilmLayout& layout() const { return layout_; }

  size_t tiles() const { return states_.size(); }
  Tile tile(size_t index) const;
  SampleSet samples(size_t tile) const;

  /// From row to row of a tile's sums: a power of two.
  size_t row_stride() const { return std::bit_ceil(size_t(std::min(tile_side_, width_))); }
  /// Of a tile, with those between its rows and, of tiles at the edge, beyond them; and so many
  /// more that SIMD instructions never end between two tiles.
  size_t tile_sums() const {
    constexpr size_t kLanes = 16;
    const size_t sums = row_stride() * size_t(std::min(tile_side_, height_));
    return (sums + kLanes - 1) / kLanes * kLanes;
  }

  /// What samples of a tile add up to: tile_sums() sums, and as many numbers for each plane of the
  /// layout. Without `firsts` no sample among them is lower than those of the tile.
  struct Sums {
    PixelSums* sums = nullptr;
    int64_t* means = nullptr;
    Uint128* squares = nullptr;
    uint32_t* firsts = nullptr;
  };

  /// Those of a tile that has no samples yet, all zero, to be filled where they are; the film has
  /// nothing of them before add(), and all is as it was if that never comes. Null where there are
  /// samples.
  Sums begin(size_t tile);

  /// Adds samples that the tile lacks, and what they have cost. The sums are those of begin()
  /// unless it had samples.
  void add(size_t tile, SampleSpan samples, const Sums& by, const RayCounts& rays,
           const NanSamples& nans = {});

  /// A tile as it is, to be kept elsewhere. The same to be added, of samples that the tile lacks;
  /// and as the tile shall be.
  TileSamples copy(size_t tile) const;
  void add(size_t tile, const TileSamples& by);
  void replace(size_t tile, const TileSamples& by);
  /// Whether so many samples can add up to these numbers, of which there are as many as the tile
  /// holds. Others could overflow when more samples are added, or when they are resolved.
  bool can_hold(const TileSamples& numbers) const;

  /// The mean of each pixel's samples; black where there are none.
  Image resolve() const;

  /// A channel that the film has, `components` numbers a pixel, row by row.
  using Values = std::variant<Column<float>, Column<uint32_t>>;
  Values resolve(Channel channel) const;

  RayCounts rays() const;
  NanSamples nans() const;

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
    SampleSet samples;
    bool begun = false;  // without samples its numbers may not be zero
    RayCounts rays;
    NanSamples nans;
  };

  std::mutex& mutex(size_t tile) const { return mutexes_[tile % mutexes_.size()]; }
  void clear(size_t tile);
  void add_to_state(size_t tile, const SampleSet& samples, const RayCounts& rays,
                    const NanSamples& nans);
  // Of a pixel of the picture in a tile that has samples.
  float value(Channel channel, size_t tile, int x, int y, size_t component) const;
  float variance(size_t tile, size_t pixel, size_t component) const;
  // Of row `y` of the picture.
  size_t row_start(int y) const { return size_t(y % tile_side_) * row_stride(); }
  size_t pixel_of(int x, int y) const { return row_start(y) + size_t(x % tile_side_); }
  // Calls f(index) for the numbers of so many planes, plane by plane and row by row.
  template <class F>
  void for_numbers(const Tile& tile, int planes, F&& f) const;

  template <class F>
  void for_tiles(F&& f) const;

  int width_, height_, tile_side_, columns_;
  double bound_, scale_;
  FilmLayout layout_;
  // Of what follows, each for some of the tiles: a prime number, so that threads that work half or
  // a third of the picture apart do not wait for each other.
  mutable std::array<std::mutex, 61> mutexes_;
  std::vector<TileState> states_;
  Tiles<PixelSums> sums_;
  // Plane by plane of each tile; apart, so that what is not used yet takes no memory.
  Tiles<int64_t> means_;
  Tiles<Uint128> squares_;
  Tiles<uint32_t> firsts_;
};

}  // namespace raio
