// Microfacets and their Fresnel reflectance, in SIMD, for bsdf-inl.h. Included once per instruction
// set (foreach_target.h).
#if defined(RAIO_INTEGRATE_MICROFACETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_MICROFACETS_INL_H_
#undef RAIO_INTEGRATE_MICROFACETS_INL_H_
#else
#define RAIO_INTEGRATE_MICROFACETS_INL_H_
#endif

#include <numbers>

#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

HWY_INLINE V squared(V x) { return hn::Mul(x, x); }
HWY_INLINE V clamp_unit(V x) { return hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, 1)); }
// (1 - x)^5.
HWY_INLINE V schlick_weight(V cosine) {
  const V x = clamp_unit(hn::Sub(hn::Set(d, 1), cosine)), x2 = squared(x);
  return hn::Mul(squared(x2), x);
}
// Fresnel's equations for unpolarised light; 1 at total internal reflection. `eta`: the index of
// refraction behind the surface relative to that in front.
HWY_INLINE V dielectric_reflectance(V cosine, V eta) {
  const V one = hn::Set(d, 1), zero = hn::Zero(d);
  const V k = hn::Sub(one, hn::Div(hn::Sub(one, squared(cosine)), squared(eta)));
  const V behind = hn::Sqrt(hn::Max(k, zero)), dense = hn::Mul(eta, cosine);
  const V parallel = hn::Div(hn::Sub(dense, behind), hn::Add(dense, behind));
  const V other = hn::Mul(eta, behind);
  const V perpendicular = hn::Div(hn::Sub(cosine, other), hn::Add(cosine, other));
  const V mean = hn::Mul(hn::Add(squared(parallel), squared(perpendicular)), hn::Set(d, 0.5f));
  return hn::IfThenElse(hn::Gt(k, zero), mean, one);
}

// Microfacets with the distribution GGX (Trowbridge and Reitz 1975) and Smith's masking, as seen
// from `out`.
class Microfacets {
 public:
  // If nothing is `transmitted`, normals that reflect the ray below the surface are left out where
  // possible: Tokuyoshi and Eto 2024, "Bounded VNDF Sampling for the Smith-GGX BRDF".
  HWY_INLINE Microfacets(V roughness, const V3& out, M transmitted) : out_(out) {
    const V one = hn::Set(d, 1);
    alpha_ = squared(roughness), alpha2_ = squared(alpha_);
    const V sine2 = hn::Add(squared(out.x), squared(out.y));
    stretched_ = hn::Sqrt(hn::Add(hn::Mul(alpha2_, sine2), squared(out.z)));
    const V s2 = squared(hn::Add(one, hn::Sqrt(sine2)));
    const V bound =
        hn::Div(hn::Mul(hn::Sub(one, alpha2_), s2), hn::Add(s2, hn::Mul(alpha2_, squared(out.z))));
    bound_ = hn::IfThenElse(transmitted, one, bound);
  }
  HWY_INLINE V alpha2() const { return alpha2_; }
  HWY_INLINE V distribution(V cosine) const {
    const V one = hn::Set(d, 1), c2 = squared(cosine);
    const V t = hn::Add(hn::Mul(c2, alpha2_), hn::Sub(one, c2));
    return hn::Div(alpha2_, hn::Max(hn::Mul(hn::Set(d, float(std::numbers::pi)), squared(t)),
                                    hn::Set(d, 1e-30f)));
  }
  // (1 + 2 Lambda) cosine.
  HWY_INLINE V shadow(V cosine) const {
    const V c2 = squared(cosine);
    return hn::Sqrt(hn::Add(alpha2_, hn::Mul(hn::Sub(hn::Set(d, 1), alpha2_), c2)));
  }
  // Of reflection with the reflectance 1: the value times the cosine of `in`, and the density of
  // visible_normal(), as that of reflected directions.
  HWY_INLINE V reflection(V density, V shadow_out, V cosine, V shadow_in) const {
    const V visible = hn::Div(
        hn::Set(d, 0.5f), hn::Max(hn::Add(hn::Mul(out_.z, shadow_in), hn::Mul(cosine, shadow_out)),
                                  hn::Set(d, 1e-30f)));
    return hn::Mul(hn::Mul(density, visible), cosine);
  }
  HWY_INLINE V reflection_pdf(V density) const {
    return hn::Div(density, hn::Mul(hn::Set(d, 2), hn::Add(hn::Mul(bound_, out_.z), stretched_)));
  }
  // The density of visible_normal() itself, where it is not bounded.
  HWY_INLINE V normal_pdf(V density, V out_half) const {
    return hn::Div(hn::Mul(hn::Mul(hn::Set(d, 2), out_half), density), hn::Add(out_.z, stretched_));
  }
  // Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", with a square root
  // instead of trigonometric functions. `r2`: the square of the disc point's radius.
  HWY_INLINE V3 visible_normal(const Wide2<D>& disc, V r2) const {
    const V one = hn::Set(d, 1);
    const V3 stretched = V3{hn::Mul(alpha_, out_.x), hn::Mul(alpha_, out_.y), out_.z} *
                         hn::Div(one, hn::Max(stretched_, hn::Set(d, 1e-30f)));
    const V lowest = hn::Mul(bound_, stretched.z);
    const V z = hn::Sub(hn::Mul(hn::Sub(one, r2), hn::Add(one, lowest)), lowest);
    const V scale = hn::Sqrt(hn::Mul(hn::Add(one, lowest), hn::Max(hn::Add(one, z), hn::Zero(d))));
    const V3 cap = {hn::Add(hn::Mul(disc.x, scale), stretched.x),
                    hn::Add(hn::Mul(disc.y, scale), stretched.y), hn::Add(z, stretched.z)};
    return normalize(
        d, V3{hn::Mul(alpha_, cap.x), hn::Mul(alpha_, cap.y), hn::Max(cap.z, hn::Set(d, 1e-20f))});
  }

 private:
  V3 out_;
  V alpha_, alpha2_, stretched_, bound_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
