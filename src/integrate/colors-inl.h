// The colours that primitives have of their own, in place of their materials'.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_INTEGRATE_COLORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_COLORS_INL_H_
#undef RAIO_INTEGRATE_COLORS_INL_H_
#else
#define RAIO_INTEGRATE_COLORS_INL_H_
#endif

#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {
namespace {

// Puts those of what the rays i, i + 1, ... hit into the lanes of `color`. Called for scenes that
// have any. A lane behind the last hit may hold whatever an earlier batch left there, also no item.
inline void look_up_colors(const Geometry& geometry, const HitBatch& hits, size_t i,
                           Floats3& color) {
  for (size_t k = i; k < i + kWidth; ++k) {
    const ItemId item = hits.item[k];
    const std::span<const Rgb> colors = geometry.colors(item_kind(item));
    if (item_index(item) < colors.size()) color.set(k, colors[item_index(item)]);
  }
}

}  // namespace
}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
