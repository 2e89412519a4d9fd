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

#include "integrate/energy-inl.h"
#include "integrate/microfacets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {

HWY_INLINE V luminance(const V3& c) { return dot(c, set3(d, Vec3f(0.2126f, 0.7152f, 0.0722f))); }

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
  // Layers above all this: a clear coat, and sheen below it. 0: none.
  V clearcoat, clearcoat_roughness;
  V3 clearcoat_normal;
  V3 sheen;
  V sheen_roughness;
  U layers;  // offset of tables
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
        layered_(hn::Gt(hn::Max(lobes.clearcoat, largest(lobes.sheen)), hn::Zero(d))),
        energy_(tables, lobes.roughness, smooth_, layered_),
        layers_(tables, lobes.layers),
        facets_(lobes.roughness, out, hn::Gt(lobes.glass, hn::Zero(d))) {
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    any_clearcoat_ = !hn::AllFalse(d, hn::Gt(s_.clearcoat, zero));
    any_sheen_ = !hn::AllFalse(d, hn::Gt(largest(s_.sheen), zero));
    any_layers_ = !hn::AllFalse(d, layered_);
    below_out_ = sheen_out_ = one;
    clearcoat_part_ = sheen_part_ = zero;
    V below = one;  // on average
    if (any_layers_) {
      const WideFrame frame(s_.clearcoat_normal);
      clearcoat_out_ = {dot(out, frame.u), dot(out, frame.v),
                        hn::Max(dot(out, s_.clearcoat_normal), hn::Set(d, 1e-6f))};
      const EnergyPlace place = layers_.place(clearcoat_out_.z);
      below_out_ = hn::IfThenElse(layered_, layers_.at(EnergyTables::kBelow, place), one);
      below = hn::IfThenElse(layered_, layers_.average(), one);
      const V coat = hn::Sub(one, layers_.at(EnergyTables::kBelowCoat, place));
      clearcoat_part_ = hn::IfThenElseZero(hn::Gt(s_.clearcoat, zero), coat);
      if (any_sheen_) {
        const EnergyPlace at = layers_.place(out.z);
        sheen_out_ = layers_.at(EnergyTables::kSheen, at);
        shadow_out_ = layers_.at(EnergyTables::kSheenShadow, at);
        sheen_part_ =
            hn::IfThenElseZero(layered_, hn::Sub(hn::Sub(one, below_out_), clearcoat_part_));
      }
    }
    any_glass_ = !hn::AllFalse(d, hn::Gt(s_.glass, zero));
    any_mirror_ = !hn::AllFalse(d, hn::Gt(s_.mirror_edge, zero));
    any_coat_ = !hn::AllFalse(d, hn::Gt(s_.cover, zero));
    V specular = zero, rest = zero, missing = zero;
    // Nothing happens between equal media, for which there are no tables.
    const M equal = hn::Eq(s_.ior, one);
    clear_ = hn::AndNot(s_.thin, equal);
    cover_ = hn::IfThenZeroElse(equal, s_.cover);
    base_out_ = below_out_, base_scale_ = one;
    if (any_layers_) base_scale_ = hn::Div(one, below);
    if (any_coat_) {
      const V reflected = energy_.at(s_.reflection, out.z);
      base_out_ = hn::Sub(below_out_, hn::Mul(cover_, reflected));
      base_scale_ = hn::Div(one, hn::Sub(below, hn::Mul(cover_, energy_.average(s_.reflection))));
      specular = hn::IfThenZeroElse(equal, hn::Mul(luminance(s_.coat), reflected));
    }
    rest = hn::Mul(luminance(s_.diffuse), base_out_);
    if (any_mirror_) {
      // All orders of scattering among microfacets, with the average reflectance of the metal.
      V average = energy_.average(s_.conductor);
      const V lost = hn::Sub(below, average);
      V lost_part = lost;
      if (any_layers_) average = hn::Div(average, below), lost_part = hn::Div(lost, below);
      missing_out_ = missing_at(below_out_, s_.conductor, out.z);
      const V scale = hn::Div(s_.mirror_edge, hn::Max(hn::Mul(lost, s_.mirror_edge), kTiny()));
      const auto channel = [&](V f0) HWY_ATTR {
        const V f = hn::Div(hn::Add(hn::Mul(f0, hn::Set(d, 20)), s_.mirror_edge), hn::Set(d, 21));
        const V part = hn::Div(f, hn::Max(s_.mirror_edge, kTiny()));
        return hn::Div(
            hn::Mul(hn::Mul(f, part), hn::Mul(average, scale)),
            hn::Sub(one, hn::Mul(hn::Min(part, one), lost_part)));  // colours may exceed 1
      };
      missing_ = {channel(s_.mirror.x), channel(s_.mirror.y), channel(s_.mirror.z)};
      specular = hn::Add(specular, hn::Mul(luminance(mirror_at(out.z)), below_out_));
      missing = hn::Mul(luminance(missing_), hn::Mul(missing_out_, lost));
    }
    V back = zero;
    if (any_glass_) {
      // Reciprocal, after Kulla and Conty: what glass lacks leaves diffusely on both sides.
      const V lost_front = hn::Max(hn::Sub(below, energy_.average(s_.front)), kTiny());
      const V below_behind = hn::IfThenElse(s_.thin, below, one);
      const V lost_back = hn::Max(hn::Sub(below_behind, energy_.average(s_.back)), kTiny());
      const V ratio =
          hn::IfThenElse(s_.thin, one, hn::Div(hn::Mul(squared(s_.eta), lost_back), lost_front));
      const V part = hn::Sub(one, energy_.smooth_average(s_.reflection));
      const V through = hn::Mul(hn::Min(one, ratio), part);
      glass_out_ = hn::IfThenZeroElse(clear_, missing_at(below_out_, s_.front, out.z));
      glass_reflected_ = hn::Div(hn::Mul(s_.glass, hn::Sub(one, through)), lost_front);
      glass_refracted_ = hn::Div(hn::Mul(s_.glass, through), lost_back);
      specular = hn::Add(specular, hn::Mul(s_.glass, below_out_));
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
    const V alpha2 = facets_.alpha2();
    const V alpha = hn::Sqrt(alpha2), slant = hn::Sqrt(hn::Add(one, alpha2));
    grazing_scale_ = hn::Mul(half, hn::Div(hn::Mul(alpha, slant), hn::Sub(slant, alpha)));
  }

  // Of lobes with a density.
  HWY_INLINE BsdfValue evaluate(const V3& in) const {
    if (!any_layers_) return base(in, hn::Set(d, 1));
    const V clearcoat_in = dot(in, s_.clearcoat_normal);
    const EnergyPlace place = layers_.place(hn::Abs(clearcoat_in));
    const M above = hn::Gt(in.z, hn::Zero(d));
    // Light that leaves solid glass does not meet the layers.
    BsdfValue all =
        base(in, hn::IfThenElse(hn::And(layered_, hn::Or(above, s_.thin)),
                                layers_.at(EnergyTables::kBelow, place), hn::Set(d, 1)));
    all.pdf = hn::Mul(all.pdf, base_part());
    const V3 sum = out_ + in;
    const V3 half = sum * hn::Div(hn::Set(d, 1), hn::Sqrt(hn::Max(dot(sum, sum), kTiny())));
    if (any_clearcoat_) {
      const M lit = hn::And(above, hn::Gt(clearcoat_in, hn::Zero(d)));
      add_clearcoat(half, clearcoat_in, lit, all);
    }
    if (any_sheen_) add_sheen(half.z, hn::Abs(in.z), above, all);
    return all;
  }

  // `square`: a point of the unit square; `choice`: a number in [0, 1).
  HWY_INLINE BsdfSample sample(const Wide2<D>& square, V choice) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
    const Wide2<D> disc = square_to_disc(d, square.x, square.y);
    const V r2 = hn::Min(hn::Add(squared(disc.x), squared(disc.y)), one);
    Proposal p = any_layers_ ? propose_layers(disc, r2, choice) : propose(disc, r2, choice);
    V pdf = zero;
    if (!hn::AllTrue(d, p.sharp)) {
      const BsdfValue both = evaluate(p.in);
      const M sound = hn::Gt(both.pdf, zero);
      const V3 ratio =
          both.value * hn::IfThenElseZero(sound, hn::Div(one, hn::Max(both.pdf, kTiny())));
      p.weight = select(p.sharp, p.weight, ratio);
      pdf = hn::IfThenZeroElse(p.sharp, both.pdf);
    }
    return {p.in, p.weight, pdf, hn::Lt(p.in.z, zero)};
  }

 private:
  static HWY_INLINE V kTiny() { return hn::Set(d, 1e-30f); }

  // A direction, which has no density if it is sharp, but a weight.
  struct Proposal {
    V3 in, weight;
    M sharp;
  };

  // The value without the layers' own light. `below`: what the layers leave of light from `in`.
  HWY_INLINE BsdfValue base(const V3& in, V below) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
    const V inverse_pi = hn::Set(d, float(1 / std::numbers::pi));
    const M above = hn::Gt(in.z, zero);
    const V cosine = hn::Abs(in.z), flat = hn::Mul(cosine, inverse_pi);
    V3 value = set3(d, Rgb());
    V pdf = zero;
    // Diffuse lobes.
    if (!hn::AllFalse(d, above)) {
      V diffuse = hn::Mul(base_out_, base_scale_);
      if (any_coat_)
        diffuse =
            hn::Mul(diffuse, hn::Sub(below, hn::Mul(cover_, energy_.at(s_.reflection, cosine))));
      else if (any_layers_)
        diffuse = hn::Mul(diffuse, below);
      V3 sum = s_.diffuse * diffuse;
      if (any_mirror_)
        sum = sum + missing_ * hn::Mul(missing_out_, missing_at(below, s_.conductor, cosine));
      if (any_glass_) {
        const V glass =
            hn::Mul(hn::Mul(glass_reflected_, glass_out_), missing_at(below, s_.front, cosine));
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
          hn::Mul(hn::Mul(glass_refracted_, glass_out_), missing_at(below, s_.back, cosine));
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
    const V density = facets_.distribution(half.z);
    const Reflectances r = reflectances(hn::Max(out_half, zero));
    const V part = through_part(r);
    const V shadow_out = facets_.shadow(out_.z), shadow_in = facets_.shadow(cosine);
    // Reflection, also that of thin glass to the other side.
    const V peak = facets_.reflection(density, shadow_out, cosine, shadow_in);
    const V reflected_pdf = facets_.reflection_pdf(density);
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
      const V normal_pdf = facets_.normal_pdf(density, out_half);
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
    if (any_layers_) shiny = shiny * hn::Min(below_out_, below);
    const V3 sum = value + shiny;
    return {select(smooth_, value, sum),
            hn::IfThenElse(smooth_, pdf, hn::Add(hn::Mul(specular_, shiny_pdf), pdf))};
  }

  // A direction of the base. `choice` is below 1.
  HWY_INLINE Proposal propose(const Wide2<D>& disc, V r2, V choice) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
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
      const V3 half = select(smooth_, V3{zero, zero, one}, facets_.visible_normal(disc, r2));
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
    return {in, weight, sharp};
  }

  // The part of samples that are of the base.
  HWY_INLINE V base_part() const {
    return hn::Sub(hn::Sub(hn::Set(d, 1), clearcoat_part_), sheen_part_);
  }
  HWY_INLINE M smooth_clearcoat() const {
    return hn::Lt(s_.clearcoat_roughness, hn::Set(d, EnergyTables::kSmoothest));
  }
  static HWY_INLINE V clearcoat_reflectance(V cosine) {
    return dielectric_reflectance(cosine, hn::Set(d, EnergyTables::kCoatIor));
  }
  HWY_INLINE Microfacets clearcoat() const {
    return {s_.clearcoat_roughness, clearcoat_out_, hn::FirstN(d, 0)};
  }

  // `cosine`: of `in` and the clear coat's normal; `lit`: on its side.
  HWY_INLINE void add_clearcoat(const V3& half, V cosine, M lit, BsdfValue& all) const {
    const Microfacets facets = clearcoat();
    const V density = facets.distribution(dot(half, s_.clearcoat_normal));
    const V peak =
        facets.reflection(density, facets.shadow(clearcoat_out_.z), cosine, facets.shadow(cosine));
    const M rough = hn::AndNot(smooth_clearcoat(), lit);
    const V part = hn::Mul(s_.clearcoat, clearcoat_reflectance(hn::Max(dot(out_, half), kTiny())));
    const V value = hn::IfThenElseZero(rough, hn::Mul(part, peak));
    all.value = all.value + V3{value, value, value};
    const V pdf = hn::IfThenElseZero(rough, facets.reflection_pdf(density));
    all.pdf = hn::Add(all.pdf, hn::Mul(clearcoat_part_, pdf));
  }

  // Conty Estevez and Kulla 2017, "Production Friendly Microfacet Sheen BRDF".
  HWY_INLINE void add_sheen(V half, V cosine, M above, BsdfValue& all) const {
    const EnergyPlace place = layers_.place(cosine);
    const V one = hn::Set(d, 1), half_one = hn::Set(d, 0.5f);
    const V slope = hn::Max(s_.sheen_roughness, hn::Set(d, EnergyTables::kLeastSheen));
    const V steep = hn::Div(one, squared(slope));
    const V density = hn::Mul(
        hn::Mul(hn::Add(steep, hn::Set(d, 2)), hn::Set(d, float(0.5 / std::numbers::pi))),
        pow_unit(d, hn::Max(hn::Sub(one, squared(half)), hn::Zero(d)), hn::Mul(steep, half_one)));
    const V shadow_in = layers_.at(EnergyTables::kSheenShadow, place);
    const V g_out = hn::Mul(shadow_out_, out_.z), g_in = hn::Mul(shadow_in, cosine);
    const V both = hn::Mul(hn::Set(d, 4), hn::Sub(hn::Add(g_out, g_in), hn::Mul(g_out, g_in)));
    const V visible = hn::Div(hn::Mul(shadow_out_, shadow_in), hn::Max(both, kTiny()));
    const V scale = hn::Min(sheen_out_, layers_.at(EnergyTables::kSheen, place));
    const V value = hn::Mul(hn::Mul(density, visible), hn::Mul(scale, cosine));
    all.value = all.value + s_.sheen * hn::IfThenElseZero(above, value);
    const V pdf = hn::Div(hn::Set(d, float(2 / std::numbers::pi)),
                          hn::Sqrt(hn::Add(one, hn::Mul(cosine, hn::Set(d, 48)))));
    all.pdf = hn::Add(all.pdf, hn::Mul(sheen_part_, hn::IfThenElseZero(above, pdf)));
  }

  // A direction of the layers or of the base.
  HWY_INLINE Proposal propose_layers(const Wide2<D>& disc, V r2, V choice) const {
    const V zero = hn::Zero(d), one = hn::Set(d, 1);
    const V layers = hn::Add(clearcoat_part_, sheen_part_);
    const V rest = hn::Div(hn::Sub(choice, layers), hn::Max(base_part(), kTiny()));
    Proposal p = propose(disc, r2, hn::Min(hn::Max(rest, zero), hn::Set(d, 1 - 0x1p-24f)));
    // Sharp rays of the base have the same cosine on both sides.
    p.weight = p.weight * hn::Div(below_out_, hn::Max(base_part(), kTiny()));
    const M coat = hn::Lt(choice, clearcoat_part_),
            sheen = hn::AndNot(coat, hn::Lt(choice, layers));
    if (any_clearcoat_) {
      const V3 half =
          select(smooth_clearcoat(), V3{zero, zero, one}, clearcoat().visible_normal(disc, r2));
      const V out_half = dot(clearcoat_out_, half);
      const V3 dir = half * hn::Add(out_half, out_half) - clearcoat_out_;
      const WideFrame frame(s_.clearcoat_normal);
      const V3 in = frame.u * dir.x + frame.v * dir.y + s_.clearcoat_normal * dir.z;
      const M lost = hn::Lt(hn::Min(dir.z, in.z), zero);
      p.in = select(coat, select(lost, set3(d, Rgb()), in), p.in);
      const V part = hn::Mul(s_.clearcoat, clearcoat_reflectance(out_half));
      const V weight = hn::Div(part, hn::Max(clearcoat_part_, kTiny()));
      p.weight = select(coat, V3{weight, weight, weight}, p.weight);
      p.sharp = hn::Or(hn::And(coat, smooth_clearcoat()), hn::AndNot(coat, p.sharp));
    }
    if (any_sheen_) {
      // Denser near the horizon: z = (t + 3 t^2) / 4 for an even t.
      const V t = hn::Sub(one, r2), slant = hn::Add(one, hn::Mul(t, hn::Set(d, 3)));
      const V z = hn::Mul(hn::Mul(t, slant), hn::Set(d, 0.25f));
      const V around = hn::Mul(hn::Sqrt(hn::Mul(hn::Add(slant, hn::Set(d, 3)), hn::Add(one, z))),
                               hn::Set(d, 0.5f));
      p.in = select(sheen, V3{hn::Mul(disc.x, around), hn::Mul(disc.y, around), z}, p.in);
      p.sharp = hn::AndNot(sheen, p.sharp);
    }
    return p;
  }

  // The energy that microfacets lose. The layers transmit `left` to them. Smooth ones below layers
  // lose none.
  HWY_INLINE V missing_at(V left, U table, V cosine) const {
    const V missing = hn::Sub(left, energy_.at(table, cosine));
    if (!any_layers_) return missing;
    return hn::IfThenZeroElse(hn::And(layered_, smooth_), hn::Max(missing, hn::Zero(d)));
  }

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

  // Lambda + 1/2.
  static HWY_INLINE V lambda_and_half(V shadow, V cosine) {
    return hn::Div(shadow, hn::Max(hn::Add(cosine, cosine), kTiny()));
  }
  // Smooth surfaces lack light mostly at cosines of about alpha, so half of the rays that stand for
  // it have the density (cosine / pi) grazing(cosine). Without them, rare rays would be too bright.
  HWY_INLINE V grazing(V cosine) const {
    const V sum = hn::Max(hn::Add(squared(cosine), facets_.alpha2()), kTiny());
    return hn::Div(grazing_scale_, hn::Mul(sum, hn::Sqrt(sum)));
  }
  // The square of the cosine below which the part `u` of them is.
  HWY_INLINE V grazing_square(V u) const {
    const V one = hn::Set(d, 1), alpha2 = facets_.alpha2();
    const V alpha = hn::Max(hn::Sqrt(alpha2), hn::Set(d, 1e-6f));
    const V steep = hn::Div(one, alpha);
    const V flat = hn::Div(one, hn::Sqrt(hn::Add(one, alpha2)));
    const V root = hn::Sub(steep, hn::Mul(u, hn::Sub(steep, flat)));
    return clamp_unit(hn::Sub(hn::Div(one, squared(root)), alpha2));
  }
  const Lobes& s_;
  const V3 out_;
  const M smooth_;
  M clear_;  // glass is invisible
  V cover_;  // 0 if the index of refraction is 1
  const M layered_;
  const WideEnergy energy_;
  const WideLayers layers_;
  const Microfacets facets_;
  bool any_glass_, any_mirror_, any_coat_;
  bool any_clearcoat_, any_sheen_, any_layers_;
  V3 clearcoat_out_;                      // in its frame
  V below_out_, sheen_out_, shadow_out_;  // of layers, for `out`
  V clearcoat_part_, sheen_part_;         // probabilities of sample()
  V base_out_, base_scale_;               // of the diffuse base
  V missing_out_;                         // of the mirror
  V3 missing_;
  V glass_out_, glass_reflected_, glass_refracted_;
  V specular_, back_;  // probabilities of sample()
  V grazing_, grazing_scale_;
};

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
