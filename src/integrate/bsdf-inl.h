// How surfaces scatter light, for the integrator `path`: value, sampling and density, in SIMD.
// docs/light.md has the formulas. Included once per instruction set (foreach_target.h).
//
// Directions are in the frame of the shading normal, z up. `out` points to where the ray came from,
// so out.z > 0; `in` to where the light comes from. Radiance is divided by the square of the index
// of refraction, so it does not change where light is refracted.
#if defined(RAIO_INTEGRATE_BSDF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAIO_INTEGRATE_BSDF_INL_H_
#undef RAIO_INTEGRATE_BSDF_INL_H_
#else
#define RAIO_INTEGRATE_BSDF_INL_H_
#endif

#include <numbers>

#include "integrate/energy.h"
#include "integrate/tile-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

HWY_INLINE V squared(V x) { return hn::Mul(x, x); }
HWY_INLINE V clamp_unit(V x) { return hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, 1)); }
HWY_INLINE V luminance(const V3& c) { return dot(c, set3(d, Vec3f(0.2126f, 0.7152f, 0.0722f))); }
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

// Looks up EnergyTables for the lanes' roughness.
class WideEnergy {
 public:
  // `smooth`: below EnergyTables::kSmoothest.
  HWY_INLINE WideEnergy(const EnergyTables& tables, V roughness, M smooth)
      : numbers_(tables.numbers()) {
    constexpr float kRoot = EnergyTables::kSmoothestRoot;
    constexpr auto kRough = float(EnergyTables::kRows - 2);
    const V root = hn::Sub(hn::Sqrt(clamp_unit(roughness)), hn::Set(d, kRoot));
    const V along = hn::Max(hn::Mul(root, hn::Set(d, kRough / (1 - kRoot))), hn::Zero(d));
    const V whole = hn::Min(hn::Floor(along), hn::Set(d, kRough - 1));
    row_ = hn::ConvertTo(di, hn::IfThenZeroElse(smooth, hn::Add(whole, hn::Set(d, 1))));
    part_ = hn::IfThenZeroElse(smooth, hn::Sub(along, whole));
    const V widest = hn::Set(d, EnergyTables::kWidest);
    width2_ = hn::IfThenZeroElse(smooth, squared(hn::Min(squared(roughness), widest)));
  }
  // E at a cosine of 0 to 1, of the table at this offset.
  HWY_INLINE V at(U table, V cosine) const {
    constexpr auto kColumns = int32_t(EnergyTables::kColumns);
    const V mu = clamp_unit(cosine), mu2 = squared(mu);
    const V shadow = hn::Sqrt(hn::Add(hn::Mul(width2_, hn::Sub(hn::Set(d, 1), mu2)), mu2));
    const V low = hn::Div(hn::Mul(mu, hn::Set(d, 1.5f)), hn::Add(mu, hn::Set(d, 0.5f)));
    const V high = hn::Div(mu, hn::Max(shadow, hn::Set(d, 1e-30f)));
    const V along = hn::Mul(hn::Add(low, high), hn::Set(d, float(kColumns - 1) / 2));
    const V whole = hn::Min(hn::Floor(along), hn::Set(d, float(kColumns - 2)));
    const V part = hn::Sub(along, whole);
    const auto first = hn::Add(hn::BitCast(di, table), hn::Add(hn::Mul(row_, hn::Set(di, kColumns)),
                                                               hn::ConvertTo(di, whole)));
    const V top =
        mix(hn::GatherIndex(d, numbers_, first), hn::GatherIndex(d, numbers_ + 1, first), part);
    const V bottom = mix(hn::GatherIndex(d, numbers_ + kColumns, first),
                         hn::GatherIndex(d, numbers_ + kColumns + 1, first), part);
    return mix(top, bottom, part_);
  }
  // The average over the hemisphere.
  HWY_INLINE V average(U table) const {
    const auto first = hn::Add(hn::BitCast(di, table), row_);
    constexpr auto kFirst = size_t(EnergyTables::kRows) * EnergyTables::kColumns;
    return mix(hn::GatherIndex(d, numbers_ + kFirst, first),
               hn::GatherIndex(d, numbers_ + kFirst + 1, first), part_);
  }
  // That of a perfectly smooth surface.
  HWY_INLINE V smooth_average(U table) const {
    constexpr auto kFirst = size_t(EnergyTables::kRows) * EnergyTables::kColumns;
    return hn::GatherIndex(d, numbers_ + kFirst, hn::BitCast(di, table));
  }

