// A wavefront of one pixel with a Recorder that logs its rays. All instruction sets give the same
// numbers, so the baseline suffices.
#include "integrate/explain.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "integrate/bsdf-inl.h"
#include "integrate/classic.h"
#include "integrate/optics-inl.h"
#include "integrate/path.h"
#include "integrate/path_scene.h"
#include "integrate/shadings-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// Lane k of columns' elements i, i + 1, ...
float lane(V v, size_t k) {
  HWY_ALIGN float lanes[kWidth];
  hn::Store(v, d, lanes);
  return lanes[k];
}
Vec3f lane(const V3& v, size_t k) { return {lane(v.x, k), lane(v.y, k), lane(v.z, k)}; }
Vec3f element(const Floats3& f, size_t i) { return {f.x.at[i], f.y.at[i], f.z.at[i]}; }

V3 wide(Vec3f v) { return set3(d, v); }
float number(V v) { return lane(v, 0); }
Vec3f vector(const V3& v) { return lane(v, 0); }

// A light's numbers, computed as the shading does.
ExplainedRay::Light light_numbers(const RenderSettings& settings, Vec3f normal, Vec3f to_light,
                                  Vec3f in, float shine) {
  const V3 n = wide(normal), l = wide(to_light), view = wide(in);
  const bool blinn = settings.shading == ShadingModel::blinn_phong;
  const V3 direction = blinn ? halfway(l, view) : mirrored_light(l, n);
  const V cosine = blinn ? dot(n, direction) : hn::Neg(dot(direction, view));
  return {.n_dot_l = number(dot(n, l)),
          .direction = vector(direction),
          .cosine = number(cosine),
          .power = number(highlight_power(cosine, hn::Set(d, shine)))};
}

// Likewise, the numbers for the children of a ray along `in`.
void add_optics(const RenderSettings& settings, Vec3f in, ExplainedRay::Surface& s) {
  const V3 dir = wide(in), n = wide(s.normal), flat = wide(s.geometric);
  const V eta = hn::Set(d, s.eta), zero = hn::Zero(d);
  const M mirrors = hn::Gt(dot(renormalize(d, reflect(dir, n)), flat), zero);
  M passes = hn::FirstN(d, 1);
  const M through = hn::Lt(dot(refract(dir, n, eta, passes), flat), zero);
  const V3 used = select(through, n, flat);
  const V cosine = hn::Neg(dot(dir, used));
  s.mirror_normal = vector(select(mirrors, n, flat)), s.refraction_normal = vector(used);
  s.cosine = number(cosine), s.cosine2_behind = number(squared_cosine_behind(cosine, eta));
  if (settings.fresnel != Fresnel::none && s.transmission > 0)
    s.reflectance = number(reflectance(settings.fresnel, dir, n, eta));
}

class RayRecorder final : public Recorder {
 public:
  // `sample`: the one to record; `models`: the shading uses materials' specular colours.
  RayRecorder(const RenderSettings& settings, uint32_t sample, bool models, WorkControl& control,
              Explanation& out)
      : settings_(settings), sample_(sample), models_(models), control_(control), out_(out) {}

  void begin_sample(uint32_t sample) override { recording_ = sample == sample_; }

  void traced(const Wavefront& w, int level) override {
    const PathRays& current = w.rays();
    for (size_t i = 0; recording_ && i < current.rays.size(); ++i) {
      const uint32_t branch = current.branch[i];
      const int parent = level == 1 ? -1 : find(branch / 2);
      places_[branch] = int(out_.rays.size());
      ExplainedRay& r = add(kind_of(parent, branch % 2, current.rays[i]), parent, current.rays[i],
                            lane(current.weights(i / kWidth * kWidth), i % kWidth));
      r.hit = w.hits()[i];
      if (!r.hit.found()) set_background(r, w);
    }
  }

  void untraced(const Wavefront& w, size_t first, const V3& origin, const V3& dir, const V3& weight,
                uint32_t side, M mask) override {
    const PathRays& current = w.rays();
    const V chosen = hn::IfThenElseZero(mask, hn::Set(d, 1));
    for (size_t k = 0; recording_ && k < kWidth && first + k < current.rays.size(); ++k) {
      if (lane(chosen, k) == 0) continue;
      ExplainedRay& r = add(child_kind(side), find(current.branch[first + k]),
                            {lane(origin, k), lane(dir, k)}, lane(weight, k));
      r.traced = false;
      set_background(r, w);
    }
  }

  void ambient(const Wavefront& w, size_t n) override {
    for (size_t i = 0; recording_ && i < n; ++i)
      out_.rays[size_t(find(w.rays().branch[i]))].ambient = element(w.points().radiance, i);
  }

