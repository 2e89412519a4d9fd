// The shading of a hit, explained term by term (view/traversal_words.h).
#include <algorithm>
#include <cmath>

#include "view/texts.h"
#include "view/traversal_words.h"

namespace raio::core::view {
namespace {

using Kind = ExplainedRay::Kind;
using Surface = ExplainedRay::Surface;
using Variables = std::vector<std::pair<std::string, std::string>>;

std::string number(double x) { return fmt::format("{:.6g}", x); }
template <class T>
std::string numbers(Vec3<T> v) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", v.x, v.y, v.z);
}
// A single number if red, green and blue are equal.
std::string weight_text(Rgb w) { return w == Rgb(w.x) ? number(w.x) : numbers(w); }

class ShadingNarrator {
 public:
  ShadingNarrator(const Explanation& sample, const Scene& scene, const RenderSettings& settings,
                  size_t ray)
      : sample_(sample), scene_(scene), settings_(settings), id_(ray), ray_(sample.rays[ray]) {}

  std::vector<TraversalStep> tell() && {
    if (const auto* const parent = ray_.parent < 0 ? nullptr : &sample_.rays[size_t(ray_.parent)];
        ray_.kind == Kind::shadow && parent->bounce) {
      sampled_light(*parent->bounce, ray_);
    } else if (ray_.bounce) {
      bounce(*ray_.bounce);
    } else if (ray_.escape) {
      add(tr("The ray leaves the scene: it gets the light from there, times its MIS weight"),
          "w = p / (p + q)\nC = w light",
          {{"light", numbers(ray_.background)},
           {"p", number(parent->bounce->density)},
           {"q", number(ray_.escape->light_density)},
           {"w", number(ray_.escape->weight)}});
      sum(ray_.background * ray_.escape->weight);
    } else if (ray_.kind == Kind::shadow) {
      light(sample_.rays[size_t(ray_.parent)], size_t(ray_.light), &ray_);
    } else if (!ray_.surface) {
      add(ray_.traced ? tr("The ray hits nothing: it gets the background")
                      : tr("The ray is beyond the last level: it gets the background"),
          "C = background", {{"background", numbers(ray_.background)}});
      sum(ray_.background);
    } else {
      ambient();
      for (size_t l = 0; l < scene_.lights.size(); ++l) light(ray_, l, child(Kind::shadow, int(l)));
      sum(ray_.surface->radiance);
      mirror(*ray_.surface);
      refraction(*ray_.surface);
    }
    return std::move(out_);
  }

 private:
  void add(std::string words, std::string formula = {}, Variables variables = {}) {
    out_.push_back({.words = std::move(words),
                    .formula = std::move(formula),
                    .variables = std::move(variables)});
  }

  const ExplainedRay* child(Kind kind, int light = -1) const {
    for (const ExplainedRay& r : sample_.rays)
      if (r.parent == int(id_) && r.kind == kind && r.light == light) return &r;
    return nullptr;
  }

  // docs/light.md. p and q: the densities of the surface's and the lights' sampling.
  void bounce(const ExplainedRay::Bounce& b) {
    if (b.emission != Rgb()) {
      Variables variables{{"emission", numbers(b.emission)}, {"w", number(b.emission_weight)}};
      if (b.emission_density > 0)
        variables.insert(variables.begin(),
                         {{"p", number(sample_.rays[size_t(ray_.parent)].bounce->density)},
                          {"q", number(b.emission_density)}});
      add(tr("The surface emits light, with the MIS weight of the ray that found it"),
          b.emission_density > 0 ? "w = p / (p + q)\nemitted = w emission" : "emitted = w emission",
          std::move(variables));
    }
    if (const ExplainedRay* const shadow = below(true)) sampled_light(b, *shadow);
    sum(ray_.surface->radiance);
    const ExplainedRay* const next = below(false);
    if (!next) {
      add(ray_.level == settings_.depth ? tr("The path ends at its last level")
                                        : tr("The path ends: absorbed, or by Russian roulette"));
      return;
    }
    add(tr("The path goes on in a direction chosen by the surface"),
        "weight' = weight factor / chance\nfactor = BSDF cos / p",
        {{"direction", numbers(next->ray.dir)},
         {"p", b.density > 0 ? number(b.density) : tr("none: a sharp direction")},
         {"factor", weight_text(b.weight)},
         {"chance", number(b.chance)},
         {"weight", weight_text(ray_.weight)},
         {"weight'", weight_text(next->weight)}});
  }
  void sampled_light(const ExplainedRay::Bounce& b, const ExplainedRay& shadow) {
    Variables variables{{tr("light"), b.light},
                        {tr("its probability"), number(b.light_probability)},
                        {"L", numbers(shadow.ray.dir)}};
    if (b.light_density > 0)
      variables.insert(variables.end(),
                       {{"q", number(b.light_density)}, {"p", number(b.light_bsdf_density)}});
    variables.insert(variables.end(), {{"light / q", numbers(b.light_radiance)},
                                       {"BSDF cos", numbers(b.light_bsdf)},
                                       {"w", number(b.light_weight)},
                                       {"direct", numbers(shadow.occluded ? Rgb() : b.direct)}});
    add(shadow.occluded ? tr("A point of a light is sampled; it is occluded")
                        : tr("A point of a light is sampled, and its light reflected"),
        b.light_density > 0 ? "w = q / (p + q)\ndirect = w BSDF cos light / q"
                            : "direct = BSDF cos light / q",
        std::move(variables));
  }
  const ExplainedRay* below(bool shadow) const {
    for (const ExplainedRay& r : sample_.rays)
      if (r.parent == int(id_) && (r.kind == Kind::shadow) == shadow) return &r;
    return nullptr;
  }

