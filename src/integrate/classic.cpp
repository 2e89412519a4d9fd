#include "integrate/classic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/classic.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/optics-inl.h"
#include "integrate/shadings-inl.h"
#include "integrate/sky-inl.h"
#include "scene/columns.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// With kModels, uses the settings' models and the materials' specular colours; without, shades as
// NFF does, without the cost of the choice.
template <bool kModels>
class PhongShading final : public Shading {
 public:
  explicit PhongShading(const PreparedScene& scene) : scene_(scene) {
    ambient_ = Rgb(ambient_factor(scene.scene, scene.settings));
    rough_ = kModels && is_rough(scene.scene, scene.settings);
    for (const Material& m : scene.scene.materials) {
      const bool mirrors = m.ks > 0 || (divides() && m.transmission > 0);
      any_mirror_ |= mirrors && !scene.settings.no_reflection;
      any_transparent_ |= m.transmission > 0 && !scene.settings.no_refraction;
    }
  }

  int levels() const override { return scene_.settings.depth; }
  bool tints() const override { return kModels; }
  Rgb background() const override { return scene_.settings.background; }
  bool has_sky() const override { return kModels && scene_.settings.sky; }
  V3 sky(const V3& dir) const override { return sky_towards(*scene_.settings.sky, dir); }

  void shade(Wavefront& w, int, size_t n, const WideSampler<D>& sampler) override {
    SurfacePoints& v = w.points();
    if constexpr (kModels) {
      gather_other_materials(v, n);
      sampler_ = &sampler;
    }
    const V3 ambient = set3(d, ambient_);
    for (size_t i = 0; i < n; i += kWidth) store(ambient * load(v.color, i), v.radiance, i);
    if (w.recorder()) w.recorder()->ambient(w, n);
    for (size_t l = 0; l < scene_.emitters.size(); ++l) add_light(w, l, n, sampler);
  }

  void spawn(Wavefront& w, int level, size_t n) override {
    if (any_mirror_) reflect_rays(w, level, n);
    if (any_transparent_) refract_rays(w, level, n);
  }

 private:
  // Adds the contribution of light l to the surface points that it reaches.
  HWY_NOINLINE void add_light(Wavefront& w, size_t l, size_t n, const WideSampler<D>& sampler) {
    const PreparedScene::Emitter& emitter = scene_.emitters[l];
    SurfacePoints& v = w.points();
    const V zero = hn::Zero(d);
    RayBatch& rays = w.shadow_rays();
    rays.resize(n);
    size_t lit = 0;
    for (size_t i = 0; i < n; i += kWidth) {
      V3 target = set3(d, emitter.position);
      if (scene_.settings.soft_shadows) {
        const Wide2<D> p = sampler.in_square(w.place_of(load(w.rays().pixel, i)),
                                             load(w.rays().branch, i), kLight + uint32_t(l));
        const V half = hn::Set(d, 0.5f);
        target = target + (set3(d, emitter.edge_u) * hn::Sub(p.x, half) +
                           set3(d, emitter.edge_v) * hn::Sub(p.y, half));
      }
      const V3 outside = load(v.outside, i), to_light = target - outside;
      const V distance = length(to_light);
      const M apart = hn::Gt(distance, zero);
      const V3 dir = to_light * hn::IfThenElseZero(apart, hn::Div(hn::Set(d, 1), distance));
      // No light from behind the surface, even where a smooth triangle's normal tilts that way.
      const M facing =
          hn::And(hn::FirstN(d, n - i), hn::And(hn::Gt(dot(load(v.normal, i), dir), zero),
                                                hn::Gt(dot(load(v.geometric, i), dir), zero)));
      // Ends just short of the light, by the possible rounding of the division above.
      const V tmax = hn::Mul(distance, hn::Set(d, 1 - 4 * std::numeric_limits<float>::epsilon()));
      hn::Store(outside.x, d, &rays.ox[i]), hn::Store(outside.y, d, &rays.oy[i]);
      hn::Store(outside.z, d, &rays.oz[i]);
      hn::Store(dir.x, d, &rays.dx[i]), hn::Store(dir.y, d, &rays.dy[i]);
      hn::Store(dir.z, d, &rays.dz[i]);
      hn::Store(hn::IfThenElse(facing, tmax, hn::Set(d, -1)), d, &rays.tmax[i]);
      lit += hn::CountTrue(d, facing);
    }
    if (lit == 0) return;
    w.counts().shadow += lit;
    const uint8_t* const hidden = w.occluded(sampler, kLightDepth + uint32_t(l));
    if (w.recorder()) w.recorder()->shadow_rays(w, hidden, l, n);
    const float* const shares = w.shares();
    V3 intensity = set3(d, emitter.intensity);
    for (size_t i = 0; i < n; i += kWidth) {
      if (shares) intensity = set3(d, emitter.intensity) * hn::LoadU(d, shares + i);
      const M facing = hn::And(hn::FirstN(d, n - i), hn::Gt(load(rays.tmax, i), zero));
      const auto stopped = hn::PromoteTo(du, hn::LoadU(hn::Rebind<uint8_t, DU>(), hidden + i));
      const M seen = hn::And(facing, hn::RebindMask(d, hn::Eq(stopped, hn::Zero(du))));
      w.counts().shadow_hits += hn::CountTrue(d, hn::AndNot(seen, facing));
      if (hn::AllFalse(d, seen)) continue;
      const V3 dir = directions(rays, i), normal = load(v.normal, i);
      const V3 diffuse = load(v.color, i) * hn::Mul(load(v.kd, i), dot(normal, dir));
      V3 light = diffuse;
      const V ks = load(v.ks, i);
      if (!hn::AllFalse(d, hn::Gt(ks, zero))) {
        const V mirror = highlight_cosine(dir, normal, directions(w.rays().rays, i));
        const V highlight = hn::Mul(ks, highlight_power(mirror, load(v.shine, i)));
        if constexpr (kModels)
          light = light + load(v.specular, i) * highlight;
        else
          light = light + V3{highlight, highlight, highlight};
      }
      if (w.recorder()) w.recorder()->lit(i, n, intensity * diffuse, intensity * light);
      const V3 sum = load(v.radiance, i);
      store(select(seen, sum + intensity * light, sum), v.radiance, i);
    }
  }