  void shadow_rays(const Wavefront& w, const uint8_t* hidden, size_t l, size_t n) override {
    const RayBatch& rays = w.shadow_rays();
    shadow_of_.assign(n, -1);
    for (size_t i = 0; recording_ && i < n; ++i) {
      if (!(rays.tmax[i] > 0)) continue;
      const int parent = find(w.rays().branch[i]);
      const ExplainedRay& from = out_.rays[size_t(parent)];
      ExplainedRay r{.kind = ExplainedRay::Kind::shadow,
                     .parent = parent,
                     .level = from.level,
                     .light = from.bounce ? -1 : int(l),
                     .ray = rays[i],
                     .occluded = hidden[i] != 0,
                     .weight = from.weight};
      if (!from.bounce)
        r.lit = light_numbers(settings_, element(w.points().normal, i), r.ray.dir, from.ray.dir,
                              w.points().shine.at[i]);
      shadow_of_[i] = int(out_.rays.size());
      out_.rays.push_back(r);
    }
  }

  void lit(size_t first, size_t n, const V3& diffuse, const V3& both) override {
    for (size_t i = first; recording_ && i < std::min(first + kWidth, n); ++i) {
      if (shadow_of_[i] < 0) continue;
      ExplainedRay& r = out_.rays[size_t(shadow_of_[i])];
      if (r.occluded) continue;
      r.diffuse = Vec3d(lane(diffuse, i - first));
      // Exact, so that the two add up to the surface's float.
      r.highlight = Vec3d(lane(both, i - first)) - r.diffuse;
    }
  }

  void bounced(const Wavefront& w, size_t first, size_t n, const PathLights::Choice* lights,
               const Bounce& b) override {
    for (size_t k = 0; recording_ && k < kWidth && first + k < n; ++k) {
      ExplainedRay& r = out_.rays[size_t(find(w.rays().branch[first + k]))];
      r.bounce = ExplainedRay::Bounce{.diffuse = lane(b.lobes.diffuse, k),
                                      .mirror = lane(b.lobes.mirror, k),
                                      .coat = lane(b.lobes.coat, k),
                                      .glass = lane(b.lobes.glass, k),
                                      .roughness = lane(b.lobes.roughness, k),
                                      .clearcoat = lane(b.lobes.clearcoat, k),
                                      .sheen = lane(b.lobes.sheen, k),
                                      .transmittance = lane(b.transmittance, k),
                                      .emission = lane(b.emission, k),
                                      .emission_weight = lane(b.emission_weight, k),
                                      .emission_density = lane(b.emission_density, k),
                                      .density = lane(b.density, k),
                                      .weight = lane(b.weight, k),
                                      .chance = lane(b.chance, k)};
      normals_[first + k] = lane(b.normal, k);
      if (lane(b.light_weight, k) == 0) continue;
      r.bounce->light = name_of(w, lights[k]);
      r.bounce->light_probability = lights[k].probability;
      r.bounce->light_density = lane(b.light_density, k);
      r.bounce->light_radiance = lane(b.light, k);
      r.bounce->light_bsdf = lane(b.light_bsdf, k);
      r.bounce->light_bsdf_density = lane(b.light_bsdf_density, k);
      r.bounce->light_weight = lane(b.light_weight, k);
      r.bounce->direct = lane(b.direct, k);
    }
  }

  void escaped(const Wavefront& w, size_t first, M mask, const V3& light, V density,
               V weight) override {
    const V chosen = hn::IfThenElseZero(mask, hn::Set(d, 1));
    for (size_t k = 0; recording_ && k < kWidth; ++k) {
      if (lane(chosen, k) == 0) continue;
      ExplainedRay& r = out_.rays[size_t(find(w.rays().branch[first + k]))];
      r.background = lane(light, k);
      r.escape = {lane(density, k), lane(weight, k)};
      r.adds = unscaled(w.sums().fixed(lane(light * weight, k) * r.weight));
    }
  }

  void shaded(const Wavefront& w, size_t n) override {
    const SurfacePoints& v = w.points();
    for (size_t i = 0; recording_ && i < n; ++i) {
      ExplainedRay& r = out_.rays[size_t(find(w.rays().branch[i]))];
      r.surface = ExplainedRay::Surface{.point = element(v.point, i),
                                        .normal = element(v.normal, i),
                                        .geometric = element(v.geometric, i),
                                        .material = v.material[i],
                                        .color = element(v.color, i),
                                        .kd = v.kd.at[i],
                                        .ks = v.ks.at[i],
                                        .shine = v.shine.at[i],
                                        .transmission = v.transmission.at[i],
                                        .ior = v.ior.at[i],
                                        .specular = models_ ? element(v.specular, i) : Rgb(1),
                                        .radiance = element(v.radiance, i),
                                        .eta = v.eta.at[i]};
      if (models_) {
        r.surface->gloss = settings_.gloss.value_or(v.roughness.at[i]);
        r.surface->translucency = settings_.translucency.value_or(v.roughness.at[i]);
      }
      if (r.bounce)
        r.surface->normal = normals_[i];
      else
        add_optics(settings_, r.ray.dir, *r.surface);
      r.adds = unscaled(w.sums().fixed(element(v.radiance, i) * r.weight));
    }
  }

