// Looks up EnergyTables, in SIMD, for bsdf-inl.h. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_INTEGRATE_ENERGY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_ENERGY_INL_H_
#undef RAIO_INTEGRATE_ENERGY_INL_H_
#else
#define RAIO_INTEGRATE_ENERGY_INL_H_
#endif

#include "integrate/energy.h"
#include "integrate/microfacets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// The position of a cosine in the columns of EnergyTables: a column, and the fraction of the way to
// the next. `width2`: the square of the width.
struct EnergyPlace {
  HWY_INLINE EnergyPlace(V cosine, V width2) {
    constexpr auto kColumns = int32_t(EnergyTables::kColumns);
    const V mu = clamp_unit(cosine), mu2 = squared(mu);
    const V shadow = hn::Sqrt(hn::Add(hn::Mul(width2, hn::Sub(hn::Set(d, 1), mu2)), mu2));
    const V low = hn::Div(hn::Mul(mu, hn::Set(d, 1.5f)), hn::Add(mu, hn::Set(d, 0.5f)));
    const V high = hn::Div(mu, hn::Max(shadow, hn::Set(d, 1e-30f)));
    const V along = hn::Mul(hn::Add(low, high), hn::Set(d, float(kColumns - 1) / 2));
    const V whole = hn::Min(hn::Floor(along), hn::Set(d, float(kColumns - 2)));
    part = hn::Sub(along, whole);
    column = hn::ConvertTo(Signed<D>(), whole);
  }

  hn::Vec<Signed<D>> column;
  V part;
};

// Looks up EnergyTables for the lanes' roughness.
class WideEnergy {
 public:
  // `smooth`: below EnergyTables::kSmoothest; `layered`: tables of a surface below layers.
  HWY_INLINE WideEnergy(const EnergyTables& tables, V roughness, M smooth, M layered)
      : numbers_(tables.numbers()) {
    constexpr float kRoot = EnergyTables::kSmoothestRoot;
    constexpr auto kRough = float(EnergyTables::kRows - 2);
    const V root = hn::Sub(hn::Sqrt(clamp_unit(roughness)), hn::Set(d, kRoot));
    const V along = hn::Max(hn::Mul(root, hn::Set(d, kRough / (1 - kRoot))), hn::Zero(d));
    const V whole = hn::Min(hn::Floor(along), hn::Set(d, kRough - 1));
    row_ = hn::ConvertTo(di, hn::IfThenZeroElse(smooth, hn::Add(whole, hn::Set(d, 1))));
    part_ = hn::IfThenZeroElse(smooth, hn::Sub(along, whole));
    const V widest = hn::Set(d, EnergyTables::kWidest);
    const V width = hn::IfThenElse(smooth, hn::IfThenElseZero(layered, widest),
                                   hn::Min(squared(roughness), widest));
    width2_ = squared(width);
  }
  // E at a cosine of 0 to 1, of the table at this offset.
  HWY_INLINE V at(U table, V cosine) const {
    constexpr auto kColumns = int32_t(EnergyTables::kColumns);
    const EnergyPlace place(cosine, width2_);
    const auto first = hn::Add(hn::BitCast(di, table),
                               hn::Add(hn::Mul(row_, hn::Set(di, kColumns)), place.column));
    const V top = mix(hn::GatherIndex(d, numbers_, first), hn::GatherIndex(d, numbers_ + 1, first),
                      place.part);
    const V bottom = mix(hn::GatherIndex(d, numbers_ + kColumns, first),
                         hn::GatherIndex(d, numbers_ + kColumns + 1, first), place.part);
    return mix(top, bottom, part_);
  }
  // The average over the hemisphere.
  HWY_INLINE V average(U table) const {
    const auto first = hn::Add(hn::BitCast(di, table), row_);
    constexpr auto kFirst = size_t(EnergyTables::kRows) * EnergyTables::kColumns;
    return mix(hn::GatherIndex(d, numbers_ + kFirst, first),
               hn::GatherIndex(d, numbers_ + kFirst + 1, first), part_);
  }
  // That of a perfectly smooth surface.
  HWY_INLINE V smooth_average(U table) const {
    constexpr auto kFirst = size_t(EnergyTables::kRows) * EnergyTables::kColumns;
    return hn::GatherIndex(d, numbers_ + kFirst, hn::BitCast(di, table));
  }

 private:
  static constexpr Signed<D> di{};
  static HWY_INLINE V mix(V a, V b, V part) { return hn::Add(a, hn::Mul(hn::Sub(b, a), part)); }

  const float* numbers_;
  hn::Vec<Signed<D>> row_;
  V part_, width2_;
};

// Looks up the layers of EnergyTables.
class WideLayers {
 public:
  // `first`: offsets of layers.
  HWY_INLINE WideLayers(const EnergyTables& tables, U first)
      : numbers_(tables.numbers()), first_(hn::BitCast(di, first)) {}
  HWY_INLINE EnergyPlace place(V cosine) const {
    return {cosine, hn::GatherIndex(d, numbers_, first_)};
  }
  HWY_INLINE V at(EnergyTables::LayerColumn column, const EnergyPlace& place) const {
    const float* const begin = numbers_ + 2 + column * EnergyTables::kColumns;
    const auto index = hn::Add(first_, place.column);
    const V low = hn::GatherIndex(d, begin, index), high = hn::GatherIndex(d, begin + 1, index);
    return hn::Add(low, hn::Mul(hn::Sub(high, low), place.part));
  }
  HWY_INLINE V average() const { return hn::GatherIndex(d, numbers_ + 1, first_); }

 private:
  static constexpr Signed<D> di{};
  const float* numbers_;
  hn::Vec<Signed<D>> first_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
