// The wavefront's data: columns for the rays of a tile, and the tile's part of the film. Included
// once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_TILE_INL_H_
#undef RAIO_INTEGRATE_TILE_INL_H_
#else
#define RAIO_INTEGRATE_TILE_INL_H_
#endif

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "base/wide-inl.h"
#include "integrate/film.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

using D = hn::CappedTag<float, kBatchPad>;
using DU = Unsigned<D>;
inline constexpr D d;
inline constexpr DU du;
using V = hn::Vec<D>;
using U = hn::Vec<DU>;
using M = hn::Mask<D>;
using V3 = Wide3<D>;
inline constexpr size_t kWidth = hn::MaxLanes(D());

// Two unit vectors perpendicular to n and each other, as Frame in base/vec.h.
struct WideFrame {
  V3 u, v;

  explicit HWY_INLINE WideFrame(const V3& n) {
    const V one = hn::Set(d, 1), sign = hn::CopySign(one, n.z);
    const V a = hn::Neg(hn::Div(one, hn::Add(sign, n.z))), b = hn::Mul(hn::Mul(n.x, n.y), a);
    u = {hn::Add(one, hn::Mul(hn::Mul(hn::Mul(sign, n.x), n.x), a)), hn::Mul(sign, b),
         hn::Neg(hn::Mul(sign, n.x))};
    v = {b, hn::Add(sign, hn::Mul(hn::Mul(n.y, n.y), a)), hn::Neg(n.y)};
  }
};

// Rays traced at a time. Bounds the memory of the ray tree: a level with this many rays goes before
// others, so none ever holds more than these and the children of another chunk.
inline constexpr size_t kChunk = 1024;
inline constexpr size_t kTilePixels = size_t(kMaxTileSide) * kMaxTileSide;

// A cache line more than needed: columns at multiples of 4096 bytes would share the same few cache
// lines.
struct alignas(64) Floats {
  float at[kChunk + 16];
};
struct Floats3 {
  Floats x, y, z;

  void set(size_t i, Vec3f v) { x.at[i] = v.x, y.at[i] = v.y, z.at[i] = v.z; }
};
HWY_INLINE V load(const Floats& f, size_t i) { return hn::Load(d, f.at + i); }
HWY_INLINE V3 load(const Floats3& f, size_t i) {
  return {load(f.x, i), load(f.y, i), load(f.z, i)};
}
HWY_INLINE void store(V v, Floats& f, size_t i) { hn::Store(v, d, f.at + i); }
HWY_INLINE void store(const V3& v, Floats3& f, size_t i) {
  store(v.x, f.x, i), store(v.y, f.y, i), store(v.z, f.z, i);
}

HWY_INLINE V load(const Column<float>& c, size_t i) { return hn::LoadU(d, &c[i]); }
HWY_INLINE U load(const Column<uint32_t>& c, size_t i) { return hn::LoadU(du, &c[i]); }

// Stores the lanes of `v` in `mask` contiguously from element i; what follows them is overwritten.
// (Compressing stores are slow on some machines.)
template <class T>
HWY_INLINE void put(hn::Vec<hn::Rebind<T, D>> v, M mask, T* column, size_t i) {
  const hn::Rebind<T, D> tag;
  hn::StoreU(hn::Compress(v, hn::RebindMask(tag, mask)), tag, column + i);
}
template <class T>
HWY_INLINE void put(hn::Vec<hn::Rebind<T, D>> v, M mask, Column<T>& column, size_t i) {
  put(v, mask, column.data(), i);
}

HWY_INLINE V3 origins(const RayBatch& rays, size_t i) {
  return {load(rays.ox, i), load(rays.oy, i), load(rays.oz, i)};
}
HWY_INLINE V3 directions(const RayBatch& rays, size_t i) {
  return {load(rays.dx, i), load(rays.dy, i), load(rays.dz, i)};
}
HWY_INLINE void put(const V3& origin, const V3& dir, V tmax, M mask, RayBatch& rays, size_t i) {
  put(origin.x, mask, rays.ox, i), put(origin.y, mask, rays.oy, i), put(origin.z, mask, rays.oz, i);
  put(dir.x, mask, rays.dx, i), put(dir.y, mask, rays.dy, i), put(dir.z, mask, rays.dz, i);
  put(tmax, mask, rays.tmax, i);
}

