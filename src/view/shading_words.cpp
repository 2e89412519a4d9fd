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
    if (ray_.kind == Kind::shadow) {
      light(sample_.rays[size_t(ray_.parent)], size_t(ray_.light), &ray_);
    } else if (!ray_.surface) {
      add(ray_.traced ? tr("The ray hits nothing: it gets the background")
                      : tr("The ray is beyond the last level: it gets the background"),
          "C = background", {{"background", numbers(ray_.background)}});
      sum(ray_.background);
    } else {
      ambient();
      for (size_t l = 0; l < scene_.lights.size(); ++l) light(ray_, l, child(Kind::shadow, int(l)));
      Rgb radiance = ray_.ambient;
      for (const ExplainedRay& r : sample_.rays)
        if (r.kind == Kind::shadow && r.parent == int(id_) && !r.occluded)
          radiance = radiance + Rgb(r.diffuse + r.highlight);
      sum(radiance);
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

  void ambient() {
    bool any_color = false;
    for (const Light& l : scene_.lights) any_color |= l.color.has_value();
    const bool none = settings_.shading != ShadingModel::nff;
    add(none        ? tr("Ambient light: none in this shading model")
        : any_color ? tr("Ambient light: none, since lights of the scene have colours")
                    : tr("Ambient light, the same everywhere"),
        "ambient = A colour",
        {{"A", none || any_color ? "0" : "0.1"},
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
    const Rgb intensity =
        scene_.lights[l].color.value_or(Rgb(float(1 / std::sqrt(double(scene_.lights.size())))));
    const Vec3d n(s.normal), to_light(shadow->ray.dir), v = -Vec3d(at.ray.dir);
    add(trf("Light {}, diffuse: the brighter, the more directly the light faces the surface", l),
        "diffuse = I Kd colour (N.L)",
        {{"I", numbers(intensity)},
         {"Kd", number(s.kd)},
         {"colour", numbers(s.color)},
         {"N", numbers(s.normal)},
         {"L", numbers(shadow->ray.dir)},
         {"N.L", number(dot(n, to_light))},
         {"diffuse", numbers(shadow->diffuse)}});
    if (s.ks > 0) highlight(s, l, intensity, to_light, v, shadow->highlight);
  }

  void highlight(const Surface& s, size_t l, Rgb intensity, Vec3d to_light, Vec3d v, Vec3d term) {
    const Vec3d n(s.normal);
    const bool halfway = settings_.shading == ShadingModel::blinn_phong;
    const Vec3d to = halfway ? normalize(to_light + v) : n * (2 * dot(n, to_light)) - to_light;
    Variables variables{{"I", numbers(intensity)}, {"Ks", number(s.ks)}};
    if (is_tinted(s)) variables.push_back({"specular", numbers(s.specular)});
    variables.insert(variables.end(),
                     {{"Shine", number(s.shine)},
                      {halfway ? "H" : "R", numbers(to)},
                      {"V", numbers(v)},
                      {halfway ? "N.H" : "R.V", number(halfway ? dot(n, to) : dot(to, v))},
                      {"highlight", numbers(term)}});
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

  // Fresnel's reflectance if it splits the light, for the variables of both rays.
  bool divides(const Surface& s) const {
    return settings_.fresnel != Fresnel::none && s.transmission > 0;
  }
  double reflectance(const Surface& s) const {
    const double eta = s.eta, in = std::clamp(-dot(Vec3d(ray_.ray.dir), Vec3d(s.normal)), 0.0, 1.0);
    const double k = 1 - eta * eta * (1 - in * in), out = std::sqrt(std::max(k, 0.0));
    if (k < 0) return 1;
    const auto ratio = [](double a, double b) {
      const double r = (a - b) / std::max(a + b, 1e-30);
      return r * r;
    };
    if (settings_.fresnel == Fresnel::exact)
      return (ratio(eta * in, out) + ratio(eta * out, in)) / 2;
    const double least = ratio(eta, 1);
    const double flat = 1 - (eta > 1 ? out : in);
    return least + (1 - least) * flat * flat * flat * flat * flat;
  }
  std::string reflectance_formula() const {
    return settings_.fresnel == Fresnel::exact
               ? "Kr = (((eta c - c') / (eta c + c'))^2 + ((eta c' - c) / (eta c' + c))^2) / 2"
               : "Kr = R0 + (1 - R0) (1 - cos)^5, R0 = ((eta - 1) / (eta + 1))^2";
  }

  void sum(Rgb radiance) {
    add(ray_.surface ? tr("The sum of these terms, times the weight of the ray, is what it adds to "
                          "the pixel")
                     : tr("Times the weight of the ray, this is what it adds to the pixel"),
        ray_.surface ? "C = ambient + sum (diffuse + highlight)\nadds = weight C"
                     : "adds = weight C",
        {{"C", numbers(radiance)},
         {"weight", weight_text(ray_.weight)},
         {"adds", numbers(ray_.brings)}});
  }

  void mirror(const Surface& s) {
    const bool by_angle = divides(s);
    if (!by_angle && !(s.ks > 0)) return;
    const ExplainedRay* const to = child(Kind::reflection);
    if (!to) {
      add(tr("Reflection is switched off"));
      return;
    }
    // A smooth normal can send the ray through the surface; then the geometric one reflects it.
    const Vec3d in(ray_.ray.dir), smooth(s.normal), flat(s.geometric);
    const Vec3d smooth_out = in - smooth * (2 * dot(in, smooth));
    const Vec3d n = dot(smooth_out, flat) > 0 ? smooth : flat;
    Variables variables{{"D", numbers(ray_.ray.dir)},
                        {"N", numbers(n)},
                        {"D.N", number(dot(in, n))},
                        {"R", numbers(in - n * (2 * dot(in, n)))}};
    if (by_angle) {
      variables.insert(variables.end(), {{"eta", number(s.eta)}, {"Kr", number(reflectance(s))}});
    } else {
      variables.push_back({"Ks", number(s.ks)});
      if (is_tinted(s)) variables.push_back({"specular", numbers(s.specular)});
    }
    variables.push_back({"weight'", weight_text(to->weight)});
    const std::string part = by_angle       ? number(reflectance(s))
                             : is_tinted(s) ? numbers(s.specular * s.ks)
                                            : number(s.ks);
    add(trf("The mirrored ray has direction R and {} times the weight of this one", part),
        fmt::format("R = D - 2 (D.N) N\n{}weight' = {} weight",
                    by_angle ? reflectance_formula() + "\n" : "", by_angle ? "Kr" : ks_name(s)),
        std::move(variables));
    rough(settings_.gloss.value_or(s.roughness), to->ray.dir);
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
    const Vec3d in(ray_.ray.dir), smooth(s.normal), flat(s.geometric);
    const auto k_of = [&](Vec3d n) {
      const double c = -dot(in, n);
      return 1 - double(s.eta) * s.eta * (1 - c * c);
    };
    // As above: if a smooth normal leaves the ray on its side, the geometric one is used.
    Vec3d n = smooth;
    if (const double k = k_of(n), c = -dot(in, n);
        !(dot(in * double(s.eta) + n * (s.eta * c - std::sqrt(std::max(0.0, k))), flat) < 0))
      n = flat;
    Variables variables{{"eta", number(s.eta)},
                        {"D", numbers(ray_.ray.dir)},
                        {"N", numbers(n)},
                        {"c", number(-dot(in, n))},
                        {"k", number(k_of(n))}};
    if (!to) {
      add(k_of(n) < 0 ? tr("Total internal reflection: no ray is refracted")
                      : tr("Refraction is switched off"),
          "c = -D.N\nk = 1 - eta^2 (1 - c^2) < 0", std::move(variables));
      return;
    }
    const bool by_angle = divides(s);
    const double part = by_angle ? 1 - reflectance(s) : double(s.transmission);
    const double k = std::max(0.0, k_of(n)), c = -dot(in, n);
    const Vec3d dir = in * double(s.eta) + n * (s.eta * c - std::sqrt(k));
    variables.insert(variables.end(), {{"D'", numbers(dir)},
                                       {by_angle ? "1 - Kr" : "T", number(part)},
                                       {"weight'", weight_text(to->weight)}});
    add(trf("The refracted ray follows Snell's law and has {} times the weight of this one",
            number(part)),
        fmt::format("c = -D.N\nk = 1 - eta^2 (1 - c^2)\nD' = eta D + (eta c - sqrt k) N\n"
                    "weight' = {} weight",
                    by_angle ? "(1 - Kr)" : "T"),
        std::move(variables));
    rough(settings_.translucency.value_or(s.roughness), to->ray.dir);
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
