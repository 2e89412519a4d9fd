// Spheres in SIMD lanes; shape/sphere.h explains.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_SHAPE_SPHERE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_SHAPE_SPHERE_INL_H_
#undef RAIO_SHAPE_SPHERE_INL_H_
#else
#define RAIO_SHAPE_SPHERE_INL_H_
#endif

#include "shape/first_hits-inl.h"
#include "shape/sphere.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

// Which lines of rays hit the spheres whose centres lie at (x, y, z) from their origins, and by
// middle and square of half of the chord where.
template <class D>
struct SphereLanes {
  hn::Mask<D> in;
  hn::Vec<D> middle, d2;
};
template <class D, class V = hn::Vec<D>>
HWY_INLINE SphereLanes<D> chord_test(D d, V x, V y, V z, V radius, V dx, V dy, V dz) {
  const V middle = dot(d, x, y, z, dx, dy, dz);
  const V px = hn::Sub(x, hn::Mul(dx, middle));
  const V py = hn::Sub(y, hn::Mul(dy, middle));
  const V pz = hn::Sub(z, hn::Mul(dz, middle));
  const V d2 = hn::Sub(hn::Mul(radius, radius), dot(d, px, py, pz, px, py, pz));
  return {hn::Ge(d2, hn::Zero(d)), middle, d2};
}
// The distance; not positive for spheres behind the ray.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V chord_distance(D d, V middle, V d2) {
  const V half = hn::Sqrt(d2);
  const V entry = hn::Sub(middle, half);
  return hn::IfThenElse(hn::Gt(entry, hn::Zero(d)), entry, hn::Add(middle, half));
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
