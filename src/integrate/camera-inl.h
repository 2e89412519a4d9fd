// The eye rays of camera.h for many places of the picture at once.
// Once for each instruction set, as foreach_target.h passes again.
#if defined(RAIO_INTEGRATE_CAMERA_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_CAMERA_INL_H_
#undef RAIO_INTEGRATE_CAMERA_INL_H_
#else
#define RAIO_INTEGRATE_CAMERA_INL_H_
#endif

#include "base/wide-inl.h"
#include "integrate/camera.h"

HWY_BEFORE_NAMESPACE();
namespace raio::HWY_NAMESPACE {

template <class D>
struct WideRay {
  Wide3<D> origin, dir;
};

/// From the eye through (x, y): pixels from the upper left corner of the picture.
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideRay<D> pinhole(D tag, const EyeRays& eye, V x, V y) {
  const Wide3<D> towards =
      set3(tag, eye.corner) + set3(tag, eye.per_x) * x + set3(tag, eye.per_y) * y;
  return {set3(tag, eye.from), normalize(tag, towards)};
}

/// From `lens` (a point of the unit disc, times `radius`) to the point of the plane in focus that
/// the pinhole would see at (x, y). Cook, Porter and Carpenter 1984, "Distributed Ray Tracing".
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideRay<D> thin_lens(D tag, const EyeRays& eye, V x, V y, const Wide2<D>& lens,
                                float radius, float focus) {
  const Wide3<D> towards =
      set3(tag, eye.corner) + set3(tag, eye.per_x) * x + set3(tag, eye.per_y) * y;
  const V r = hn::Set(tag, radius);
  const Wide3<D> offset =
      set3(tag, eye.right) * hn::Mul(lens.x, r) + set3(tag, eye.up) * hn::Mul(lens.y, r);
  return {set3(tag, eye.from) + offset, normalize(tag, towards * hn::Set(tag, focus) - offset)};
}

}  // namespace raio::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
