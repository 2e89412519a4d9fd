// raio explain: one sample of a pixel as a tree of rays, for people or as JSON.
#include "app/explain.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "app/json.h"
#include "app/output.h"
#include "app/terminal.h"
#include "app/test_numbers.h"
#include "shape/kinds.h"

namespace raio::core::app {
namespace {

using Kind = ExplainedRay::Kind;

constexpr std::string_view kKindNames[] = {"eye", "reflection", "refraction", "shadow"};

// The shortest digits that read back as the same number.
std::string text_of(Vec3f v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }
std::string text_of(Vec3d v) { return text_of(Vec3f(v)); }
// Positions in the coordinates of the scene's file.
Vec3d place(const Scene& scene, Vec3f p) { return scene.origin + plain(p); }

// A single number if the colours have equal weights.
std::string text_of_weight(Rgb w) { return w == Rgb(w.x) ? fmt::format("{}", w.x) : text_of(w); }

std::string counted(uint64_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

class TextTree {
 public:
  explicit TextTree(const Explained& what) : what_(what), children_(what.sample.rays.size()) {
    for (size_t k = 1; k < children_.size(); ++k)
      children_[size_t(what.sample.rays[k].parent)].push_back(k);
  }

  std::string text() {
    const RenderSettings& o = what_.settings;
    out_ = fmt::format("{}, pixel {},{} of {}x{}, sample {} of {}\ncolour  {}\n", what_.scene.name,
                       what_.pixel[0], what_.pixel[1], o.width, o.height, what_.number,
                       o.samples_per_pixel(), text_of(what_.sample.rgb));
    for (size_t l = 0; l < what_.sample.lights.size(); ++l) {
      const PreparedScene::Emitter& light = what_.sample.lights[l];
      line("", fmt::format("light {}", l),
           fmt::format("at {}, intensity {}", text_of(place(what_.scene, light.position)),
                       text_of(light.intensity)));
    }
    add_ray(0, "");
    return out_;
  }

 private:
  void line(const std::string& indent, std::string_view name, const std::string& value) {
    out_ += fmt::format("{}{:<12}{}\n", indent, name, value);
  }
  std::string cost(size_t i) const {
    if (!what_.logs[i]) return "";
    const bool cells = what_.settings.accel.kind == AccelKind::grid;
    std::string steps;
    if (const uint64_t n = what_.logs[i]->count_steps(); n > 0)
      steps = cells ? counted(n, "cell, ", "cells, ") : counted(n, "node, ", "nodes, ");
    return fmt::format(" ({}{})", steps, counted(what_.logs[i]->count_tests(), "test", "tests"));
  }

  void add_ray(size_t i, const std::string& indent) {
    const ExplainedRay& r = what_.sample.rays[i];
    out_ += fmt::format("\n{}{} ray, level {}, weight {} in the pixel's colour, adds {}\n", indent,
                        word_of(r.kind), r.level, text_of_weight(r.weight), text_of(r.adds));
    const std::string in = indent + "  ";
    if (r.parent >= 0 && !what_.sample.rays[size_t(r.parent)].bounce)
      line(in, "weight", weight_of_child(r));
    line(in, "from", text_of(place(what_.scene, r.ray.origin)));
    line(in, "direction", text_of(r.ray.dir));
    if (!r.surface) {
      line(in, r.traced ? "hits" : "ends",
           r.traced ? "nothing" + cost(i)
                    : fmt::format("beyond level {}, the last one traced", what_.settings.depth));
      line(in, "background", text_of(r.background));
      if (r.escape && r.escape->weight < 1)
        line(in, "MIS",
             mis_weight(r.escape->weight, density_before(r), "surface", r.escape->light_density,
                        "light"));
      return;
    }
    const ExplainedRay::Surface& s = *r.surface;
    line(in, "hits",
         fmt::format("{} at a distance of {}{}", name_of(geometry(), r.hit.primitive), r.hit.t,
                     cost(i)));
    line(in, "test", test_of(r));
    line(in, "point", text_of(place(what_.scene, s.point)));
    line(in, "normal", text_of(s.normal));
    if (s.geometric != s.normal) line(in, "flat normal", text_of(s.geometric));
    if (r.bounce) {
      add_bounce(i, *r.bounce, in);
      return;
    }
    line(in, "material", material_of(s));
    line(in, "ambient", fmt::format("{}, A {}", text_of(r.ambient), what_.sample.ambient));
    for (size_t l = 0; l < what_.scene.lights.size(); ++l) add_light(l, children_[i], in);
    line(in, "radiance", text_of(s.radiance));
    if (s.transmission > 0) line(in, "refraction", refraction_of(s));
    for (const size_t k : children_[i])
      if (what_.sample.rays[k].kind != Kind::shadow) add_ray(k, in);
  }

  // Of the direction of a path's ray.
  float density_before(const ExplainedRay& r) const {
    return r.parent < 0 ? 0 : what_.sample.rays[size_t(r.parent)].bounce->density;
  }
  // The balance heuristic.
  static std::string mis_weight(float weight, float own, std::string_view by, float other,
                                std::string_view by_other) {
    return fmt::format("{}, densities {} by the {}, {} by the {}", weight, own, by, other,
                       by_other);
  }

  void add_bounce(size_t i, const ExplainedRay::Bounce& b, const std::string& in) {
    const ExplainedRay& r = what_.sample.rays[i];
    std::string material = fmt::format("{}: diffuse {}", r.surface->material, text_of(b.diffuse));
    if (b.mirror != Rgb()) material += ", metal " + text_of(b.mirror);
    if (b.coat != Rgb()) material += ", dielectric " + text_of(b.coat);
    if (b.glass > 0) material += fmt::format(", glass {}", b.glass);
    if (b.clearcoat > 0) material += fmt::format(", clear coat {}", b.clearcoat);
    if (b.sheen != Rgb()) material += ", sheen " + text_of(b.sheen);
    line(in, "material", material + fmt::format(", roughness {}", b.roughness));
    if (b.transmittance != Rgb(1)) line(in, "medium", "transmits " + text_of(b.transmittance));
    if (b.emission != Rgb()) {
      line(in, "emission", text_of(b.emission));
      if (b.emission_density > 0)
        line(in, "  MIS",
             mis_weight(b.emission_weight, density_before(r), "surface", b.emission_density,
                        "light"));
    }
    for (const size_t k : children_[i])
      if (what_.sample.rays[k].kind == Kind::shadow) add_sampled_light(k, b, in);
    line(in, "radiance", text_of(r.surface->radiance));
    const auto next = std::ranges::find_if(
        children_[i], [&](size_t k) { return what_.sample.rays[k].kind != Kind::shadow; });
    line(in, "next", next_of(r, b, next != children_[i].end()));
    if (next != children_[i].end()) add_ray(*next, in);
  }
  std::string next_of(const ExplainedRay& r, const ExplainedRay::Bounce& b, bool goes_on) const {
    if (r.level == what_.settings.depth) return "none after the last level";
    if (!goes_on)
      return b.chance < 1 ? fmt::format("none: the path goes on with a chance of {}", b.chance)
                          : std::string("none: the light is absorbed");
    std::string out = fmt::format("weight {}", text_of_weight(b.weight));
    if (b.density > 0) out += fmt::format(", density {}", b.density);
    if (b.chance < 1) out += fmt::format(", divided by its chance {}", b.chance);
    return out;
  }
  void add_sampled_light(size_t k, const ExplainedRay::Bounce& b, const std::string& in) {
    const ExplainedRay& r = what_.sample.rays[k];
    const TraceLog::Test* const by = r.occluded ? stopper(what_.logs[k]) : nullptr;
    line(in, "light",
         fmt::format("{}, chosen with a probability of {}; {}{}", b.light, b.light_probability,
                     by           ? "in the shadow of " + name_of(geometry(), by->primitive)
                     : r.occluded ? "in shadow"
                                  : "unoccluded",
                     cost(k)));
    line(in, "  L", text_of(r.ray.dir));
    if (b.light_density > 0)
      line(in, "  MIS",
           mis_weight(b.light_weight, b.light_density, "light", b.light_bsdf_density, "surface"));
    line(in, "  radiance",
         fmt::format("{}, divided by the {}", text_of(b.light_radiance),
                     b.light_density > 0 ? "density" : "probability"));
    line(in, "  BSDF cos", text_of(b.light_bsdf));
    line(in, "  adds", r.occluded ? "nothing" : text_of(b.direct));
  }

  // The numbers of the hit's test, for the formula in the window and in docs/explain.md.
  std::string test_of(const ExplainedRay& r) const {
    std::string out;
    for (const auto& [name, value] : test_numbers(geometry(), r.hit.primitive, r.ray).values)
      out += fmt::format("{}{} {}", out.empty() ? "" : ", ", name, fmt::join(value, " "));
    return out;
  }

  static std::string material_of(const ExplainedRay::Surface& s) {
    std::string out =
        fmt::format("{}: colour {}, Kd {}, Ks {}", s.material, text_of(s.color), s.kd, s.ks);
    if (s.specular != Rgb(1)) out += " of colour " + text_of(s.specular);
    out += fmt::format(", Shine {}, T {}, index of refraction {}", s.shine, s.transmission, s.ior);
    if (s.gloss > 0) out += fmt::format(", gloss {}", s.gloss);
    if (s.translucency > 0) out += fmt::format(", translucency {}", s.translucency);
    return out;
  }

  static std::string refraction_of(const ExplainedRay::Surface& s) {
    std::string out = fmt::format("from index {} to {}: cosine {} before the surface, ",
                                  s.index_before(), s.index_behind(), s.cosine);
    if (s.cosine2_behind < 0)
      out += fmt::format("squared {} behind, so reflection is total", s.cosine2_behind);
    else
      out += fmt::format("{} behind", std::sqrt(s.cosine2_behind));
    if (s.reflectance) out += fmt::format(", Kr {}", *s.reflectance);
    return out;
  }

  // "0.45 = 0.5 x T 0.9".
  std::string weight_of_child(const ExplainedRay& r) const {
    const ExplainedRay& from = what_.sample.rays[size_t(r.parent)];
    const ExplainedRay::Surface& s = *from.surface;
    const bool mirrored = r.kind == Kind::reflection;
    std::string part;
    if (s.reflectance)
      part = mirrored ? fmt::format("Kr {}", *s.reflectance)
                      : fmt::format("(1 - Kr {})", *s.reflectance);
    else if (!mirrored)
      part = fmt::format("T {}", s.transmission);
    else
      part = fmt::format("Ks {}", s.ks) +
             (s.specular == Rgb(1) ? "" : " x colour " + text_of(s.specular));
    return fmt::format("{} = {} x {}", text_of_weight(r.weight), text_of_weight(from.weight), part);
  }

  void add_light(size_t l, const std::vector<size_t>& children, const std::string& in) {
    const std::string name = fmt::format("light {}", l);
    for (const size_t k : children) {
      const ExplainedRay& r = what_.sample.rays[k];
      if (r.light != int(l)) continue;
      if (!r.occluded) return add_terms(k, in);
      const TraceLog::Test* const by = stopper(what_.logs[k]);
      return line(
          in, name,
          (by ? "in the shadow of " + name_of(geometry(), by->primitive) : "in shadow") + cost(k));
    }
    line(in, name, "behind the surface");
  }
  void add_terms(size_t k, const std::string& in) {
    const ExplainedRay& r = what_.sample.rays[k];
    const ExplainedRay::Light& lit = *r.lit;
    const bool blinn = what_.settings.shading == ShadingModel::blinn_phong;
    line(in, fmt::format("light {}", r.light), "unoccluded" + cost(k));
    line(in, "  L", text_of(r.ray.dir));
    line(in, "  diffuse", fmt::format("{}, N.L {}", text_of(r.diffuse), lit.n_dot_l));
    if (what_.sample.rays[size_t(r.parent)].surface->ks > 0)
      line(in, "  highlight",
           fmt::format("{}, {} {}, its power {}", text_of(r.highlight), blinn ? "N.H" : "R.V",
                       lit.cosine, lit.power));
  }

  const Geometry& geometry() const { return what_.accel.geometry(); }

  const Explained& what_;
  std::vector<std::vector<size_t>> children_;  // by ray
  std::string out_;
};

}  // namespace

std::string_view word_of(Kind kind) { return kKindNames[size_t(kind)]; }

std::string name_of(const Geometry& geometry, PrimitiveId id) {
  return fmt::format("{} {}", kPrimitiveKindNames[size_t(geometry.kind_of(id))],
                     geometry.index_of(id));
}

std::string light_name(const Explanation& sample, const ExplainedRay& shadow) {
  const auto& bounce = sample.rays[size_t(shadow.parent)].bounce;
  return bounce ? bounce->light : fmt::format("{}", shadow.light);
}

const TraceLog::Test* stopper(const std::optional<TraceLog>& log) {
  if (!log) return nullptr;
  for (const TraceLog::Test& test : log->tests)
    if (test.nearest) return &test;
  return nullptr;
}

std::optional<Error> explain_conflict(RenderOptions options, const Scene& scene) {
  if (options.accel.kind == AccelKind::embree)
    return bad_option("accel", "Embree does not log its steps; choose none, grid or bvh");
  options.accel.counters = true;
  return option_conflict(options, &scene);
}

RenderSettings explained_settings(RenderOptions options, const Scene& scene) {
  options.accel.counters = true;
  RenderSettings settings = resolve_options(options, scene);
  if (settings.accel.kind == AccelKind::automatic) settings.accel.kind = AccelKind::bvh;
  return settings;
}

std::vector<std::optional<TraceLog>> logs_of(const Explanation& sample, const Accel& accel) {
  std::vector<std::optional<TraceLog>> logs;
  logs.reserve(sample.rays.size());
  for (const ExplainedRay& r : sample.rays)
    logs.push_back(r.traced ? accel.log(r.ray, r.kind == Kind::shadow) : std::nullopt);
  return logs;
}

std::string explained_text(const Explained& what) { return TextTree(what).text(); }

int run(const ExplainCommand& command) {
  if (!command.plot.empty()) {
    if (const auto format = plot_format(command.plot); !format) return bad_input(format.error());
    if (const auto writable = check_writable(command.plot); !writable)
      return fail(writable.error());
  }
  const auto scene = load_scene(command.scene, false, nullptr, command.read);
  if (!scene) return scene.error();
  if (const auto why = explain_conflict(command.options, *scene)) return fail(*why);
  const RenderSettings settings = explained_settings(command.options, *scene);
  const auto [x, y] = command.pixel;
  if (x >= settings.width || y >= settings.height)
    return bad_input(fmt::format(
        "--pixel: the picture of {}x{} has no pixel {},{}; the last is "
        "{},{}",
        settings.width, settings.height, x, y, settings.width - 1, settings.height - 1));
  if (command.sample >= settings.samples_per_pixel())
    return bad_input(fmt::format(
        "--sample: a pixel has {}, numbered from 0; found {}",
        counted(uint64_t(settings.samples_per_pixel()), "sample", "samples"), command.sample));
  const auto accel = build_accel(*scene, settings.accel, settings.one_sided);
  if (!accel) return fail(accel.error());

  const auto sample = explain_sample(*scene, **accel, settings, x, y, uint32_t(command.sample));
  if (!sample) return fail(sample.error());
  const auto logs = logs_of(*sample, **accel);
  const Explained what{*scene,         **accel, settings, command.pixel,
                       command.sample, *sample, logs,     command.plot_from};
  const int status = deliver("-", command.json ? explained_json(what) : explained_text(what));
  if (command.plot.empty() || status != kDone) return status;
  const auto picture = draw_explained(what, *plot_format(command.plot));
  return picture ? deliver(command.plot, *picture) : no_resource(picture.error());
}

}  // namespace raio::core::app
