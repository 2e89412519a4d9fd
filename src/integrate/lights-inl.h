// Samples the scene's lights (lights.h), in SIMD. Included once per instruction set
// (foreach_target.h).
#if defined(RAIO_INTEGRATE_LIGHTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_LIGHTS_INL_H_
#undef RAIO_INTEGRATE_LIGHTS_INL_H_
#else
#define RAIO_INTEGRATE_LIGHTS_INL_H_
#endif

#include <limits>

#include "integrate/lights.h"
#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

// The direction and length of rays to sampled points of a light. A surface that faces the point has
// the irradiance SampledLight::emission x `part`.
struct LightSample {
  V3 dir;
  V length, part;
};

HWY_INLINE LightSample sample_light(const SampledLight& light, const V3& point,
                                    const Wide2<D>& square) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1);
  Wide2<D> at = square;
  if (light.is_round) {
    at = square_to_disc(d, square.x, square.y);
    const V r2 = hn::Add(hn::Mul(at.x, at.x), hn::Mul(at.y, at.y));
    if (light.is_distant) {
      const V sine2 = hn::Mul(r2, hn::Set(d, dot(light.edge_u, light.edge_u)));
      const V along = hn::Sqrt(hn::Sub(one, sine2));
      return {set3(d, light.position) * along + set3(d, light.edge_u) * at.x +
                  set3(d, light.edge_v) * at.y,
              hn::Set(d, std::numeric_limits<float>::infinity()), hn::Div(one, along)};
    }
    // From the disc to the ring, keeping relative areas.
    const V hole = hn::Div(hn::Set(d, light.hole), hn::Max(r2, hn::Set(d, 1e-30f)));
    const V scale = hn::Sqrt(hn::Add(hole, hn::Set(d, 1 - light.hole)));
    at = {hn::Mul(at.x, scale), hn::Mul(at.y, scale)};
  }
  const V3 to_light =
      set3(d, light.position) + set3(d, light.edge_u) * at.x + set3(d, light.edge_v) * at.y - point;
  const V squared = dot(to_light, to_light), distance = hn::Sqrt(squared);
  const V3 dir = to_light * hn::IfThenElseZero(hn::Gt(distance, zero), hn::Div(one, distance));
  // Ends just short of the light, by the possible rounding of the division above.
  const V length = hn::Mul(distance, hn::Set(d, 1 - 4 * std::numeric_limits<float>::epsilon()));
  if (!light.decreases) return {dir, length, one};
  V cosine = hn::Neg(dot(dir, set3(d, light.axis)));
  if (light.is_two_sided) cosine = hn::Abs(cosine);
  const V inside =
      hn::Mul(hn::Sub(cosine, hn::Set(d, light.least_cosine)), hn::Set(d, light.steepness));
  const V t = hn::Min(hn::Max(inside, zero), one);
  const V smooth = hn::Mul(hn::Mul(t, t), hn::Sub(hn::Set(d, 3), hn::Add(t, t)));
  const V part = hn::Div(smooth, hn::Max(squared, hn::Set(d, light.nearest_squared)));
  return {dir, length, light.has_area ? hn::Mul(part, hn::Max(cosine, zero)) : part};
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
