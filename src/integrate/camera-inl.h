// The eye rays of camera.h for many points of the picture at once. Included once per instruction
// set (foreach_target.h).
#if defined(RAIO_INTEGRATE_CAMERA_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_CAMERA_INL_H_
#undef RAIO_INTEGRATE_CAMERA_INL_H_
#else
#define RAIO_INTEGRATE_CAMERA_INL_H_
#endif

#include "base/wide-inl.h"
#include "integrate/camera.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

template <class D>
struct WideRay {
  Wide3<D> origin, dir;
};

/// The vectors of EyeRays.
template <class D>
struct WideEye {
  Wide3<D> from, right, up, forward, corner, per_x, per_y;
};

template <class D>
HWY_INLINE WideEye<D> eye_at_rest(D tag, const EyeRays& eye) {
  return {set3(tag, eye.from),   set3(tag, eye.right), set3(tag, eye.up),   set3(tag, eye.forward),
          set3(tag, eye.corner), set3(tag, eye.per_x), set3(tag, eye.per_y)};
}

/// The vectors of a moving camera at a time.
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideEye<D> eye_at(D tag, const EyeRays& eye, V time) {
  const EyeRays::Movement& m = *eye.movement;
  const V begin = hn::Set(tag, m.begin), length = hn::Sub(hn::Set(tag, m.end), begin);
  const V part =
      hn::Min(hn::Max(hn::Div(hn::Sub(time, begin), length), hn::Zero(tag)), hn::Set(tag, 1.0f));
  const auto cross = [](const Wide3<D>& a, const Wide3<D>& b) HWY_ATTR {
    return Wide3<D>{hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
                    hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
                    hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
  };
  const Wide3<D> view = set3(tag, m.view) + set3(tag, m.view_by) * part;
  const Wide3<D> forward = normalize(tag, view);
  const Wide3<D> right = normalize(tag, cross(forward, set3(tag, m.up)));
  const Wide3<D> up = cross(right, forward);
  const Wide3<D> from = set3(tag, eye.from) + set3(tag, m.from_by) * part;
  V pixel = hn::Set(tag, m.pixel);
  V half_width = hn::Set(tag, m.half_width), half_height = hn::Set(tag, m.half_height);
  if (eye.parallel) {
    const V distance = hn::Sqrt(dot(view, view));
    pixel = hn::Mul(pixel, distance);
    half_width = hn::Mul(half_width, distance), half_height = hn::Mul(half_height, distance);
  }
  const Wide3<D> aside = right * hn::Neg(half_width) + up * half_height;
  return {from,
          right,
          up,
          forward,
          eye.parallel ? aside : forward - right * half_width + up * half_height,
          right * pixel,
          up * hn::Neg(pixel)};
}

/// From the eye through (x, y), in pixels from the upper left corner of the picture.
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideRay<D> pinhole(D tag, const WideEye<D>& eye, V x, V y) {
  return {eye.from, normalize(tag, eye.corner + eye.per_x * x + eye.per_y * y)};
}

/// Parallel to the line of sight, through (x, y).
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideRay<D> parallel(const WideEye<D>& eye, V x, V y) {
  return {eye.from + (eye.corner + eye.per_x * x + eye.per_y * y), eye.forward};
}

/// From the eye in the direction of (x, y) of a picture of all directions.
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideRay<D> omnidirectional(D tag, const EyeRays& rays, const WideEye<D>& eye, V x, V y) {
  const V half = hn::Set(tag, 0.5f);
  const V across = hn::Sub(hn::Div(x, hn::Set(tag, rays.columns)), half);
  const V down = hn::Sub(hn::Div(y, hn::Set(tag, rays.rows)), half);
  const Wide2<D> azimuth = on_circle(tag, across),
                 altitude = on_circle(tag, hn::Mul(down, hn::Neg(half)));
  const Wide3<D> level = eye.forward * azimuth.x + eye.right * azimuth.y;
  return {eye.from, normalize(tag, level * altitude.x + eye.up * altitude.y)};
}

/// From `lens` (a point of the unit disc, times `radius`) to the point of the focal plane that the
/// pinhole would see at (x, y). Cook, Porter and Carpenter 1984, "Distributed Ray Tracing".
template <class D, class V = hn::Vec<D>>
HWY_INLINE WideRay<D> thin_lens(D tag, const WideEye<D>& eye, V x, V y, const Wide2<D>& lens,
                                float radius, float focus) {
  const Wide3<D> towards = eye.corner + eye.per_x * x + eye.per_y * y;
  const V r = hn::Set(tag, radius);
  const Wide3<D> offset = eye.right * hn::Mul(lens.x, r) + eye.up * hn::Mul(lens.y, r);
  return {eye.from + offset, normalize(tag, towards * hn::Set(tag, focus) - offset)};
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