  // Phong: between the mirrored light and the eye. Blinn: between the normal and the half vector.
  HWY_INLINE V highlight_cosine(const V3& to_light, const V3& normal, const V3& in) const {
    if constexpr (kModels)
      if (scene_.settings.shading == ShadingModel::blinn_phong)
        return dot(normal, halfway(to_light, in));
    return hn::Neg(dot(mirrored_light(to_light, normal), in));
  }

  // Whether Fresnel's reflectance determines the mirrored part where T > 0.
  bool divides() const { return kModels && scene_.settings.fresnel != Fresnel::none; }
  HWY_INLINE V reflectance_at(const SurfacePoints& v, size_t i, const V3& in) const {
    return reflectance(scene_.settings.fresnel, in, load(v.normal, i), load(v.eta, i));
  }
  // The weight of the mirrored ray: one number for NFF, else red, green and blue.
  HWY_INLINE auto mirrored_part(const SurfacePoints& v, size_t i, const V3& in) const {
    const V ks = load(v.ks, i);
    if constexpr (kModels) {
      const V3 tinted = load(v.specular, i) * ks;
      if (!divides()) return tinted;
      const V part = reflectance_at(v, i, in);
      const M clear = hn::Gt(load(v.transmission, i), hn::Zero(d));
      return select(clear, V3{part, part, part}, tinted);
    } else {
      return ks;
    }
  }
  static HWY_INLINE V most_of(V part) { return part; }
  static HWY_INLINE V most_of(const V3& part) { return largest(part); }

  // The columns parallel to the materials.
  void gather_other_materials(SurfacePoints& v, size_t n) const {
    const auto& colors = scene_.scene.material_specular;
    const auto& roughness = scene_.scene.material_roughness;
    for (size_t i = 0; i < n; ++i) {
      v.specular.set(i, colors.empty() ? Rgb(1) : colors[v.material[i]]);
      v.roughness.at[i] = roughness.empty() ? 0 : roughness[v.material[i]];
    }
  }