 private:
  static constexpr Signed<D> di{};
  static HWY_INLINE V mix(V a, V b, V part) { return hn::Add(a, hn::Mul(hn::Sub(b, a), part)); }

  const float* numbers_;
  hn::Vec<Signed<D>> row_;
  V part_, width2_;
};

// The surface at a point, a sum of lobes.
struct Lobes {
  V3 diffuse;     // albedo of the base
  V3 mirror;      // reflectance of a metal at normal incidence
  V mirror_edge;  // and at grazing incidence
  V3 coat;        // scales the dielectric reflection above the base
  V cover;        // the part of that reflection which the base does not receive
  V glass;        // the part that reflects and refracts like glass
  V3 tint;        // of what glass transmits
  V roughness;    // the square root of alpha
  V ior;          // inside, relative to outside; 1: no dielectric reflection, no tables
  V eta;          // of glass: the index of refraction behind the surface relative to that in front
  M thin;         // glass is a sheet
  // Offsets of energy tables. For thin glass, those of glass are the conductor's.
  U conductor, reflection, front, back;
};

// The product of BSDF and |in.z|, and the density per solid angle with which sample() chooses `in`.
struct BsdfValue {
  V3 value;
  V pdf;
};

struct BsdfSample {
  V3 in;
  V3 weight;  // value / pdf
  V pdf;      // 0 where the direction has no density, as that of a smooth mirror
  M through;  // to the other side
};

class Bsdf {
 public:
  HWY_INLINE Bsdf(const Lobes& lobes, const V3& out, const EnergyTables& tables)
      : s_(lobes),
        out_(out),
        smooth_(hn::Lt(lobes.roughness, hn::Set(d, EnergyTables::kSmoothest))),
        energy_(tables, lobes.roughness, smooth_) {
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    alpha2_ = squared(squared(s_.roughness));
    any_glass_ = !hn::AllFalse(d, hn::Gt(s_.glass, zero));
    any_mirror_ = !hn::AllFalse(d, hn::Gt(s_.mirror_edge, zero));
    any_coat_ = !hn::AllFalse(d, hn::Gt(s_.cover, zero));
    V specular = zero, rest = zero, missing = zero;
    // Nothing happens between equal media, for which there are no tables.
    const M equal = hn::Eq(s_.ior, one);
    clear_ = hn::AndNot(s_.thin, equal);
    cover_ = hn::IfThenZeroElse(equal, s_.cover);
    base_out_ = base_scale_ = one;
    if (any_coat_) {
      const V reflected = energy_.at(s_.reflection, out.z);
      base_out_ = hn::Sub(one, hn::Mul(cover_, reflected));
      base_scale_ = hn::Div(one, hn::Sub(one, hn::Mul(cover_, energy_.average(s_.reflection))));
      specular = hn::IfThenZeroElse(equal, hn::Mul(luminance(s_.coat), reflected));
    }
    rest = hn::Mul(luminance(s_.diffuse), base_out_);
    if (any_mirror_) {
      // All orders of scattering among microfacets, with the average reflectance of the metal.
      const V average = energy_.average(s_.conductor), lost = hn::Sub(one, average);
      missing_out_ = hn::Sub(one, energy_.at(s_.conductor, out.z));
      const V scale = hn::Div(s_.mirror_edge, hn::Max(hn::Mul(lost, s_.mirror_edge), kTiny()));
      const auto channel = [&](V f0) HWY_ATTR {
        const V f = hn::Div(hn::Add(hn::Mul(f0, hn::Set(d, 20)), s_.mirror_edge), hn::Set(d, 21));
        const V part = hn::Div(f, hn::Max(s_.mirror_edge, kTiny()));
        return hn::Div(hn::Mul(hn::Mul(f, part), hn::Mul(average, scale)),
                       hn::Sub(one, hn::Mul(hn::Min(part, one), lost)));  // colours may exceed 1
      };
      missing_ = {channel(s_.mirror.x), channel(s_.mirror.y), channel(s_.mirror.z)};
      specular = hn::Add(specular, luminance(mirror_at(out.z)));
      missing = hn::Mul(luminance(missing_), hn::Mul(missing_out_, lost));
    }
    V back = zero;
    if (any_glass_) {
      // Reciprocal, after Kulla and Conty: what glass lacks leaves diffusely on both sides.
      const V lost_front = hn::Max(hn::Sub(one, energy_.average(s_.front)), kTiny());
      const V lost_back = hn::Max(hn::Sub(one, energy_.average(s_.back)), kTiny());
      const V ratio =
          hn::IfThenElse(s_.thin, one, hn::Div(hn::Mul(squared(s_.eta), lost_back), lost_front));
      const V part = hn::Sub(one, energy_.smooth_average(s_.reflection));
      const V through = hn::Mul(hn::Min(one, ratio), part);
      glass_out_ = hn::IfThenZeroElse(clear_, hn::Sub(one, energy_.at(s_.front, out.z)));
      glass_reflected_ = hn::Div(hn::Mul(s_.glass, hn::Sub(one, through)), lost_front);
      glass_refracted_ = hn::Div(hn::Mul(s_.glass, through), lost_back);
      specular = hn::Add(specular, s_.glass);
      const V lacking = hn::Mul(s_.glass, glass_out_);
      back = hn::Mul(lacking, hn::Mul(through, luminance(s_.tint)));
      missing = hn::Add(missing, hn::Mul(lacking, hn::Sub(one, through)));
    }
    rest = hn::Add(rest, missing);
    const V diffuse = hn::Add(rest, back), all = hn::Add(specular, diffuse);
    specular_ = hn::IfThenElse(hn::Gt(all, zero), hn::Div(specular, all), zero);
    back_ = hn::IfThenElse(hn::Gt(diffuse, zero), hn::Div(back, diffuse), zero);
    // Half of what is missing.
    const V half = hn::Set(d, 0.5f);
    grazing_ = hn::IfThenElse(hn::Gt(rest, zero), hn::Mul(half, hn::Div(missing, rest)), half);
    const V alpha = hn::Sqrt(alpha2_), slant = hn::Sqrt(hn::Add(one, alpha2_));
    grazing_scale_ = hn::Mul(half, hn::Div(hn::Mul(alpha, slant), hn::Sub(slant, alpha)));
    bound_ = bound_of_normals();
  }