HWY_INLINE M is_whole(const V3& weight) {
  const V one = hn::Set(d, 1);
  return hn::And(hn::Eq(weight.x, one), hn::And(hn::Eq(weight.y, one), hn::Eq(weight.z, one)));
}

// The coverage of a part of a pixel.
inline int64_t covered(float part) { return std::llround(double(part) * double(kFullCoverage)); }

// Rays with their pixel's number in the tile, the branch of the ray tree (integrate/sampler.h) and
// the weight in the pixel.
struct PathRays {
  RayBatch rays;
  Column<uint32_t> pixel, branch;
  std::array<Column<float>, 3> weight;  // red, green and blue; only red if they are always equal
  bool tinted = false;                  // whether they may differ
  // The density per solid angle with which the direction was sampled, for multiple importance
  // sampling, or 0 for those that only the path finds; in use if `weighs`.
  Column<float> density;
  bool weighs = false;

  // Makes room for n rays and what `put` overwrites after them.
  void resize(size_t n) {
    rays.resize(n + kBatchPad);
    rays.resize(n);
    const size_t room = rays.capacity();
    if (pixel.size() >= room) return;
    pixel.resize(room), branch.resize(room);
    for (size_t c = 0; c < weights_each(); ++c) weight[c].resize(room);
    if (weighs) density.resize(room);
  }
  // Uses the same columns as `other`.
  void use_columns_of(const PathRays& other) { tinted = other.tinted, weighs = other.weighs; }
  size_t weights_each() const { return tinted ? 3 : 1; }
  HWY_INLINE void put(const V3& origin, const V3& dir, V tmax, U p, U b, const V3& w, M mask,
                      size_t i, V sampled = hn::Zero(d)) {
    HWY_NAMESPACE::put(origin, dir, tmax, mask, rays, i);
    HWY_NAMESPACE::put(p, mask, pixel, i), HWY_NAMESPACE::put(b, mask, branch, i);
    HWY_NAMESPACE::put(w.x, mask, weight[0], i);
    if (weighs) HWY_NAMESPACE::put(sampled, mask, density, i);
    if (!tinted) return;
    HWY_NAMESPACE::put(w.y, mask, weight[1], i), HWY_NAMESPACE::put(w.z, mask, weight[2], i);
  }
  HWY_INLINE V3 weights(size_t i) const {
    const V red = load(weight[0], i);
    if (!tinted) return {red, red, red};
    return {red, load(weight[1], i), load(weight[2], i)};
  }
  HWY_INLINE V densities(size_t i) const { return weighs ? load(density, i) : hn::Zero(d); }
  // Sets element i to element k of `from`, with `part` of its weight.
  void set(size_t i, const PathRays& from, size_t k, float part = 1) {
    rays.set(i, from.rays[k]);
    pixel[i] = from.pixel[k], branch[i] = from.branch[k];
    for (size_t c = 0; c < weights_each(); ++c) weight[c][i] = from.weight[c][k] * part;
    if (weighs) density[i] = from.density[k];
  }
  // Replaces this with the last rays of `from`, at most `count`, which are removed there.
  void take_last(size_t count, PathRays& from) {
    rays.clear();
    if (from.rays.size() <= count) return std::swap(*this, from);
    const size_t left = from.rays.size() - count;
    resize(count);
    const auto take = [&](auto& to, const auto& column) {
      std::copy_n(column.begin() + ptrdiff_t(left), count, to.begin());
    };
    RayBatch& a = rays;
    const RayBatch& b = from.rays;
    take(a.ox, b.ox), take(a.oy, b.oy), take(a.oz, b.oz);
    take(a.dx, b.dx), take(a.dy, b.dy), take(a.dz, b.dz), take(a.tmax, b.tmax);
    take(pixel, from.pixel), take(branch, from.branch);
    for (size_t c = 0; c < weights_each(); ++c) take(weight[c], from.weight[c]);
    if (weighs) take(density, from.density);
    from.rays.resize(left);
  }
};

