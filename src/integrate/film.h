// Sums of samples.
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

namespace raio::core {

/// The number of rays traced, by kind. Hits are rays that hit something.
struct RayCounts {
  uint64_t eye = 0, eye_hits = 0;
  uint64_t reflection = 0, refraction = 0;
  uint64_t shadow = 0, shadow_hits = 0;
  uint64_t tests = 0, steps = 0;  // with AccelOptions::counters

  uint64_t total() const { return eye + reflection + refraction + shadow; }
  RayCounts& operator+=(const RayCounts& b);
  friend bool operator==(const RayCounts&, const RayCounts&) = default;
};

/// A number of samples, and the first pixel of the film with one, row by row; 0, 0 if none.
struct CountedSamples {
  uint64_t count = 0;
  uint32_t x = 0, y = 0;

  CountedSamples& operator+=(const CountedSamples& b);
  friend bool operator==(const CountedSamples&, const CountedSamples&) = default;
};

/// Samples whose colours are not those computed.
struct SampleFaults {
  CountedSamples nans;     // NaN counts as black
  CountedSamples clamped;  // beyond the film's bound

  SampleFaults& operator+=(const SampleFaults& b) {
    nans += b.nans, clamped += b.clamped;
    return *this;
  }
  friend bool operator==(const SampleFaults&, const SampleFaults&) = default;
};

/// A rectangle of pixels, at most kMaxTileSide wide and high.
struct Tile {
  int x0, y0, x1, y1;
};
inline constexpr int kTileSide = 32, kMaxTileSide = 64;

/// A pixel's sums of red, green, blue and coverage; one SIMD instruction adds to all.
struct alignas(32) PixelSums : std::array<int64_t, 4> {};

// NOLINTNEXTLINE(modernize-use-using): takes no __extension__
__extension__ typedef unsigned __int128 Uint128;

/// The coverage of a sample that hits something.
inline constexpr int64_t kFullCoverage = int64_t(1) << 24;

/// A value v of a channel with the rule `mean` and its own bound counts as the integer nearest to v
/// * this, which leaves room for the sum of kMaxSamples values.
constexpr double own_scale(const ChannelSpec& spec) {
  double scale = double(1 << 24);
  while (scale * spec.bound > double(int64_t(1) << 38)) scale /= 2;
  return scale;
}

/// Maps the channels of a film to its planes of one number per pixel: sums of values, sums of
/// squared colours, and the values of the lowest sample. Alpha is in PixelSums; the number of
/// samples is stored per tile.
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
  /// The number of planes of each rule.
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

/// A tile's numbers in a film, all empty without samples. Row by row: r, g, b and coverage per
/// pixel; and plane by plane, as in FilmLayout, the numbers of the channels.
struct TileSamples {
  SampleSet samples;
  RayCounts rays;
  SampleFaults faults;
  std::vector<int64_t> sums, means;
  std::vector<int64_t> last_round;  // like `sums`, of a film with rounds
  std::vector<Uint128> squares;
  std::vector<uint32_t> firsts;

  friend bool operator==(const TileSamples&, const TileSamples&) = default;
};

/// The sums of a picture's samples and, for each tile, which samples these are, the same for all
/// its pixels. A film is a valid picture at any moment, and contains all that is needed to resume.
///
/// Sums are integers (fixed point). Integer addition is associative, so the same samples give the
/// same bytes in any order of tiles, threads, shards and resumes. The unit is a power of two chosen
/// from an upper bound of a sample, so that no sum overflows. Squares are exact: with a sample
/// below 2^39 units, 2^24 of them stay below 2^102.
///
/// Safe to read and to copy from while others add to it.
class Film {
 public:
  static constexpr double kMinBound = 1e-30, kMaxBound = 1e38;

  /// `bound`, clamped to the range of the two constants above, limits a sample's value. The tiles'
  /// side is a multiple of 8, at most kMaxTileSide; it does not affect the picture. A sparse film
  /// takes memory only for tiles with samples. A film with rounds also keeps the sums of the last
  /// round in which a tile has samples, unless it is the first.
  Film(int width, int height, double bound, int tile_side = kTileSide, ChannelSet channels = {},
       bool is_sparse = false, SampleRounds rounds = {});

  int width() const { return width_; }
  int height() const { return height_; }
  /// A value v counts as the integer nearest to min(v, bound) * scale.
  double bound() const { return bound_; }
  double scale() const { return scale_; }
  /// Those of a channel with the rule `mean`.
  double bound(const ChannelSpec& spec) const { return spec.bound > 0 ? spec.bound : bound_; }
  double scale(const ChannelSpec& spec) const { return spec.bound > 0 ? own_scale(spec) : scale_; }
  int tile_side() const { return tile_side_; }
  const FilmLayout& layout() const { return layout_; }
  SampleRounds rounds() const { return rounds_; }