  // A direction in the lobe of a rough surface (docs/shading.md): that of a perfect one, plus
  // roughness times a point of the unit sphere. It stays on the side of `side`, a unit vector.
  HWY_INLINE V3 spread(Wavefront& w, size_t i, const V3& dir, const V3& side, Purpose purpose,
                       const std::optional<float>& set) const {
    const V roughness = set ? hn::Set(d, *set) : load(w.points().roughness, i);
    const V zero = hn::Zero(d), one = hn::Set(d, 1), two = hn::Set(d, 2);
    const M rough = hn::Gt(roughness, zero);
    if (hn::AllFalse(d, rough)) return dir;
    const Wide2<D> square =
        sampler_->in_square(w.place_of(load(w.rays().pixel, i)), load(w.rays().branch, i), purpose);
    const Wide2<D> disc = square_to_disc(d, square.x, square.y);
    // Maps the disc to the sphere, keeping areas.
    const V r2 = hn::Add(hn::Mul(disc.x, disc.x), hn::Mul(disc.y, disc.y));
    const V scale = hn::Mul(two, hn::Sqrt(hn::Max(hn::Sub(one, r2), zero)));
    const V3 on_sphere = {hn::Mul(disc.x, scale), hn::Mul(disc.y, scale),
                          hn::Sub(one, hn::Mul(two, r2))};
    const V3 moved = dir + on_sphere * roughness;
    const M sound = hn::And(rough, hn::Gt(dot(moved, moved), zero));
    V3 out = select(sound, normalize(d, moved), dir);
    const V across = dot(out, side);
    out = select(hn::Lt(across, zero), out - side * hn::Mul(two, across), out);
    return select(sound, out, dir);
  }

  void reflect_rays(Wavefront& w, int level, size_t n) {
    const SurfacePoints& v = w.points();
    Wavefront::Children children(w, level, n);
    for (size_t i = 0; i < n; i += kWidth) {
      const auto part = mirrored_part(v, i, directions(w.rays().rays, i));
      const M mirrors = hn::And(hn::FirstN(d, n - i), hn::Gt(most_of(part), hn::Zero(d)));
      if (hn::AllFalse(d, mirrors)) continue;
      const V3 in = directions(w.rays().rays, i), geometric = load(v.geometric, i);
      V3 dir = mirrored(in, load(v.normal, i), geometric);
      if constexpr (kModels)
        if (rough_) dir = spread(w, i, dir, geometric, kGloss, scene_.settings.gloss);
      w.counts().reflection += children.add(i, load(v.outside, i), dir, part, 0, mirrors);
    }
    children.done();
  }

  void refract_rays(Wavefront& w, int level, size_t n) {
    const SurfacePoints& v = w.points();
    Wavefront::Children children(w, level, n);
    for (size_t i = 0; i < n; i += kWidth) {
      const V transmission = load(v.transmission, i);
      const M clear = hn::And(hn::FirstN(d, n - i), hn::Gt(transmission, hn::Zero(d)));
      if (hn::AllFalse(d, clear)) continue;
      const V3 in = directions(w.rays().rays, i), geometric = load(v.geometric, i);
      M passes = clear;
      V3 dir = refracted(in, load(v.normal, i), geometric, load(v.eta, i), passes);
      if constexpr (kModels)
        if (rough_)
          dir = spread(w, i, dir, -geometric, kTranslucency, scene_.settings.translucency);
      V part = transmission;
      if constexpr (kModels)
        if (divides()) part = hn::Sub(hn::Set(d, 1), reflectance_at(v, i, in));
      const V3 inside = offset_point(load(v.point, i), geometric, load(v.scale, i), false);
      w.counts().refraction += children.add(i, inside, dir, part, 1, passes);
    }
    children.done();
  }

  const PreparedScene& scene_;
  Rgb ambient_;                                        // times the material's colour
  bool any_mirror_ = false, any_transparent_ = false;  // among the materials
  bool rough_ = false;
  const WideSampler<D>* sampler_ = nullptr;  // of the current sample
};

}  // namespace

std::unique_ptr<Shading> make_classic_shading(const PreparedScene& scene) {
  if (needs_models(scene.scene, scene.settings)) return std::make_unique<PhongShading<true>>(scene);
  return std::make_unique<PhongShading<false>>(scene);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

double classic_bound(const Scene& scene, const RenderSettings& settings) {
  double light = 0.1;  // ambient
  for (const Light& l : scene.lights) light += l.color ? max_component(*l.color) : 1.0;
  const float own_color = brightest_color(scene);  // may override a material's
  const float tint = brightest_tint(scene);
  double brightest = 0, gain = 0;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    const float color = std::max(max_component(m.color), own_color) * tint;
    const double mirrored = double(m.ks) * max_component(scene.specular_of(MaterialId(i)));
    brightest = std::max(brightest, light * (color * (1.0 + m.kd) + mirrored));
    const bool divides = settings.fresnel != Fresnel::none && m.transmission > 0;
    gain = std::max(gain, divides ? 1.0 : mirrored + m.transmission);
  }
  brightest += settings.sky ? double(settings.sky->largest) / 255
                            : double(max_component(settings.background));
  double sum = 0, weight = 1;
  for (int level = 0; level <= settings.depth; ++level, weight *= gain) sum += weight * brightest;
  return sum;
}

}  // namespace raio::core
#endif