// The pixels' sums in the current tile, in the film's fixed point: the film's own memory if it has
// no samples of the tile yet, so that nothing is copied.
class TileSums {
 public:
  // `first`: the lowest sample to come. `is_bounded`: no sample exceeds the film's bound, unless
  // that is the maximum, with lights near the largest float.
  void begin(Film& film, size_t tile, uint32_t first, bool is_bounded) {
    bound_ = film.bound(), scale_ = film.scale();
    largest_ = float(bound_);
    if (double(largest_) > bound_) largest_ = std::nextafter(largest_, 0.0f);
    layout_ = &film.layout();
    plane_size_ = film.tile_sums();
    tile_ = film.tile(tile), row_bits_ = std::countr_zero(film.row_stride());
    faults_ = {};
    sums_ = film.begin(tile);
    if (!sums_.sums) {
      const bool is_lowest = first < film.samples(tile).first();
      own_.assign(plane_size_, PixelSums());
      own_means_.assign(size_t(layout_->means()) * plane_size_, 0);
      own_squares_.assign(size_t(layout_->squares()) * plane_size_, 0);
      own_firsts_.assign(is_lowest ? size_t(layout_->firsts()) * plane_size_ : 0, 0);
      sums_ = {own_.data(), own_means_.data(), own_squares_.data(),
               is_lowest ? own_firsts_.data() : nullptr};
    }
    first_ = first;
    is_clamped_ = !is_bounded || bound_ == Film::kMaxBound;
    before_.resize(is_clamped_ || layout_->squares() > 0 ? plane_size_ : 0);
  }

  // Call before and after each sample. The sum of its rays can exceed the film's bound only if that
  // is the maximum, with lights near the largest float: then it is clamped.
  void begin_sample() {
    std::copy_n(sums_.sums, before_.size(), before_.begin());
    nan_pixels_.clear(), clamped_pixels_.clear();
  }
  void end_sample() {
    const auto most = int64_t(bound_ * scale_);
    for (uint32_t i = 0; is_clamped_ && i < before_.size(); ++i)
      for (size_t c = 0; c < 3; ++c) {
        const int64_t limit = before_[i][c] + most;
        if (sums_.sums[i][c] <= limit) continue;
        sums_.sums[i][c] = limit;
        clamped_pixels_.push_back(i);
      }
    if (layout_->squares() > 0) add_squares();
    if (!nan_pixels_.empty()) count(nan_pixels_, faults_.nans);
    if (!clamped_pixels_.empty()) count(clamped_pixels_, faults_.clamped);
  }

  // Whether the tile has no lower sample, so that this one sets channels with the rule `first`.
  bool is_first(uint32_t sample) const {
    return layout_->firsts() > 0 && sums_.firsts && sample == first_;
  }
  const SampleFaults& faults() const { return faults_; }

  // Adds the values in `mask`, one per entry of `pixels`, to a channel with the rule `mean`; or
  // sets the values of one with the rule `first`.
  HWY_INLINE void add_mean(Channel channel, const V3& values, const uint32_t* pixels, M mask) {
    const ChannelSpec& spec = spec_of(channel);
    const bool is_light = spec.bound == 0;
    const V most = hn::Set(d, is_light ? largest_ : float(spec.bound)), least = hn::Neg(most);
    const auto scale = hn::Set(kDoubles, is_light ? scale_ : own_scale(spec));
    const V3 numbers = without_nans(values, pixels, mask);
    const V parts[3] = {numbers.x, numbers.y, numbers.z};
    int64_t* const plane = sums_.means + layout_->plane(channel) * plane_size_;
    for (size_t c = 0; c < 3; ++c) {
      HWY_ALIGN float part[kWidth];
      HWY_ALIGN int64_t fixed[kWidth];
      hn::Store(hn::Min(hn::Max(parts[c], least), most), d, part);
      for (size_t k = 0; k < kWidth; k += hn::MaxLanes(kDoubles)) {
        const auto v = hn::PromoteTo(kDoubles, hn::Load(kHalves, part + k));
        hn::Store(hn::ConvertTo(kIntegers, hn::Round(hn::Mul(v, scale))), kIntegers, fixed + k);
      }
      for_lanes(mask, [&](size_t k) { plane[c * plane_size_ + pixels[k]] += fixed[k]; });
    }
  }
  HWY_INLINE void add_mean(Channel channel, uint32_t value, uint32_t pixel) {
    const auto most = uint32_t(spec_of(channel).bound);
    sums_.means[layout_->plane(channel) * plane_size_ + pixel] +=
        int64_t(own_scale(spec_of(channel))) * int64_t(std::min(value, most));
  }
  HWY_INLINE void set_first(Channel channel, size_t component, U values, const uint32_t* pixels,
                            M mask) {
    HWY_ALIGN uint32_t value[kWidth];
    hn::Store(values, du, value);
    uint32_t* const plane = sums_.firsts + (layout_->plane(channel) + component) * plane_size_;
    for_lanes(mask, [&](size_t k) { plane[pixels[k]] = value[k]; });
  }

