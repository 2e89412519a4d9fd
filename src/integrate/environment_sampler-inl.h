// Samples an environment by its distribution (environment_distribution.h), in SIMD. Included once
// per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_ENVIRONMENT_SAMPLER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_ENVIRONMENT_SAMPLER_INL_H_
#undef RAIO_INTEGRATE_ENVIRONMENT_SAMPLER_INL_H_
#else
#define RAIO_INTEGRATE_ENVIRONMENT_SAMPLER_INL_H_
#endif

#include <bit>

#include "integrate/environment-inl.h"
#include "integrate/environment_distribution.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

class EnvironmentSampler {
 public:
  // The distribution is that of the picture; it must outlive the sampler.
  EnvironmentSampler(const Environment& picture, const EnvironmentDistribution& distribution)
      : of_(distribution), frame_(picture) {}

  // A unit vector and its density per solid angle; 0 if no direction can be chosen.
  struct Sample {
    V3 dir;
    V density;
  };

  // `square`: in the unit square, without its right and lower edge. Points close to each other give
  // close directions, except across dark cells.
  HWY_INLINE Sample sample(const Wide2<D>& square) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1), half = hn::Set(d, 0.5f);
    if (of_.is_black()) return {frame_.direction(zero, zero, one), zero};
    const Choice row = choose(of_.rows.data(), hn::Zero(di), of_.height, square.y);
    const I first = hn::Mul(row.number, hn::Set(di, int(of_.width) + 1));
    const Choice column = choose(of_.columns.get(), first, of_.width - 1, square.x);
    const V along = hn::Add(hn::ConvertTo(d, hn::Sub(column.number, first)), column.part);
    const V azimuth = hn::Sub(hn::Div(hn::Add(along, half), hn::Set(d, float(of_.width))), half);
    const V height = hn::Add(hn::GatherIndex(d, of_.top.data(), row.number),
                             hn::Mul(hn::GatherIndex(d, of_.step.data(), row.number), row.part));
    const V radius = hn::Sqrt(hn::Mul(height, hn::Sub(hn::Set(d, 2), height)));
    const auto is_lower = hn::Gt(row.number, hn::Set(di, int(of_.height / 2)));
    const V from_zenith = hn::Sub(one, height);
    const V up = hn::IfThenElse(hn::RebindMask(d, is_lower), hn::Neg(from_zenith), from_zenith);
    const Wide2<D> circle = on_circle(d, azimuth);
    return {frame_.direction(hn::Mul(radius, circle.y), up, hn::Mul(radius, circle.x)),
            density(row.number, column.number)};
  }

  // The density of sample() at a unit vector; up to rounding, as sample() returns it.
  HWY_INLINE V density(const V3& dir) const {
    const auto place = frame_.place(dir);
    // The cell between the last column and the first, too, is in two halves.
    const V column = hn::IfThenElse(hn::Lt(place.left, hn::Zero(d)),
                                    hn::Set(d, float(of_.width) - 1), place.left);
    const I row = hn::Add(hn::ConvertTo(di, place.above), hn::Set(di, 1));
    const I first = hn::Mul(row, hn::Set(di, int(of_.width) + 1));
    return density(row, hn::Add(first, hn::ConvertTo(di, column)));
  }

 private:
  static constexpr Signed<D> di{};
  using I = hn::Vec<Signed<D>>;

  HWY_INLINE V density(I row, I cell) const {
    return hn::Mul(hn::ConvertTo(d, width(of_.columns.get(), cell)),
                   hn::GatherIndex(d, of_.density.data(), row));
  }
  static HWY_INLINE I width(const int32_t* sums, I number) {
    return hn::Sub(hn::GatherIndex(di, sums + 1, number), hn::GatherIndex(di, sums, number));
  }

  // The interval of `sums`, of those that begin with `first` to `first` + `last`, that contains
  // `u`, and where in it.
  struct Choice {
    I number;
    V part;
  };
  static HWY_INLINE Choice choose(const int32_t* sums, I first, uint32_t last, V u) {
    // In the middle between this number of 24 bits and the next one, so that an interval is not
    // found more often because it contains 0.
    const I key = hn::Add(hn::ShiftLeft<6>(hn::ConvertTo(di, hn::Mul(u, hn::Set(d, 0x1p24f)))),
                          hn::Set(di, 32));
    const I end = hn::Add(first, hn::Set(di, int(last) + 1));
    I number = first;  // the last whose sum is at most the key; that of `end` is greater
    for (auto step = int(std::bit_floor(last)); step > 0; step /= 2) {
      const I next = hn::Min(hn::Add(number, hn::Set(di, step)), end);
      number = hn::IfThenElse(hn::Gt(hn::GatherIndex(di, sums, next), key), number, next);
    }
    const I before = hn::Sub(key, hn::GatherIndex(di, sums, number));
    return {number, hn::Div(hn::ConvertTo(d, before), hn::ConvertTo(d, width(sums, number)))};
  }

  const EnvironmentDistribution& of_;
  EnvironmentFrame frame_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
