// The numbers of sampler.h for many pixels at once, all of the same sample.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_RENDER_SAMPLER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_RENDER_SAMPLER_INL_H_
#undef RAIO_RENDER_SAMPLER_INL_H_
#else
#define RAIO_RENDER_SAMPLER_INL_H_
#endif

#include "base/wide-inl.h"
#include "render/sampler.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

template <class D>
class WideSampler {
 public:
  using V = hn::Vec<D>;
  using U = hn::Vec<Unsigned<D>>;

  WideSampler(const Sampler& sampler, uint32_t sample)
      : s_(sampler), sample_(sample), deal_(sampler.deal(sample)) {}

  /// In the unit pixel: its centre for one cell, else a random point of one of its cells. The cells
  /// are taken in an order of the pixel's own.
  HWY_INLINE Wide2<D> in_pixel(U pixel) const {
    if (s_.aa == 1) return {hn::Set(d, 0.5f), hn::Set(d, 0.5f)};
    const U branch = hn::Set(du, kEyeBranch);
    const V aa = hn::Set(d, float(s_.aa));
    const V turn = hn::Floor(hn::Div(dealt(pixel, branch, kPixel), hn::Set(d, float(s_.per_cell))));
    const V row = hn::Floor(hn::Div(turn, aa));
    const auto r = random(pixel, sample_, branch, kPixel);
    return {in_cell(hn::Sub(turn, hn::Mul(row, aa)), r.x, s_.aa), in_cell(row, r.y, s_.aa)};
  }

  /// In the unit square, for one of the other purposes. The samples of a pixel share out the square
  /// among them, one random point in each of `samples` equal cells, dealt in an order of the
  /// pixel's block: rays of neighbours then keep together, and which cell of the pixel goes with
  /// which cell of a light is random still, by the order in which the pixel takes its own.
  HWY_INLINE Wide2<D> in_square(U pixel, U block, U branch, uint32_t purpose) const {
    const V cell = dealt(block, branch, purpose), columns = hn::Set(d, float(s_.columns));
    const V row = hn::Floor(hn::Div(cell, columns));
    const auto r = random(pixel, sample_, branch, purpose);
    return {in_cell(hn::Sub(cell, hn::Mul(row, columns)), r.x, s_.columns),
            in_cell(row, r.y, s_.rows)};
  }

 private:
  const D d{};
  const Unsigned<D> du{};
  const Signed<D> di{};

  HWY_INLINE Wide4<Unsigned<D>> random(U pixel, uint32_t sample, U branch, uint32_t purpose) const {
    return hash4(du, {pixel, hn::Set(du, sample), branch, hn::Set(du, s_.seed + purpose)});
  }
  // Where the sample stands in the order that belongs to `key`: 0 .. samples - 1.
  HWY_INLINE V dealt(U key, U branch, uint32_t purpose) const {
    const auto order = random(key, ~0u, branch, purpose);
    const U which = hn::And(order.x, hn::Set(du, Sampler::kPermutations - 1));
    const U place = hn::GatherIndex(du, deal_.data(), hn::BitCast(di, which));
    const V samples = hn::Set(d, float(s_.samples));
    const V turn = hn::Floor(hn::Mul(to_unit(d, order.y), samples));
    const V sum = hn::Add(hn::ConvertTo(d, hn::BitCast(di, place)), turn);
    return hn::IfThenElse(hn::Ge(sum, samples), hn::Sub(sum, samples), sum);
  }
  HWY_INLINE V in_cell(V cell, U bits, uint32_t cells) const {
    return hn::Div(hn::Add(cell, to_unit(d, bits)), hn::Set(d, float(cells)));
  }

  const Sampler& s_;
  uint32_t sample_;
  Sampler::Deal deal_;
};

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
