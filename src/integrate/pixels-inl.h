// The pixels of a tile: their positions in the picture, and the times of their samples. Included
// once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_PIXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_PIXELS_INL_H_
#undef RAIO_INTEGRATE_PIXELS_INL_H_
#else
#define RAIO_INTEGRATE_PIXELS_INL_H_
#endif

#include <algorithm>
#include <vector>

#include "integrate/sampler-inl.h"
#include "integrate/settings.h"
#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

class TilePixels {
 public:
  // The tile's pixels, numbered row by row as in the film, in blocks of 4 x 2, two of which form 4
  // x 4, four of which form 8 x 8, and so on: structures trace neighbours of the batch together.
  // `tile`: its place in the picture.
  void list(const Tile& tile, int row_bits) {
    const Tile before = std::exchange(tile_, tile);
    const int bits_before = std::exchange(row_bits_, row_bits);
    const int width = tile.x1 - tile.x0, height = tile.y1 - tile.y0;
    if (width == before.x1 - before.x0 && height == before.y1 - before.y0 &&
        row_bits == bits_before)
      return;
    count_ = 0;
    for (size_t i = 0; i < kTilePixels; i += kWidth) {
      const U n = hn::Iota(du, uint32_t(i));
      const auto bits = [&](uint32_t mask, int down) HWY_ATTR {
        return hn::ShiftRightSame(hn::And(n, hn::Set(du, mask)), down);
      };
      const U x =
          hn::Or(hn::Or(bits(3, 0), bits(1 << 4, 2)), hn::Or(bits(3 << 6, 3), bits(1 << 10, 5)));
      const U y = hn::Or(hn::Or(bits(3 << 2, 2), bits(1 << 5, 3)),
                         hn::Or(bits(3 << 8, 5), bits(1 << 11, 6)));
      const auto in = hn::And(hn::Lt(x, hn::Set(du, uint32_t(width))),
                              hn::Lt(y, hn::Set(du, uint32_t(height))));
      put(hn::Add(hn::ShiftLeftSame(y, row_bits_), x), hn::RebindMask(d, in), number_, count_);
      count_ += hn::CountTrue(du, in);
    }
  }

  size_t count() const { return count_; }
  HWY_INLINE U numbers(size_t i) const { return hn::Load(du, number_ + i); }
  // One more than the largest number.
  size_t range() const { return size_t(tile_.y1 - tile_.y0) << row_bits_; }

  // Positions in the picture.
  HWY_INLINE U column_of(U pixel) const {
    return hn::Add(hn::And(pixel, hn::Set(du, (1u << row_bits_) - 1)),
                   hn::Set(du, uint32_t(tile_.x0)));
  }
  HWY_INLINE U row_of(U pixel) const {
    return hn::Add(hn::ShiftRightSame(pixel, row_bits_), hn::Set(du, uint32_t(tile_.y0)));
  }
  // As in integrate/sampler.h.
  HWY_INLINE U place_of(U pixel) const {
    const bool far = std::max(tile_.x1, tile_.y1) > 0x10000;
    return place_in_picture(du, row_of(pixel), column_of(pixel), far);
  }

 private:
  Tile tile_{};
  int row_bits_ = 0;  // bits of a pixel's number within a row
  size_t count_ = 0;
  alignas(64) uint32_t number_[kTilePixels + 16]{};
};

// When the pixels' samples are taken, in scenes where something moves.
class SampleTimes {
 public:
  void draw(const TilePixels& pixels, const RenderSettings& settings,
            const WideSampler<D>& sampler) {
    const V length = hn::Set(d, settings.shutter_close - settings.shutter_open);
    const U branch = hn::Set(du, kEyeBranch);
    times_.resize(pixels.range());
    for (size_t i = 0; i < pixels.count(); i += kWidth) {
      const U pixel = pixels.numbers(i);
      const V part = sampler.in_unit(pixels.place_of(pixel), branch, kTime);
      const V time = hn::Add(hn::Set(d, settings.shutter_open), hn::Mul(length, part));
      alignas(64) uint32_t number[kWidth];
      alignas(64) float at[kWidth];
      hn::Store(pixel, du, number), hn::Store(time, d, at);
      for (size_t k = 0; k < std::min(kWidth, pixels.count() - i); ++k) times_[number[k]] = at[k];
    }
  }

  // Lanes outside `mask` may have invalid pixel numbers.
  HWY_INLINE V of(U pixel, M mask) const {
    const U known = hn::IfThenElseZero(hn::RebindMask(du, mask), pixel);
    return hn::GatherIndex(d, times_.data(), hn::BitCast(Signed<D>(), known));
  }
  // Sets those of rays that belong one by one to `pixels`.
  void set(RayBatch& rays, const Column<uint32_t>& pixels) const {
    if (!rays.has_time()) rays.add_time();
    for (size_t i = 0; i < rays.size(); i += kWidth)
      hn::StoreU(of(load(pixels, i), hn::FirstN(d, rays.size() - i)), d, &rays.time[i]);
  }

 private:
  std::vector<float> times_;  // by pixel number
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