  size_t tiles() const { return states_.size(); }
  Tile tile(size_t index) const;
  SampleSet samples(size_t tile) const;

  /// From row to row of a tile's sums: a power of two.
  size_t row_stride() const { return std::bit_ceil(size_t(std::min(tile_side_, width_))); }
  /// The number of sums of a tile, with padding between rows and beyond the picture's edge, and
  /// enough more that SIMD instructions never straddle two tiles.
  size_t tile_sums() const {
    constexpr size_t kLanes = 16;
    const size_t sums = row_stride() * size_t(std::min(tile_side_, height_));
    return (sums + kLanes - 1) / kLanes * kLanes;
  }

  /// Sums of a tile's samples: tile_sums() sums, and as many numbers per plane of the layout.
  /// Without `firsts`, no sample among them is lower than those of the tile.
  struct Sums {
    PixelSums* sums = nullptr;
    int64_t* means = nullptr;
    Uint128* squares = nullptr;
    uint32_t* firsts = nullptr;
  };

  /// The zeroed sums of a tile that has no samples yet, to be filled in place; the film ignores
  /// them until add(), and stays unchanged if that is never called. Null if there are samples.
  Sums begin(size_t tile);

  /// Adds samples missing from the tile, all of one round, and their cost. The sums are those of
  /// begin() unless the tile had samples.
  void add(size_t tile, SampleSpan samples, const Sums& by, const RayCounts& rays,
           const SampleFaults& faults = {});

  TileSamples copy(size_t tile) const;
  /// Adds samples from such a copy; the tile must not have them yet.
  void add(size_t tile, const TileSamples& by);
  void replace(size_t tile, const TileSamples& by);
  /// Whether this many samples can add up to these numbers, as many as a tile has. Others could
  /// overflow when samples are added or resolved.
  bool can_hold(const TileSamples& numbers) const;

  /// The mean of each pixel's samples; black without samples.
  Image resolve() const;

  /// The values of a channel of the film, `components` per pixel, row by row.
  using Values = std::variant<Column<float>, Column<uint32_t>>;
  Values resolve(Channel channel) const;

  RayCounts rays() const;
  SampleFaults faults() const;

 private:
  // Zeroes that cost nothing until they are used.
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
    Tiles(size_t tiles, size_t of_each, bool is_sparse)
        : each(of_each),
          numbers(map(tiles * each * sizeof(T), is_sparse), {tiles * each * sizeof(T)}) {}
    static T* map(size_t bytes, bool is_sparse) {
      return bytes == 0 ? nullptr : static_cast<T*>(map_zeroes(bytes, is_sparse));
    }
    T* of(size_t tile) const { return numbers.get() + tile * each; }
    void clear(size_t tile) const { std::fill_n(of(tile), each, T()); }

    size_t each;
    Zeroes<T> numbers;
  };

  struct TileState {
    SampleSet samples;
    bool begun = false;  // without samples, its numbers may be nonzero
    RayCounts rays;
    SampleFaults faults;
  };

  std::mutex& mutex(size_t tile) const { return mutexes_[tile % mutexes_.size()]; }
  void clear(size_t tile);
  // Prepares the sums of the last round for more samples; whether these belong to it.
  bool continues_last_round(size_t tile, uint32_t samples_end);
  void add_to_state(size_t tile, const SampleSet& samples, const RayCounts& rays,
                    const SampleFaults& faults);
  // For a pixel of the picture, in a tile that has samples.
  float value(Channel channel, size_t tile, int x, int y, size_t component) const;
  float variance(size_t tile, size_t pixel, size_t component) const;
  // For row `y` of the picture.
  size_t row_start(int y) const { return size_t(y % tile_side_) * row_stride(); }
  size_t pixel_of(int x, int y) const { return row_start(y) + size_t(x % tile_side_); }
  // Calls f(index) for the numbers of several planes, plane by plane and row by row.
  template <class F>
  void for_numbers(const Tile& tile, int planes, F&& f) const;

  template <class F>
  void for_tiles(F&& f) const;

  int width_, height_, tile_side_, columns_;
  double bound_, scale_;
  FilmLayout layout_;
  SampleRounds rounds_;
  // Each guards some tiles of the following: a prime number, so that threads half or a third of the
  // picture apart do not contend.
  mutable std::array<std::mutex, 61> mutexes_;
  std::vector<TileState> states_;
  Tiles<PixelSums> sums_;
  Tiles<PixelSums> last_round_;
  // Tile by tile, plane by plane; separate, so that unused ones take no memory.
  Tiles<int64_t> means_;
  Tiles<Uint128> squares_;
  Tiles<uint32_t> firsts_;
};

}  // namespace raio::core