  // Of lobes with a density.
  HWY_INLINE BsdfValue evaluate(const V3& in) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
    const V inverse_pi = hn::Set(d, float(1 / std::numbers::pi));
    const M above = hn::Gt(in.z, zero);
    const V cosine = hn::Abs(in.z), flat = hn::Mul(cosine, inverse_pi);
    V3 value = set3(d, Rgb());
    V pdf = zero;
    // Diffuse lobes.
    if (!hn::AllFalse(d, above)) {
      V base = hn::Mul(base_out_, base_scale_);
      if (any_coat_)
        base = hn::Mul(base, hn::Sub(one, hn::Mul(cover_, energy_.at(s_.reflection, cosine))));
      V3 sum = s_.diffuse * base;
      if (any_mirror_)
        sum =
            sum + missing_ * hn::Mul(missing_out_, hn::Sub(one, energy_.at(s_.conductor, cosine)));
      if (any_glass_) {
        const V glass = hn::Mul(hn::Mul(glass_reflected_, glass_out_),
                                hn::Sub(one, energy_.at(s_.front, cosine)));
        sum = sum + V3{glass, glass, glass};
      }
      value = select(above, sum * flat, value);
    }
    const V rest = hn::Mul(hn::Sub(one, specular_), flat);
    pdf = hn::Mul(rest, hn::IfThenElse(above, hn::Sub(one, back_), back_));
    if (any_mirror_ || any_glass_) {
      const V part = hn::IfThenElse(above, grazing_, hn::Set(d, 0.5f));
      pdf = hn::Mul(pdf, hn::Add(hn::Sub(one, part), hn::Mul(part, grazing(cosine))));
    }
    const bool any_below = any_glass_ && !hn::AllTrue(d, above);
    if (any_below) {
      const V glass =
          hn::Mul(hn::Mul(glass_refracted_, glass_out_), hn::Sub(one, energy_.at(s_.back, cosine)));
      value = select(above, value, s_.tint * hn::Mul(glass, flat));
    }
    if (hn::AllTrue(d, smooth_) || hn::AllFalse(d, hn::Gt(specular_, zero))) return {value, pdf};
    // Microfacets.
    const M mirrored = hn::Or(above, s_.thin);
    V3 half = out_ + V3{in.x, in.y, cosine};
    if (any_below) half = select(mirrored, half, out_ + in * s_.eta);
    const V longest = dot(half, half);
    half = half * hn::Div(hn::CopySign(one, half.z), hn::Sqrt(hn::Max(longest, kTiny())));
    const V out_half = dot(out_, half);
    const V in_half = hn::Add(hn::Add(hn::Mul(in.x, half.x), hn::Mul(in.y, half.y)),
                              hn::Mul(hn::IfThenElse(mirrored, cosine, in.z), half.z));
    const V density = distribution(half.z);
    const Reflectances r = reflectances(hn::Max(out_half, zero));
    const V part = through_part(r);
    const V shadow_out = shadow(out_.z), shadow_in = shadow(cosine);
    // Reflection, also that of thin glass to the other side.
    const V visible =
        hn::Div(hn::Set(d, 0.5f),
                hn::Max(hn::Add(hn::Mul(out_.z, shadow_in), hn::Mul(cosine, shadow_out)), kTiny()));
    const V peak = hn::Mul(hn::Mul(density, visible), cosine);
    const V reflected_pdf =
        hn::Div(density, hn::Mul(hn::Set(d, 2), hn::Add(hn::Mul(bound_, out_.z), stretched_)));
    V3 shiny = r.reflected * peak;
    V shiny_pdf = hn::Mul(reflected_pdf, hn::Sub(one, part));
    if (any_below) {
      const V3 passed = s_.tint * hn::Mul(s_.glass, hn::Sub(one, r.glass));
      const M through = hn::Not(mirrored);
      // Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces".
      const V both = hn::Max(squared(hn::Add(out_half, hn::Mul(s_.eta, in_half))), kTiny());
      const V jacobian = hn::Div(hn::Mul(squared(s_.eta), hn::Abs(in_half)), both);
      const V lambdas =
          hn::Add(lambda_and_half(shadow_out, out_.z), lambda_and_half(shadow_in, cosine));
      const V masked =
          hn::Div(hn::Mul(density, out_half), hn::Max(hn::Mul(out_.z, lambdas), kTiny()));
      const V normal_pdf =
          hn::Div(hn::Mul(hn::Mul(hn::Set(d, 2), out_half), density), hn::Add(out_.z, stretched_));
      const M sound = hn::AndNot(clear_, hn::And(hn::Gt(out_half, zero), hn::Lt(in_half, zero)));
      const V refraction = hn::IfThenElseZero(sound, hn::Mul(masked, jacobian));
      const V refraction_pdf =
          hn::IfThenElseZero(sound, hn::Mul(hn::Mul(normal_pdf, jacobian), part));
      shiny = select(above, shiny, passed * hn::IfThenElse(through, refraction, peak));
      shiny_pdf = hn::IfThenElse(
          above, shiny_pdf, hn::IfThenElse(through, refraction_pdf, hn::Mul(reflected_pdf, part)));
    } else {
      shiny = select(above, shiny, set3(d, Rgb()));
      shiny_pdf = hn::IfThenElseZero(above, shiny_pdf);
    }
    const V3 sum = value + shiny;
    return {select(smooth_, value, sum),
            hn::IfThenElse(smooth_, pdf, hn::Add(hn::Mul(specular_, shiny_pdf), pdf))};
  }

  // `square`: a point of the unit square; `choice`: a number in [0, 1).
  HWY_INLINE BsdfSample sample(const Wide2<D>& square, V choice) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
    const Wide2<D> disc = square_to_disc(d, square.x, square.y);
    const V r2 = hn::Min(hn::Add(squared(disc.x), squared(disc.y)), one);
    const M specular = hn::Lt(choice, specular_);
    // Diffuse, on either side: proportional to the cosine, or more at grazing angles.
    const V left = hn::Div(hn::Sub(choice, specular_), hn::Max(hn::Sub(one, specular_), kTiny()));
    const M back = hn::Lt(left, back_);
    V up2 = hn::Sub(one, r2), around = one;
    if (any_mirror_ || any_glass_) {
      const V front = hn::Div(hn::Sub(left, back_), hn::Max(hn::Sub(one, back_), kTiny()));
      const V within = hn::IfThenElse(back, hn::Div(left, hn::Max(back_, kTiny())), front);
      const M flat = hn::Ge(within, hn::IfThenElse(back, hn::Set(d, 0.5f), grazing_));
      const V low = grazing_square(up2);
      around =
          hn::IfThenElse(flat, one, hn::Sqrt(hn::Div(hn::Sub(one, low), hn::Max(r2, kTiny()))));
      up2 = hn::IfThenElse(flat, up2, low);
    }
    const V up = hn::Sqrt(up2);
    V3 in = {hn::Mul(disc.x, around), hn::Mul(disc.y, around),
             hn::IfThenElse(back, hn::Neg(up), up)};
    V3 weight = set3(d, Rgb());
    M sharp = hn::And(specular, smooth_);
    if (!hn::AllFalse(d, specular)) {
      const V3 half = visible_normal(disc, r2);
      const V out_half = hn::Max(dot(out_, half), kTiny());
      const Reflectances r = reflectances(out_half);
      const V part = through_part(r);
      const M through = hn::Lt(hn::Div(choice, hn::Max(specular_, kTiny())), part);
      V3 dir = half * hn::Add(out_half, out_half) - out_;
      if (any_glass_ && !hn::AllFalse(d, through)) {
        const V k = hn::Sub(one, hn::Div(hn::Sub(one, squared(out_half)), squared(s_.eta)));
        const V along = hn::Sub(hn::Div(out_half, s_.eta), hn::Sqrt(hn::Max(k, zero)));
        const V3 refracted = half * along - out_ * hn::Div(one, s_.eta);
        const V3 flipped = {dir.x, dir.y, hn::Neg(dir.z)};
        dir = select(through, select(s_.thin, flipped, refracted), dir);
        sharp = hn::And(specular, hn::Or(smooth_, hn::And(through, clear_)));
      }
      // Lost on the wrong side.
      const M lost = hn::Xor(through, hn::Lt(dir.z, zero));
      const V chosen = hn::Mul(specular_, hn::IfThenElse(through, part, hn::Sub(one, part)));
      const V3 passed = s_.tint * hn::Mul(s_.glass, hn::Sub(one, r.glass));
      const V3 of_lobe = select(through, passed, r.reflected);
      weight = of_lobe * hn::IfThenZeroElse(lost, hn::Div(one, hn::Max(chosen, kTiny())));
      in = select(specular, dir, in);
      in = select(hn::And(specular, lost), set3(d, Rgb()), in);
    }
    V pdf = zero;
    if (!hn::AllTrue(d, sharp)) {
      const BsdfValue both = evaluate(in);
      const M sound = hn::Gt(both.pdf, zero);
      const V3 ratio =
          both.value * hn::IfThenElseZero(sound, hn::Div(one, hn::Max(both.pdf, kTiny())));
      weight = select(sharp, weight, ratio);
      pdf = hn::IfThenZeroElse(sharp, both.pdf);
    }
    return {in, weight, pdf, hn::Lt(in.z, zero)};
  }

 private:
  static HWY_INLINE V kTiny() { return hn::Set(d, 1e-30f); }

  struct Reflectances {
    V3 reflected;  // of all lobes
    V glass;
  };
  HWY_INLINE V3 mirror_at(V cosine) const {
    const V w = schlick_weight(cosine);
    const auto channel = [&](V f0) HWY_ATTR {
      return hn::Add(f0, hn::Mul(hn::Sub(s_.mirror_edge, f0), w));
    };
    return {channel(s_.mirror.x), channel(s_.mirror.y), channel(s_.mirror.z)};
  }
  HWY_INLINE Reflectances reflectances(V cosine) const {
    const V one = hn::Set(d, 1);
    Reflectances r = {any_mirror_ ? mirror_at(cosine) : set3(d, Rgb()), hn::Zero(d)};
    if (any_coat_) r.reflected = r.reflected + s_.coat * dielectric_reflectance(cosine, s_.ior);
    if (!any_glass_) return r;
    const V part = dielectric_reflectance(cosine, hn::IfThenElse(s_.thin, s_.ior, s_.eta));
    // Light is reflected many times within a sheet.
    r.glass = hn::IfThenElse(s_.thin, hn::Div(hn::Add(part, part), hn::Add(one, part)), part);
    const V white = hn::Mul(s_.glass, r.glass);
    r.reflected = r.reflected + V3{white, white, white};
    return r;
  }
  // The probability that glass transmits a ray that hits a microfacet.
  HWY_INLINE V through_part(const Reflectances& r) const {
    if (!any_glass_) return hn::Zero(d);
    const V through =
        hn::Mul(hn::Mul(s_.glass, hn::Sub(hn::Set(d, 1), r.glass)), luminance(s_.tint));
    return hn::Div(through, hn::Max(hn::Add(through, luminance(r.reflected)), kTiny()));
  }

  // GGX: Trowbridge and Reitz 1975.
  HWY_INLINE V distribution(V cosine) const {
    const V one = hn::Set(d, 1), c2 = squared(cosine);
    const V t = hn::Add(hn::Mul(c2, alpha2_), hn::Sub(one, c2));
    return hn::Div(alpha2_,
                   hn::Max(hn::Mul(hn::Set(d, float(std::numbers::pi)), squared(t)), kTiny()));
  }
  // (1 + 2 Lambda) cosine, of Smith's masking.
  HWY_INLINE V shadow(V cosine) const {
    const V c2 = squared(cosine);
    return hn::Sqrt(hn::Add(alpha2_, hn::Mul(hn::Sub(hn::Set(d, 1), alpha2_), c2)));
  }
  // Lambda + 1/2.
  static HWY_INLINE V lambda_and_half(V shadow, V cosine) {
    return hn::Div(shadow, hn::Max(hn::Add(cosine, cosine), kTiny()));
  }
  // Smooth surfaces lack light mostly at cosines of about alpha, so half of the rays that stand for
  // it have the density (cosine / pi) grazing(cosine). Without them, rare rays would be too bright.
  HWY_INLINE V grazing(V cosine) const {
    const V sum = hn::Max(hn::Add(squared(cosine), alpha2_), kTiny());
    return hn::Div(grazing_scale_, hn::Mul(sum, hn::Sqrt(sum)));
  }
  // The square of the cosine below which the part `u` of them is.
  HWY_INLINE V grazing_square(V u) const {
    const V one = hn::Set(d, 1), alpha = hn::Max(hn::Sqrt(alpha2_), hn::Set(d, 1e-6f));
    const V steep = hn::Div(one, alpha);
    const V flat = hn::Div(one, hn::Sqrt(hn::Add(one, alpha2_)));
    const V root = hn::Sub(steep, hn::Mul(u, hn::Sub(steep, flat)));
    return clamp_unit(hn::Sub(hn::Div(one, squared(root)), alpha2_));
  }
  // If nothing is transmitted, normals that reflect the ray below the surface are left out where
  // possible: Tokuyoshi and Eto 2024, "Bounded VNDF Sampling for the Smith-GGX BRDF".
  HWY_INLINE V bound_of_normals() {
    const V one = hn::Set(d, 1);
    const V sine2 = hn::Add(squared(out_.x), squared(out_.y));
    stretched_ = hn::Sqrt(hn::Add(hn::Mul(alpha2_, sine2), squared(out_.z)));
    const V s2 = squared(hn::Add(one, hn::Sqrt(sine2)));
    const V bound =
        hn::Div(hn::Mul(hn::Sub(one, alpha2_), s2), hn::Add(s2, hn::Mul(alpha2_, squared(out_.z))));
    return hn::IfThenElse(hn::Gt(s_.glass, hn::Zero(d)), one, bound);
  }
  // Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", with a square root
  // instead of trigonometric functions.
  HWY_INLINE V3 visible_normal(const Wide2<D>& disc, V r2) const {
    const V one = hn::Set(d, 1), alpha = squared(s_.roughness);
    const V3 stretched = V3{hn::Mul(alpha, out_.x), hn::Mul(alpha, out_.y), out_.z} *
                         hn::Div(one, hn::Max(stretched_, kTiny()));
    const V lowest = hn::Mul(bound_, stretched.z);
    const V z = hn::Sub(hn::Mul(hn::Sub(one, r2), hn::Add(one, lowest)), lowest);
    const V scale = hn::Sqrt(hn::Mul(hn::Add(one, lowest), hn::Max(hn::Add(one, z), hn::Zero(d))));
    const V3 cap = {hn::Add(hn::Mul(disc.x, scale), stretched.x),
                    hn::Add(hn::Mul(disc.y, scale), stretched.y), hn::Add(z, stretched.z)};
    const V3 normal = normalize(
        d, V3{hn::Mul(alpha, cap.x), hn::Mul(alpha, cap.y), hn::Max(cap.z, hn::Set(d, 1e-20f))});
    return select(smooth_, V3{hn::Zero(d), hn::Zero(d), one}, normal);
  }

  const Lobes& s_;
  const V3 out_;
  const M smooth_;
  M clear_;  // glass is invisible
  V cover_;  // 0 if the index of refraction is 1
  const WideEnergy energy_;
  V alpha2_;
  bool any_glass_, any_mirror_, any_coat_;
  V base_out_, base_scale_;  // of the diffuse base
  V missing_out_;            // of the mirror
  V3 missing_;
  V glass_out_, glass_reflected_, glass_refracted_;
  V specular_, back_;  // probabilities of sample()
  V grazing_, grazing_scale_;
  V bound_, stretched_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