  void ambient() {
    const bool none = settings_.shading != ShadingModel::nff;
    add(none                   ? tr("Ambient light: none in this shading model")
        : sample_.ambient == 0 ? tr("Ambient light: none, since lights of the scene have colours")
                               : tr("Ambient light, the same everywhere"),
        "ambient = A colour",
        {{"A", number(sample_.ambient)},
         {"colour", numbers(ray_.surface->color)},
         {"ambient", numbers(ray_.ambient)}});
  }

  // The contribution of light l to the surface hit by `at`, by its shadow ray, if it faces the
  // light.
  void light(const ExplainedRay& at, size_t l, const ExplainedRay* shadow) {
    const Surface& s = *at.surface;
    if (!shadow) {
      add(trf("Light {} is behind the surface and contributes nothing", l), "N.L <= 0");
      return;
    }
    if (shadow->occluded) {
      add(trf("Light {} is occluded and contributes nothing", l));
      return;
    }
    const Rgb intensity = sample_.lights[l].intensity;
    add(trf("Light {}, diffuse: the brighter, the more directly the light faces the surface", l),
        "diffuse = I Kd colour (N.L)",
        {{"I", numbers(intensity)},
         {"Kd", number(s.kd)},
         {"colour", numbers(s.color)},
         {"N", numbers(s.normal)},
         {"L", numbers(shadow->ray.dir)},
         {"N.L", number(shadow->lit->n_dot_l)},
         {"diffuse", numbers(shadow->diffuse)}});
    if (s.ks > 0) highlight(s, l, intensity, -at.ray.dir, *shadow);
  }

  void highlight(const Surface& s, size_t l, Rgb intensity, Vec3f v, const ExplainedRay& shadow) {
    const bool halfway = settings_.shading == ShadingModel::blinn_phong;
    const ExplainedRay::Light& lit = *shadow.lit;
    Variables variables{{"I", numbers(intensity)}, {"Ks", number(s.ks)}};
    if (is_tinted(s)) variables.push_back({"specular", numbers(s.specular)});
    variables.insert(variables.end(), {{"Shine", number(s.shine)},
                                       {halfway ? "H" : "R", numbers(lit.direction)},
                                       {"V", numbers(v)},
                                       {halfway ? "N.H" : "R.V", number(lit.cosine)},
                                       {halfway ? "(N.H)^Shine" : "(R.V)^Shine", number(lit.power)},
                                       {"highlight", numbers(shadow.highlight)}});
    add(halfway ? trf("Light {}, highlight: the brighter, the closer H, halfway to the eye, is to "
                      "the normal",
                      l)
                : trf("Light {}, highlight: the brighter, the closer its mirrored direction is to "
                      "the eye",
                      l),
        fmt::format("{}\nhighlight = I {} max(0, {})^Shine",
                    halfway ? "H = (L + V) / |L + V|" : "R = 2 (N.L) N - L", ks_name(s),
                    halfway ? "N.H" : "R.V"),
        std::move(variables));
  }

  static bool is_tinted(const Surface& s) { return s.specular != Rgb(1); }
  static std::string_view ks_name(const Surface& s) { return is_tinted(s) ? "Ks specular" : "Ks"; }

  std::string reflectance_formula() const {
    return settings_.fresnel == Fresnel::exact
               ? "Kr = (((eta c - c') / (eta c + c'))^2 + ((eta c' - c) / (eta c' + c))^2) / 2"
               : "Kr = R0 + (1 - R0) (1 - min(c, c'))^5, R0 = ((eta - 1) / (eta + 1))^2";
  }
  // The variables of Snell's law and of the reflectance: n and n' are the indices of refraction
  // before and behind the surface, c and c' the cosines there, c'^2 = k.
  static Variables snell(const Surface& s) {
    Variables out{{"n", number(s.index_before())},
                  {"n'", number(s.index_behind())},
                  {"eta", number(s.eta)},
                  {"c", number(s.cosine)},
                  {"k", number(s.cosine2_behind)}};
    if (s.cosine2_behind >= 0) out.emplace_back("c'", number(std::sqrt(s.cosine2_behind)));
    return out;
  }
  static constexpr std::string_view kSnell = "eta = n / n', c = -D.N\nk = 1 - eta^2 (1 - c^2)";