  // Prefetches four pixels in a row.
  HWY_INLINE void prefetch(uint32_t pixel) const {
    hwy::Prefetch(sums_.sums + pixel), hwy::Prefetch(sums_.sums + pixel + 2);
  }

  // Adds the values in `mask`, one per entry of `pixels`, with the same coverage or one each.
  // Values beyond the film's bound are clamped, NaN counts as black.
  HWY_INLINE void add(const V3& values, const uint32_t* pixels, M mask, int64_t coverage = 0) {
    add(values, pixels, mask, [&](size_t) HWY_ATTR { return hn::Set(kIntegers, coverage); });
  }
  HWY_INLINE void add(const V3& values, const uint32_t* pixels, M mask, const int64_t* coverage) {
    add(values, pixels, mask,
        [&](size_t k) HWY_ATTR { return hn::LoadU(kIntegers, coverage + k); });
  }

  // Adds the same fixed() value to all of them.
  HWY_INLINE void add(const PixelSums& value, const uint32_t* pixels, M mask) {
    add_each(pixels, mask, [&](size_t) { return &value; });
  }
  PixelSums fixed(Rgb value) const {
    PixelSums sums{};
    for (size_t c = 0; c < 3; ++c) {
      const float in = std::min(std::max(value[int(c)], -largest_), largest_);
      sums[c] = std::isnan(value[int(c)]) ? 0 : std::llrint(double(in) * scale_);
    }
    return sums;
  }

  const Film::Sums& all() const { return sums_; }
  const FilmLayout& layout() const { return *layout_; }

 private:
  static constexpr hn::CappedTag<double, kWidth> kDoubles{};
  static constexpr hn::Rebind<float, decltype(kDoubles)> kHalves{};
  static constexpr hn::Rebind<int64_t, decltype(kDoubles)> kIntegers{};
  static constexpr hn::CappedTag<int64_t, 4> kFour{};

  template <class Coverage>
  HWY_INLINE void add(const V3& values, const uint32_t* pixels, M mask, const Coverage& coverage)
    requires std::is_invocable_v<Coverage, size_t>
  {
    PixelSums fixed[kWidth];
    HWY_ALIGN float channels[3][kWidth];
    hn::Store(values.x, d, channels[0]), hn::Store(values.y, d, channels[1]);
    hn::Store(values.z, d, channels[2]);
    const V most = hn::Set(d, largest_);
    const M sound =
        hn::And(hn::Le(hn::Abs(values.x), most),
                hn::And(hn::Le(hn::Abs(values.y), most), hn::Le(hn::Abs(values.z), most)));
    if (HWY_UNLIKELY(!hn::AllTrue(d, sound))) mend(values, pixels, mask, channels);
    for (size_t k = 0; k < kWidth; k += hn::MaxLanes(kDoubles)) {
      const auto column = [&](size_t c) HWY_ATTR { return to_fixed(channels[c] + k); };
      hn::StoreInterleaved4(column(0), column(1), column(2), coverage(k), kIntegers,
                            fixed[k].data());
    }
    add_each(pixels, mask, [&](size_t k) { return fixed + k; });
  }

