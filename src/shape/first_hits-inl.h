// Shared by the SIMD ends of all shape/<kind>.h. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_SHAPE_FIRST_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_SHAPE_FIRST_HITS_INL_H_
#undef RAIO_SHAPE_FIRST_HITS_INL_H_
#else
#define RAIO_SHAPE_FIRST_HITS_INL_H_
#endif

#include <hwy/highway.h>

#include "shape/kinds.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D, class V = hn::Vec<D>>
HWY_INLINE V dot(D, V ax, V ay, V az, V bx, V by, V bz) {
  return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz));
}

// For a lambda that must be inlined at every call.
#ifndef RAIO_INLINE_LAMBDA
#define RAIO_INLINE_LAMBDA HWY_ATTR __attribute__((always_inline))
#endif

// for_each_kind() and for_each_bounded_kind() for SIMD code: a function compiled for one
// instruction set is not inlined into one for all.
template <class F>
HWY_INLINE void visit_kinds(F&& f) {
  [&]<size_t... k>(std::index_sequence<k...>) HWY_ATTR {
    (f.template operator()<PrimitiveKind(k)>(), ...);
  }(std::make_index_sequence<kPrimitiveKinds>());
}
template <class F>
HWY_INLINE void visit_bounded_kinds(F&& f) {
  visit_kinds([&]<PrimitiveKind kind>() HWY_ATTR {
    if constexpr (kIsBounded<kind>) f.template operator()<kind>();
  });
}

// The first hits in front of rays, for shapes tested in double lanes of a tag D.
template <class D>
struct FirstHits {
  using Floats = hn::Rebind<float, D>;
  hn::Mask<Floats> in;
  hn::Vec<Floats> t;
};

// Converts to float like a cast: overflow becomes infinite. Highway's scalar fallback gives the
// largest float instead, which is nearer than the end of an infinite ray.
template <class F, class V>
HWY_INLINE hn::Vec<F> narrowed(F f, V x) {
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
  const hn::Rebind<double, F> wide;
  double from[hn::MaxLanes(F())];
  float to[hn::MaxLanes(F())];
  hn::StoreU(x, wide, from);
  for (size_t i = 0; i < hn::Lanes(f); ++i) to[i] = float(from[i]);
  return hn::LoadU(f, to);
#else
  return hn::DemoteTo(f, x);
#endif
}

// Of two hits per ray, valid where the masks are set, the first in front of the origin.
template <class D, class V = hn::Vec<D>, class M = hn::Mask<D>>
HWY_INLINE FirstHits<D> first_of(D tag, M in0, V t0, M in1, V t1) {
  const typename FirstHits<D>::Floats f;
  const auto none = hn::Zero(f);
  const auto narrow = [&](M m) HWY_ATTR {
    return hn::Ne(hn::DemoteTo(f, hn::IfThenElseZero(m, hn::Set(tag, 1.0))), none);
  };
  const auto near = narrowed(f, t0), far = narrowed(f, t1);
  const auto hit0 = hn::And(narrow(in0), hn::Gt(near, none));
  const auto hit1 = hn::And(narrow(in1), hn::Gt(far, none));
  return {hn::Or(hit0, hit1), hn::IfThenElse(hit0, near, far)};
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
