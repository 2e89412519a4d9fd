// Ellipsoids in SIMD lanes; shape/ellipsoid.h explains, and the order of operations is its.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_SHAPE_ELLIPSOID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_SHAPE_ELLIPSOID_INL_H_
#undef RAIO_SHAPE_ELLIPSOID_INL_H_
#else
#define RAIO_SHAPE_ELLIPSOID_INL_H_
#endif

#include "shape/ellipsoid.h"
#include "shape/first_hits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

template <class D, class V = hn::Vec<D>>
HWY_INLINE FirstHits<D> first_hits(D d, const EllipsoidNumbers<V>& e, const V* origin,
                                   const V* dir) {
  const auto dot3 = [&](const V* x, const V* y)
                        HWY_ATTR { return dot(d, x[0], x[1], x[2], y[0], y[1], y[2]); };
  V from_center[3], o[3], to[3], nearest[3];
  for (int a = 0; a < 3; ++a) from_center[a] = hn::Sub(origin[a], e.center[a]);
  for (int i = 0; i < 3; ++i)
    o[i] = dot3(from_center, e.to_unit[i]), to[i] = dot3(dir, e.to_unit[i]);
  const V per_unit = dot3(to, to);
  const V middle = hn::Div(hn::Neg(dot3(o, to)), per_unit);
  for (int i = 0; i < 3; ++i) nearest[i] = hn::Add(o[i], hn::Mul(to[i], middle));
  const V d2 = hn::Div(hn::Sub(hn::Set(d, 1.0), dot3(nearest, nearest)), per_unit);
  const hn::Mask<D> in = hn::Ge(d2, hn::Zero(d));
  const V half = hn::Sqrt(d2);
  return first_of(d, in, hn::Sub(middle, half), in, hn::Add(middle, half));
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
