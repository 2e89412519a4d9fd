// Discs in SIMD lanes; shape/disc.h explains, and the order of operations is its.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_SHAPE_DISC_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_SHAPE_DISC_INL_H_
#undef RAIO_SHAPE_DISC_INL_H_
#else
#define RAIO_SHAPE_DISC_INL_H_
#endif

#include "shape/disc.h"
#include "shape/first_hits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const DiscNumbers<V>& disc, const V* origin, const V* dir) {
  const auto dot3 = [&](const V* x, const V* y)
                        HWY_ATTR { return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]); };
  V to_center[3], from_center[3];
  for (int a = 0; a < 3; ++a) to_center[a] = hn::Sub(disc.center[a], origin[a]);
  const V t = hn::Div(dot3(disc.normal, to_center), dot3(disc.normal, dir));
  for (int a = 0; a < 3; ++a) from_center[a] = hn::Sub(hn::Mul(dir[a], t), to_center[a]);
  const V distance2 = dot3(from_center, from_center);
  const hn::Mask<D> in = hn::And(hn::Le(distance2, hn::Mul(disc.radius, disc.radius)),
                                 hn::Ge(distance2, hn::Mul(disc.inner, disc.inner)));
  return first_of(d, in, t, in, t);
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