  void sum(Rgb radiance) {
    add(ray_.surface ? tr("The sum of these terms, times the weight of the ray, is what it adds to "
                          "the pixel")
                     : tr("Times the weight of the ray, this is what it adds to the pixel"),
        ray_.bounce    ? "C = medium (emitted + direct)\nadds = weight C"
        : ray_.surface ? "C = ambient + sum (diffuse + highlight)\nadds = weight C"
                       : "adds = weight C",
        {{"C", numbers(radiance)},
         {"weight", weight_text(ray_.weight)},
         {"adds", numbers(ray_.adds)}});
  }

  void mirror(const Surface& s) {
    const bool by_angle = s.reflectance.has_value();
    if (!by_angle && !(s.ks > 0)) return;
    const ExplainedRay* const to = child(Kind::reflection);
    if (!to) {
      add(tr("Reflection is switched off"));
      return;
    }
    const Vec3d in(ray_.ray.dir), n(s.mirror_normal);
    Variables variables{{"D", numbers(in)},
                        {"N", numbers(n)},
                        {"D.N", number(dot(in, n))},
                        {"R", numbers(in - n * (2 * dot(in, n)))}};
    if (by_angle) {
      for (auto& one : snell(s)) variables.push_back(std::move(one));
      variables.push_back({"Kr", number(*s.reflectance)});
    } else {
      variables.push_back({"Ks", number(s.ks)});
      if (is_tinted(s)) variables.push_back({"specular", numbers(s.specular)});
    }
    variables.insert(variables.end(),
                     {{"weight", weight_text(ray_.weight)}, {"weight'", weight_text(to->weight)}});
    const std::string part = by_angle       ? number(*s.reflectance)
                             : is_tinted(s) ? numbers(s.specular * s.ks)
                                            : number(s.ks);
    add(trf("The mirrored ray has direction R and {} times the weight of this one", part),
        fmt::format(
            "R = D - 2 (D.N) N\n{}weight' = {} weight",
            by_angle ? fmt::format("{}\nc' = sqrt k\n{}\n", kSnell, reflectance_formula()) : "",
            by_angle ? "Kr" : ks_name(s)),
        std::move(variables));
    rough(s.gloss, to->ray.dir);
  }

  // The direction that the ray really takes.
  void rough(float roughness, Vec3f dir) {
    if (!(roughness > 0)) return;
    add(tr("The surface is rough: a random point S of the unit sphere perturbs the direction"),
        "direction = normalize(direction + roughness S)",
        {{"roughness", number(roughness)}, {"direction", numbers(dir)}});
  }

  void refraction(const Surface& s) {
    if (!(s.transmission > 0)) return;
    const ExplainedRay* const to = child(Kind::refraction);
    const Vec3d in(ray_.ray.dir), n(s.refraction_normal);
    Variables variables{{"D", numbers(in)}, {"N", numbers(n)}};
    for (auto& one : snell(s)) variables.push_back(std::move(one));
    if (!to) {
      add(s.cosine2_behind < 0 ? tr("Total internal reflection: no ray is refracted")
                               : tr("Refraction is switched off"),
          fmt::format("{}{}", kSnell, s.cosine2_behind < 0 ? " < 0" : ""), std::move(variables));
      return;
    }
    const float part = s.reflectance ? 1 - *s.reflectance : s.transmission;
    const double eta = s.eta, c = s.cosine, root = std::sqrt(double(s.cosine2_behind));
    variables.insert(variables.end(), {{"D'", numbers(in * eta + n * (eta * c - root))},
                                       {s.reflectance ? "1 - Kr" : "T", number(part)},
                                       {"weight", weight_text(ray_.weight)},
                                       {"weight'", weight_text(to->weight)}});
    add(trf("The refracted ray follows Snell's law and has {} times the weight of this one",
            number(part)),
        fmt::format("{}\nc' = sqrt k\nD' = eta D + (eta c - c') N\nweight' = {} weight", kSnell,
                    s.reflectance ? "(1 - Kr)" : "T"),
        std::move(variables));
    rough(s.translucency, to->ray.dir);
  }

  const Explanation& sample_;
  const Scene& scene_;
  const RenderSettings& settings_;
  size_t id_;
  const ExplainedRay& ray_;
  std::vector<TraversalStep> out_;
};

}  // namespace

std::vector<TraversalStep> shading_words(const Explanation& sample, const Scene& scene,
                                         const RenderSettings& settings, size_t ray) {
  return ShadingNarrator(sample, scene, settings, ray).tell();
}

}  // namespace raio::core::view
