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

  /// In the unit pixel: its centre for one cell, else a random point of the sample's cell.
  HWY_INLINE Wide2<D> in_pixel(U pixel) const {
    if (s_.aa == 1) return {hn::Set(d, 0.5f), hn::Set(d, 0.5f)};
    const uint32_t cell = sample_ / s_.per_cell;
    const auto r = random(pixel, sample_, hn::Set(du, kEyeBranch), kPixel);
    return {in_cell(hn::Set(d, float(cell % s_.aa)), r.x, s_.aa),
            in_cell(hn::Set(d, float(cell / s_.aa)), r.y, s_.aa)};
  }

  /// In the unit square, for one of the other purposes. The samples of a pixel share out the square
  /// among them, one random point in each of `samples` equal cells, dealt in an order of the
  /// pixel's own.
  HWY_INLINE Wide2<D> in_square(U pixel, U branch, uint32_t purpose) const {
    const auto r = random(pixel, sample_, branch, purpose);
    const auto order = random(pixel, ~0u, branch, purpose);
    const U dealt =
        hn::GatherIndex(du, deal_.data(),
                        hn::BitCast(di, hn::And(order.x, hn::Set(du, Sampler::kPermutations - 1))));
    const V samples = hn::Set(d, float(s_.samples)), columns = hn::Set(d, float(s_.columns));
    const V turn = hn::Floor(hn::Mul(to_unit(d, order.y), samples));
    V cell = hn::Add(hn::ConvertTo(d, hn::BitCast(di, dealt)), turn);
    cell = hn::IfThenElse(hn::Ge(cell, samples), hn::Sub(cell, samples), cell);
    const V row = hn::Floor(hn::Div(cell, columns));
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