 private:
  using Kind = ExplainedRay::Kind;

  // The branch in the ray tree (integrate/sampler.h) identifies the rays of a sample.
  int find(uint32_t branch) const { return places_.at(branch); }
  ExplainedRay& add(Kind kind, int parent, const Ray& ray, Rgb weight) {
    const int level = parent < 0 ? 1 : out_.rays[size_t(parent)].level + 1;
    if (out_.rays.size() >= kMaxExplainedRays) control_.stop = true;
    out_.rays.push_back(
        {.kind = kind, .parent = parent, .level = level, .ray = ray, .weight = weight});
    return out_.rays.back();
  }
  static Kind child_kind(uint32_t side) { return side ? Kind::refraction : Kind::reflection; }
  Kind kind_of(int parent, uint32_t side, const Ray& ray) const {
    if (parent < 0) return Kind::eye;
    const ExplainedRay& from = out_.rays[size_t(parent)];
    return child_kind(from.bounce ? dot(ray.dir, from.surface->geometric) < 0 : side);
  }
  static std::string name_of(const Wavefront& w, const PathLights::Choice& light) {
    using Its = PathLights::Choice::Kind;
    const PathLights& lights = w.scene().path->lights;
    switch (light.kind) {
      case Its::near:
        return fmt::format("{}", light.index);
      case Its::triangle:
        return fmt::format("triangle {}", lights.triangles()[light.index].triangle);
      case Its::distant:
        // The lights of NFF have a place, but do not decrease.
        return fmt::format("{}{}", lights.distant()[light.index].is_distant ? "distant " : "",
                           light.index);
      case Its::environment:
        return "environment";
      case Its::none:
        break;
    }
    return {};
  }
  void set_background(ExplainedRay& r, const Wavefront& w) const {
    const auto [light, sums] = w.escaped_light(r.ray.dir, r.weight);
    r.background = light, r.adds = unscaled(sums);
  }
  Vec3d unscaled(const PixelSums& s) const {
    return Vec3d(double(s[0]), double(s[1]), double(s[2])) * out_.unit;
  }

  const RenderSettings& settings_;
  uint32_t sample_;
  bool models_;
  WorkControl& control_;
  Explanation& out_;
  bool recording_ = false;
  std::unordered_map<uint32_t, int> places_;  // index of rays by branch
  std::vector<int> shadow_of_;                // by current ray; -1: none
  std::array<Vec3f, kChunk> normals_;         // of bounces
};

}  // namespace

std::optional<Explanation> explain(const Scene& scene, const Accel& accel, RenderSettings settings,
                                   int x, int y, uint32_t sample) {
  settings.crop = Crop{x, y, x + 1, y + 1};
  settings.channels = {};
  const PreparedScene prepared(scene, accel, settings);
  const bool is_path = settings.integrator == IntegratorKind::path;
  Film film(1, 1, is_path ? path_bound(scene, settings) : classic_bound(scene, settings));
  Explanation out;
  out.ambient = is_path ? 0 : ambient_factor(scene, settings);
  out.unit = 1 / film.scale();
  if (!is_path) out.lights = prepared.emitters;
  WorkControl control;
  RayRecorder recorder(settings, sample, !is_path && needs_models(scene, settings), control, out);
  auto shading = is_path ? make_path_shading(prepared) : make_classic_shading(prepared);
  Wavefront(prepared, control, std::move(shading), &recorder).render(0, {sample, sample + 1}, film);
  if (control.stop) return std::nullopt;
  out.counts = film.rays();
  for (const ExplainedRay& r : out.rays) out.rgb = out.rgb + r.adds;
  return out;
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

namespace raio::core {

std::expected<Explanation, Error> explain_sample(const Scene& scene, const Accel& accel,
                                                 const RenderSettings& settings, int x, int y,
                                                 uint32_t sample) {
  const auto refuse = [](std::string_view option, std::string message) {
    return std::unexpected(bad_option(option, std::move(message)));
  };
  if (settings.integrator == IntegratorKind::ambient)
    return refuse("integrator",
                  "the rays of `integrator` ambient cannot be explained; give classic or path");
  if (accel.geometry().any_transparent())
    return refuse("", "rays through surfaces of an opacity below 1 cannot be explained yet");
  if (scene.has_cutouts())
    return refuse("", "rays through the alpha of textures cannot be explained yet");
  auto out = HWY_NAMESPACE::explain(scene, accel, settings, x, y, sample);
  if (out) return std::move(*out);
  return std::unexpected(Error{ErrorKind::no_resource, "",
                               fmt::format("the sample has more than {} rays; choose a smaller "
                                           "`depth`",
                                           kMaxExplainedRays)});
}

}  // namespace raio::core
