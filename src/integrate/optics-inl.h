// Mirrors, glass and highlights of the classic shading, which its explanation repeats. Included
// once per instruction set (foreach_target.h).
#if defined(RAIO_INTEGRATE_OPTICS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_OPTICS_INL_H_
#undef RAIO_INTEGRATE_OPTICS_INL_H_
#else
#define RAIO_INTEGRATE_OPTICS_INL_H_
#endif

#include "integrate/settings.h"
#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

HWY_INLINE V3 reflect(const V3& dir, const V3& n) {
  return dir - n * hn::Mul(hn::Set(d, 2), dot(dir, n));
}

// A smooth triangle's normal can send a ray through the surface that it should leave; then the
// geometric normal decides.
HWY_INLINE V3 mirrored(const V3& dir, const V3& normal, const V3& geometric) {
  const V3 out = renormalize(d, reflect(dir, normal));
  return select(hn::Gt(dot(out, geometric), hn::Zero(d)), out,
                renormalize(d, reflect(dir, geometric)));
}

// The square of the cosine behind the surface; negative at total internal reflection.
HWY_INLINE V squared_cosine_behind(V cosine, V eta) {
  const V one = hn::Set(d, 1);
  return hn::Sub(one, hn::Mul(hn::Mul(eta, eta), hn::Sub(one, hn::Mul(cosine, cosine))));
}

// Snell's law, for n on the incoming side of `dir`; removes lanes with total internal reflection
// from `in`.
HWY_INLINE V3 refract(const V3& dir, const V3& n, V eta, M& in) {
  const V cosine = hn::Neg(dot(dir, n)), k = squared_cosine_behind(cosine, eta);
  in = hn::And(in, hn::Ge(k, hn::Zero(d)));
  const V root = hn::Sqrt(hn::Max(k, hn::Zero(d)));
  return renormalize(d, dir * eta + n * hn::Sub(hn::Mul(eta, cosine), root));
}

// If the smooth normal sends the ray to the wrong side of the surface, the geometric normal
// replaces it.
HWY_INLINE V3 refracted(const V3& dir, const V3& normal, const V3& geometric, V eta, M& in) {
  M in_flat = in;
  const V3 out = refract(dir, normal, eta, in), flat = refract(dir, geometric, eta, in_flat);
  const M through = hn::Lt(dot(out, geometric), hn::Zero(d));
  in = hn::And(in, hn::Or(through, in_flat));
  return select(through, out, flat);
}

// The reflectance for unpolarised light, for n on the incoming side of `dir`; 1 at total internal
// reflection. Schlick's approximation uses the angle on the less dense side.
HWY_INLINE V reflectance(Fresnel fresnel, const V3& dir, const V3& n, V eta) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1), tiny = hn::Set(d, 1e-30f);
  const V in = hn::Min(hn::Max(hn::Neg(dot(dir, n)), zero), one);
  const V k = squared_cosine_behind(in, eta);
  const V out = hn::Sqrt(hn::Max(k, zero));
  const auto ratio = [&](V a, V b) HWY_ATTR {
    const V r = hn::Div(hn::Sub(a, b), hn::Max(hn::Add(a, b), tiny));
    return hn::Mul(r, r);
  };
  V part;
  if (fresnel == Fresnel::exact) {
    const V both = hn::Add(ratio(hn::Mul(eta, in), out), ratio(hn::Mul(eta, out), in));
    part = hn::Mul(both, hn::Set(d, 0.5f));
  } else {
    const V least = ratio(eta, one);
    const V x = hn::Sub(one, hn::IfThenElse(hn::Gt(eta, one), out, in)), x2 = hn::Mul(x, x);
    part = hn::Add(least, hn::Mul(hn::Sub(one, least), hn::Mul(hn::Mul(x2, x2), x)));
  }
  return hn::IfThenElse(hn::Lt(k, zero), one, part);
}

// The direction whose cosine with the eye's (Phong) or the normal (Blinn) determines the highlight:
// the light's, mirrored, or halfway between light and eye.
HWY_INLINE V3 mirrored_light(const V3& to_light, const V3& normal) {
  return reflect(-to_light, normal);
}
HWY_INLINE V3 halfway(const V3& to_light, const V3& in) { return normalize(d, to_light - in); }
// Their cosine to a power.
HWY_INLINE V highlight_power(V cosine, V shine) {
  return pow_unit(d, hn::Min(hn::Max(cosine, hn::Zero(d)), hn::Set(d, 1)), shine);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
