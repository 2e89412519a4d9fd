// What the classic shading (classic_trace.cpp) works on: columns of numbers for the rays of a tile,
// and the tile's part of the film.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_RENDER_CLASSIC_TILE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_RENDER_CLASSIC_TILE_INL_H_
#undef RAIO_RENDER_CLASSIC_TILE_INL_H_
#else
#define RAIO_RENDER_CLASSIC_TILE_INL_H_
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "accel/accel.h"
#include "base/wide-inl.h"
#include "render/film.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {
namespace {

using D = hn::CappedTag<float, kBatchPad>;
using DU = Unsigned<D>;
const D d;
const DU du;
using V = hn::Vec<D>;
using U = hn::Vec<DU>;
using M = hn::Mask<D>;
using V3 = Wide3<D>;
constexpr size_t kWidth = hn::MaxLanes(D());

// Rays traced at a time. Bounds the memory of a ray tree: the deepest level goes first, so that no
// level ever holds more than the children of one such chunk.
constexpr size_t kChunk = size_t(kTileSide) * kTileSide;

// A cache line more than needed: columns that lie a multiple of 4096 bytes apart would share the
// same few lines of the cache.
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

// The lanes of `v` in `mask`, one after another from element i on; what follows them is
// overwritten. (Compressing while storing is slow on some machines.)
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

// Rays on their way, with the number of the pixel in the tile, the place in the ray tree
// (render/sampler.h) and the weight in the pixel.
struct PathRays {
  RayBatch rays;
  Column<uint32_t> pixel, branch;
  Column<float> weight;

  // Room for n rays and what `put` overwrites after them.
  void resize(size_t n) {
    rays.resize(n + kBatchPad);
    rays.resize(n);
    if (const size_t room = rays.capacity(); pixel.size() < room)
      pixel.resize(room), branch.resize(room), weight.resize(room);
  }
  void put(const V3& origin, const V3& dir, V tmax, U p, U b, V w, M mask, size_t i) {
    HWY_NAMESPACE::put(origin, dir, tmax, mask, rays, i);
    HWY_NAMESPACE::put(p, mask, pixel, i), HWY_NAMESPACE::put(b, mask, branch, i);
    HWY_NAMESPACE::put(w, mask, weight, i);
  }
  // Moves the last rays of `from`, at most `count`, here in place of what was here.
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
    take(pixel, from.pixel), take(branch, from.branch), take(weight, from.weight);
    from.rays.resize(left);
  }
};

// The pixels' sums in the tile that is being rendered, in the film's fixed point: a part of the
// film that stays in the nearest cache.
class TileSums {
 public:
  void clear(const Film& film) {
    bound_ = film.bound(), scale_ = film.scale();
    for (auto& channel : sums_) std::fill_n(channel, kChunk, 0);
    before_.resize(bound_ == Film::kMostBound ? 3 * kChunk : 0);
  }

  // Around each sample. What its rays bring together is beyond the film's bound only where that is
  // the most that there is, with lights near the end of floats: then no more than it counts.
  void begin_sample() {
    if (before_.empty()) return;
    for (size_t c = 0; c < 3; ++c) std::copy_n(sums_[c], kChunk, &before_[c * kChunk]);
  }
  void end_sample() {
    if (before_.empty()) return;
    const auto most = int64_t(bound_ * scale_);
    for (size_t c = 0; c < 3; ++c)
      for (size_t i = 0; i < kChunk; ++i)
        sums_[c][i] = std::min(sums_[c][i], before_[c * kChunk + i] + most);
  }

  // The values in `mask`, one for each of `pixels`.
  HWY_INLINE void add(const V3& values, const uint32_t* pixels, M mask) {
    HWY_ALIGN int64_t fixed[3][kWidth];
    to_fixed(values.x, fixed[0]), to_fixed(values.y, fixed[1]), to_fixed(values.z, fixed[2]);
    const U at = hn::LoadU(du, pixels);
    if (hn::AllTrue(d, mask) && hn::AllTrue(du, hn::Eq(at, hn::Iota(du, pixels[0])))) {
      for (int c = 0; c < 3; ++c)
        for (size_t k = 0; k < kWidth; ++k) sums_[c][pixels[0] + k] += fixed[c][k];
      return;
    }
    uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    for (unsigned lanes = bits[0] | unsigned(bits[1]) << 8; lanes; lanes &= lanes - 1) {
      const size_t k = hwy::Num0BitsBelowLS1Bit_Nonzero32(lanes);
      for (int c = 0; c < 3; ++c) sums_[c][pixels[k]] += fixed[c][k];
    }
  }

  std::array<const int64_t*, 3> channels() const { return {sums_[0], sums_[1], sums_[2]}; }

 private:
  // A value beyond what floats hold counts as the bound.
  HWY_INLINE void to_fixed(V value, int64_t* out) const {
    const hn::CappedTag<double, kWidth> doubles;
    const hn::Rebind<float, decltype(doubles)> floats;
    const hn::Rebind<int64_t, decltype(doubles)> integers;
    const auto bound = hn::Set(doubles, bound_), scale = hn::Set(doubles, scale_);
    HWY_ALIGN float values[kWidth];
    hn::Store(value, d, values);
    for (size_t k = 0; k < kWidth; k += hn::Lanes(doubles)) {
      const auto v = hn::PromoteTo(doubles, hn::Load(floats, values + k));
      const auto clamped = hn::IfThenElse(hn::Lt(v, bound), v, bound);
      hn::Store(hn::ConvertTo(integers, hn::Round(hn::Mul(clamped, scale))), integers, out + k);
    }
  }

  double bound_ = 1, scale_ = 1;
  int64_t sums_[3][kChunk + 8];  // as Floats
  std::vector<int64_t> before_;  // the sample
};

}  // namespace
}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