  template <class Value>
  HWY_INLINE void add_each(const uint32_t* pixels, M mask, Value&& value) {
    for_lanes(mask, [&](size_t k) HWY_ATTR {
      int64_t* const sums = sums_.sums[pixels[k]].data();
      const int64_t* const by = value(k)->data();
      for (size_t c = 0; c < 4; c += hn::MaxLanes(kFour))
        hn::Store(hn::Add(hn::Load(kFour, sums + c), hn::Load(kFour, by + c)), kFour, sums + c);
    });
  }
  template <class F>
  static HWY_INLINE void for_lanes(M mask, F&& f) {
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    for (unsigned lanes = bits[0] | unsigned(bits[1]) << 8; lanes; lanes &= lanes - 1)
      f(hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes));
  }

  // Replaces NaN by black and notes the pixels of such lanes in `mask`.
  HWY_INLINE V3 without_nans(const V3& values, const uint32_t* pixels, M mask) {
    const M nan = hn::Or(hn::IsNaN(values.x), hn::Or(hn::IsNaN(values.y), hn::IsNaN(values.z)));
    if (HWY_LIKELY(hn::AllFalse(d, nan))) return values;
    for_lanes(hn::And(nan, mask), [&](size_t k) { nan_pixels_.push_back(pixels[k]); });
    return {hn::IfThenZeroElse(nan, values.x), hn::IfThenZeroElse(nan, values.y),
            hn::IfThenZeroElse(nan, values.z)};
  }
  HWY_NOINLINE void mend(const V3& values, const uint32_t* pixels, M mask,
                         float (&channels)[3][kWidth]) {
    const V3 numbers = without_nans(values, pixels, mask);
    const V most = hn::Set(d, largest_), least = hn::Neg(most);
    const V3 sizes = {hn::Abs(numbers.x), hn::Abs(numbers.y), hn::Abs(numbers.z)};
    for_lanes(hn::And(mask, hn::Gt(largest(sizes), most)),
              [&](size_t k) { clamped_pixels_.push_back(pixels[k]); });
    hn::Store(hn::Min(hn::Max(numbers.x, least), most), d, channels[0]);
    hn::Store(hn::Min(hn::Max(numbers.y, least), most), d, channels[1]);
    hn::Store(hn::Min(hn::Max(numbers.z, least), most), d, channels[2]);
  }
  // Pixels are numbered row by row.
  void count(std::vector<uint32_t>& pixels, CountedSamples& all) const {
    std::ranges::sort(pixels);
    const auto repeated = std::ranges::unique(pixels);
    pixels.erase(repeated.begin(), repeated.end());
    const uint32_t pixel = pixels.front(), column = pixel & ((1u << row_bits_) - 1);
    all += {pixels.size(), uint32_t(tile_.x0) + column, uint32_t(tile_.y0) + (pixel >> row_bits_)};
  }

  void add_squares() {
    for (size_t i = 0; i < plane_size_; ++i)
      for (size_t c = 0; c < 3; ++c) {
        const int64_t value = sums_.sums[i][c] - before_[i][c];
        const auto magnitude = Uint128(value < 0 ? -value : value);
        sums_.squares[c * plane_size_ + i] += magnitude * magnitude;
      }
  }

  // For values within the bound.
  HWY_INLINE hn::Vec<decltype(kIntegers)> to_fixed(const float* values) const {
    const auto v = hn::PromoteTo(kDoubles, hn::Load(kHalves, values));
    return hn::ConvertTo(kIntegers, hn::Round(hn::Mul(v, hn::Set(kDoubles, scale_))));
  }

  double bound_ = 1, scale_ = 1;
  float largest_ = 1;  // the largest float within the bound
  Film::Sums sums_;
  const FilmLayout* layout_ = nullptr;
  Column<PixelSums> own_;  // unless they are the film's
  Column<int64_t> own_means_;
  Column<Uint128> own_squares_;
  Column<uint32_t> own_firsts_;
  Column<PixelSums> before_;  // before the sample
  bool is_clamped_ = false;
  uint32_t first_ = 0;
  size_t plane_size_ = 0;
  Tile tile_{};
  int row_bits_ = 0;
  std::vector<uint32_t> nan_pixels_, clamped_pixels_;  // of the sample, possibly repeated
  SampleFaults faults_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
