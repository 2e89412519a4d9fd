#include "integrate/path.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/path.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/bsdf-inl.h"
#include "integrate/colors-inl.h"
#include "integrate/cutouts-inl.h"
#include "integrate/environment-inl.h"
#include "integrate/environment_sampler-inl.h"
#include "integrate/lights-inl.h"
#include "integrate/normal_map.h"
#include "integrate/path_scene.h"
#include "integrate/shading-inl.h"
#include "integrate/shadings-inl.h"
#include "integrate/sky-inl.h"
#include "scene/texture.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

// One of two ways to sample the same direction: the balance heuristic of Veach and Guibas 1995,
// "Optimally Combining Sampling Techniques for Monte Carlo Rendering".
HWY_INLINE V balance(V of_this, V of_other) { return hn::Div(of_this, hn::Add(of_this, of_other)); }

// Rows of PathMaterial, gathered for the lanes.
class Materials {
 public:
  Materials(const std::vector<PathMaterial>& all, const MaterialId* ids) : all_(all), ids_(ids) {
    is_one_ = hn::AllTrue(du, hn::Eq(hn::Load(du, ids), hn::Set(du, ids[0])));
  }
  HWY_INLINE V number(float PathMaterial::* member) const { return gather(&(all_[0].*member)); }
  HWY_INLINE U whole(uint32_t PathMaterial::* member) const {
    return hn::BitCast(du, gather(reinterpret_cast<const float*>(&(all_[0].*member))));
  }
  HWY_INLINE V3 color(Rgb PathMaterial::* member) const {
    const Rgb& first = all_[0].*member;
    return {gather(&first.x), gather(&first.y), gather(&first.z)};
  }
  const PathMaterial& operator[](size_t lane) const { return all_[ids_[lane]]; }

 private:
  HWY_INLINE V gather(const float* first) const {
    constexpr auto kStride = uint32_t(sizeof(PathMaterial) / 4);
    if (is_one_) return hn::Set(d, first[size_t(ids_[0]) * kStride]);
    const U index = hn::Mul(hn::Load(du, ids_), hn::Set(du, kStride));
    return hn::GatherIndex(d, first, hn::BitCast(Signed<D>(), index));
  }

  const std::vector<PathMaterial>& all_;
  const MaterialId* ids_;
  bool is_one_;
};

class PathShading final : public Shading {
 public:
  explicit PathShading(const PreparedScene& scene)
      : scene_(scene),
        path_(*scene.path),
        lights_(scene.path->lights),
        has_groups_(std::ranges::any_of(
            kLightGroups, [&](Channel c) { return scene.settings.channels.has(c); })) {
    if (!scene.scene.environment.empty()) environment_.emplace(scene.scene);
    if (lights_.environment())
      environment_sampler_.emplace(scene.scene.environment[0], *lights_.environment());
  }

  int levels() const override { return scene_.settings.depth; }
  bool tints() const override { return true; }
  bool weighs() const override { return true; }
  bool is_bounded() const override { return false; }
  Rgb background() const override { return scene_.settings.background; }
  bool has_sky() const override {
    return scene_.settings.sky != nullptr || scene_.settings.sees_environment;
  }
  V3 sky(const V3& dir) const override {
    return scene_.settings.sees_environment ? environment_->radiance(dir)
                                            : sky_towards(*scene_.settings.sky, dir);
  }

  // Eye rays see the background, others the light that surrounds the scene.
  bool shade_misses(Wavefront& w, int level, bool, const WideSampler<D>&) override {
    if (level == 1) return false;
    const PathRays& rays = w.rays();
    const size_t n = rays.rays.size();
    for (size_t i = 0; i < n; i += kWidth) {
      const M missed = hn::And(
          hn::FirstN(d, n - i),
          hn::RebindMask(d, hn::Eq(load(w.hits().primitive, i), hn::Set(du, kNoPrimitive))));
      if (hn::AllFalse(d, missed)) continue;
      const V3 dir = directions(rays.rays, i);
      const V3 light = surrounding(dir);
      V other = hn::Zero(d), weight = hn::Set(d, 1);
      if (environment_sampler_) {
        const V density = rays.densities(i);
        other = hn::Mul(environment_sampler_->density(dir),
                        hn::Set(d, lights_.environment_probability()));
        weight = hn::IfThenElse(hn::Gt(density, hn::Zero(d)), balance(density, other), weight);
      }
      if (w.recorder()) w.recorder()->escaped(w, i, missed, light, other, weight);
      w.sums().add(light * weight * rays.weights(i), &rays.pixel[i], missed);
      if (has_groups_) add_to_group(w, Channel::surroundings, light * weight, i, missed);
    }
    return true;
  }

  void shade(Wavefront& w, int level, size_t n, const WideSampler<D>& sampler) override {
    SurfacePoints& v = w.points();
    RayBatch& shadows = w.shadow_rays();
    shadows.resize(n);
    const bool goes_on = level < levels(), samples_lights = goes_on && !lights_.empty();
    for (size_t i = 0; i < n; i += kWidth) {
      const M in = hn::FirstN(d, n - i);
      const Materials materials(path_.materials, v.material + i);
      const V3 dir = directions(w.rays().rays, i), geometric = load(v.geometric, i);
      const V side = load(v.side, i);
      const V3 smooth = load(v.normal, i);
      if (goes_on && path_.any_normal_maps) tilt_normals(w, materials, i, n);
      V3 normal = load(v.normal, i);
      const M tilted = hn::Ge(dot(normal, dir), hn::Set(d, -1e-4f));
      normal = select(tilted, geometric, normal);
      const V3 inside = transmittance(w, materials, i);
      const Emitted emitted = emission(w, materials, i, in);
      const V3 glow = inside * (emitted.radiance * emitted.weight);
      store(glow, v.radiance, i);
      if (has_groups_) add_to_group(w, Channel::emission, glow, i, in);
      if (!goes_on && !w.recorder()) continue;
      const WideFrame frame(normal);
      const V3 to_eye = -dir;
      const V3 out = {dot(to_eye, frame.u), dot(to_eye, frame.v),
                      hn::Max(dot(to_eye, normal), hn::Set(d, 1e-6f))};
      Lobes lobes = lobes_of(w, materials, i, side);
      if (path_.any_layers && path_.any_normal_maps) {
        // Clear coats have no normal map.
        const M hidden = hn::Ge(dot(smooth, dir), hn::Set(d, -1e-4f));
        const V3 own = select(hidden, geometric, smooth);
        lobes.clearcoat_normal = {dot(own, frame.u), dot(own, frame.v), dot(own, normal)};
      }
      const Bsdf bsdf(lobes, out, path_.energy);
      const U place = w.place_of(load(w.rays().pixel, i)), branch = load(w.rays().branch, i);
      LightRays light{};
      BsdfValue value{};
      V light_weight = hn::Zero(d);
      if (samples_lights) {
        light = sample_lights(w, i, n, sampler, place, branch);
        const V3 local = {dot(light.dir, frame.u), dot(light.dir, frame.v), dot(light.dir, normal)};
        value = bsdf.evaluate(local);
        const V across = dot(light.dir, geometric), zero = hn::Zero(d);
        const M sound = hn::Gt(hn::Mul(across, local.z), zero);
        light_weight =
            hn::IfThenElse(hn::Gt(light.pdf, zero), balance(light.pdf, value.pdf), hn::Set(d, 1));
        const V3 part = inside * value.value * light.radiance * light_weight;
        const M lit = hn::And(hn::And(in, sound), hn::Gt(largest(part), zero));
        store(part, direct_, i);
        put_ray(shadows, i, start(v, i, geometric, across), light.dir, light.length, lit);
      }
      const Wide2<D> choice = sampler.in_square(place, branch, kLobe);
      const BsdfSample next = bsdf.sample(sampler.in_square(place, branch, kBsdf), choice.x);
      const V3 world =
          renormalize(d, frame.u * next.in.x + frame.v * next.in.y + normal * next.in.z);
      const V across = dot(world, geometric);
      V3 weight = inside * next.weight;
      // Russian roulette.
      const V chance = level < kFirstRoulette
                           ? hn::Set(d, 1)
                           : hn::Min(largest(w.rays().weights(i) * weight), hn::Set(d, 0.95f));
      if (w.recorder())
        w.recorder()->bounced(w, i, n, choices_,
                              {.normal = normal,
                               .lobes = lobes,
                               .transmittance = inside,
                               .emission = emitted.radiance,
                               .emission_density = emitted.density,
                               .emission_weight = emitted.weight,
                               .light = light.radiance,
                               .light_density = light.pdf,
                               .light_bsdf = value.value,
                               .light_bsdf_density = value.pdf,
                               .light_weight = light_weight,
                               .direct = load(direct_, i),
                               .density = next.pdf,
                               .weight = weight,
                               .chance = chance});
      const M survives = hn::Lt(choice.y, chance);
      weight = weight * hn::Div(hn::Set(d, 1), hn::Max(chance, hn::Set(d, 1e-20f)));
      // A smooth normal can send the ray through the surface that it should leave.
      const M sound = hn::And(hn::Gt(hn::Mul(across, next.in.z), hn::Zero(d)),
                              hn::Gt(largest(weight), hn::Zero(d)));
      const M continues = hn::And(in, hn::And(survives, sound));
      store(world, dir_, i), store(weight, weight_, i), store(next.pdf, pdf_, i);
      store(start(v, i, geometric, across), origin_, i);
      store(hn::IfThenElse(continues, across, hn::Zero(d)), across_, i);
    }
    if (!samples_lights) return;
    const uint8_t* const hidden = add_lit(w, n, sampler, kSkyDepth, [&](size_t i, V lit) HWY_ATTR {
      const V3 light = load(direct_, i) * lit;
      if (has_groups_) add_sampled_to_groups(w, light, i, hn::Gt(lit, hn::Zero(d)));
      return light;
    });
    if (hidden && w.recorder()) w.recorder()->shadow_rays(w, hidden, 0, n);
  }

  void spawn(Wavefront& w, int level, size_t n) override {
    if (level == levels()) return;
    Wavefront::Children children(w, level, n);
    const V zero = hn::Zero(d);
    for (size_t i = 0; i < n; i += kWidth) {
      const V across = load(across_, i);
      const M continues = hn::And(hn::FirstN(d, n - i), hn::Ne(across, zero));
      if (hn::AllFalse(d, continues)) continue;
      const size_t reflected = hn::CountTrue(d, hn::And(continues, hn::Gt(across, zero)));
      w.counts().reflection += reflected;
      w.counts().refraction += children.add(i, load(origin_, i), load(dir_, i), load(weight_, i), 0,
                                            continues, load(pdf_, i)) -
                               reflected;
    }
    children.done();
  }

 private:
  static constexpr int kFirstRoulette = 4;  // level

  // Rays to sampled points of lights, and the unoccluded radiance from there, divided by the
  // density.
  struct LightRays {
    V3 dir, radiance;
    V length;
    V pdf;  // per solid angle; 0 where no other ray finds the light
  };

  // Light groups: of current rays i, i + 1, ..., as the colours get it.
  static HWY_NOINLINE void add_to_group(Wavefront& w, Channel group, const V3& light, size_t i,
                                        M mask) {
    if (w.sums().layout().has(group) && !hn::AllFalse(d, mask))
      w.sums().add_mean(group, light * w.rays().weights(i), &w.rays().pixel[i], mask);
  }
  void add_sampled_to_groups(Wavefront& w, const V3& light, size_t i, M mask) const {
    for (const Channel group : kLightGroups) {
      const V of_group = hn::Set(d, float(group));
      add_to_group(w, group, light, i, hn::And(mask, hn::Eq(load(groups_, i), of_group)));
    }
  }
  static Channel group_of(PathLights::Choice::Kind light) {
    using Kind = PathLights::Choice::Kind;
    return light == Kind::environment ? Channel::surroundings
           : light == Kind::triangle  ? Channel::emission
                                      : Channel::lamps;
  }

  V3 surrounding(const V3& dir) const {
    const FigureSettings& figure = scene_.settings.figure;
    if (environment_) return environment_->radiance(dir) * set3(d, figure.sky_light);
    V3 light = set3(d, figure.sky_light);
    if (figure.key_light != KeyLight::scene) return light;
    return light + (scene_.settings.sky ? sky_towards(*scene_.settings.sky, dir)
                                        : set3(d, scene_.settings.background));
  }

  static HWY_INLINE V3 start(const SurfacePoints& v, size_t i, const V3& geometric, V across) {
    const V3 behind = offset_point(load(v.point, i), geometric, load(v.scale, i), false);
    return select(hn::Gt(across, hn::Zero(d)), load(v.outside, i), behind);
  }

  // The transmittance of the medium along the rays, by the law of Bouguer and Beer. A ray that hits
  // a surface from inside has crossed its medium.
  static HWY_INLINE V3 transmittance(const Wavefront& w, const Materials& materials, size_t i) {
    const V per_distance = materials.number(&PathMaterial::per_attenuation_distance);
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    const M inside = hn::And(hn::Lt(load(w.points().side, i), zero), hn::Gt(per_distance, zero));
    if (hn::AllFalse(d, inside)) return {one, one, one};
    const V3 color = materials.color(&PathMaterial::attenuation);
    const V power = hn::IfThenElseZero(inside, hn::Mul(load(w.hits().t, i), per_distance));
    return {pow_unit(d, color.x, power), pow_unit(d, color.y, power), pow_unit(d, color.z, power)};
  }

  // `look_up`: of scene/texture.h.
  template <class LookUp>
  Rgb texture_at(const Wavefront& w, size_t i, uint32_t texture, const LookUp& look_up) const {
    const SurfacePoints& v = w.points();
    const Geometry& geometry = scene_.accel.geometry().object_at(w.hits().instance[i]);
    Uv uv{};
    if (const auto triangle = HitColumns{w.hits(), v.kind, v.index}.triangle(geometry, i))
      uv = texture_coordinates(geometry, *triangle, w.hits().u[i], w.hits().v[i]);
    return look_up(scene_.scene, texture, uv);
  }

  // Normal maps are for shading alone; `geometric` decides which side of the surface is which.
  HWY_NOINLINE void tilt_normals(Wavefront& w, const Materials& materials, size_t i,
                                 size_t n) const {
    SurfacePoints& v = w.points();
    const Geometry& geometry = scene_.accel.geometry();
    for (size_t k = 0; k < std::min(kWidth, n - i); ++k) {
      const PathMaterial& m = materials[k];
      if (m.normal_texture == kNoTexture) continue;
      const size_t at = i + k;
      const InstanceId instance = w.hits().instance[at];
      const auto triangle =
          HitColumns{w.hits(), v.kind, v.index}.triangle(geometry.object_at(instance), at);
      if (!triangle) continue;
      const auto axes = texture_axes(geometry, instance, *triangle);
      if (!axes) continue;
      const auto vector = [&](const Floats3& f) {
        return Vec3f(f.x.at[at], f.y.at[at], f.z.at[at]);
      };
      // From behind, bumps are dents.
      const float side = v.side.at[at];
      const Rgb texel = texture_at(w, at, m.normal_texture, texture_value);
      const Vec3f normal =
          mapped_normal(vector(v.normal) * side, *axes, texel, m.normal_scale) * side;
      v.normal.set(at, bent_normal(normal, vector(v.geometric), -w.rays().rays[at].dir));
    }
  }

  // The emitted radiance towards the rays, the density with which the sampling of lights finds it,
  // and its weight against that.
  struct Emitted {
    V3 radiance;
    V density, weight;
  };
  HWY_INLINE Emitted emission(const Wavefront& w, const Materials& materials, size_t i,
                              M in) const {
    V3 light = materials.color(&PathMaterial::emission);
    const V zero = hn::Zero(d);
    const M front = hn::Or(hn::Gt(load(w.points().side, i), zero),
                           hn::Gt(materials.number(&PathMaterial::is_two_sided), zero));
    const M shines = hn::And(hn::And(in, front), hn::Gt(largest(light), zero));
    if (hn::AllFalse(d, shines)) return {set3(d, Rgb()), zero, zero};
    if (path_.any_layers) {
      const V cosine = dot(load(w.points().geometric, i), directions(w.rays().rays, i));
      light = light * through_coat(materials.number(&PathMaterial::clearcoat),
                                   materials.whole(&PathMaterial::layers), cosine);
    }
    HWY_ALIGN float share[kWidth], others[kWidth] = {}, bits[3][kWidth];
    hn::Store(hn::IfThenElseZero(shines, hn::Set(d, 1)), d, share);
    hn::Store(light.x, d, bits[0]), hn::Store(light.y, d, bits[1]), hn::Store(light.z, d, bits[2]);
    for (size_t k = 0; k < kWidth; ++k) {
      if (share[k] == 0) continue;
      const uint32_t texture = materials[k].emission_texture;
      if (texture != kNoTexture) {
        const Rgb texel = texture_at(w, i + k, texture, texture_color);
        for (size_t c = 0; c < 3; ++c) bits[c][k] *= texel[int(c)];
      }
      const float density = w.rays().density[i + k];
      if (!(density > 0)) continue;
      const Hit hit = w.hits()[i + k];
      const auto triangle = lights_.triangle_at(hit);
      if (!triangle) continue;
      const Ray ray = w.rays().rays[i + k];
      const TriangleLight& t = lights_.triangles()[*triangle];
      const float other = lights_.triangle_probability(ray.origin, Vec3f(), *triangle) *
                          density_of(t, ray.dir, hit.t);
      share[k] = density / (density + other), others[k] = other;
    }
    return {{hn::Load(d, bits[0]), hn::Load(d, bits[1]), hn::Load(d, bits[2])},
            hn::Load(d, others),
            hn::Load(d, share)};
  }

  // The part of the light that shines through clear coats, at a cosine of either sign.
  HWY_INLINE V through_coat(V clearcoat, U tables, V cosine) const {
    const WideLayers layers(path_.energy, tables);
    const V left = layers.at(EnergyTables::kBelowCoat, layers.place(hn::Abs(cosine)));
    return hn::IfThenElse(hn::Gt(clearcoat, hn::Zero(d)), left, hn::Set(d, 1));
  }

  // Per solid angle, of a point of the triangle that is sampled evenly by area.
  static float density_of(const TriangleLight& t, Vec3f dir, float distance) {
    const float cosine = std::abs(dot(dir, t.normal));
    return cosine > 0 ? distance * distance / (cosine * t.area) : 0;
  }

  Lobes lobes_of(const Wavefront& w, const Materials& materials, size_t i, V side) const {
    const SurfacePoints& v = w.points();
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    V metallic = materials.number(&PathMaterial::metallic);
    V roughness = materials.number(&PathMaterial::roughness);
    V transmission = materials.number(&PathMaterial::transmission);
    if (path_.any_textures) scale_by_textures(w, materials, i, metallic, roughness, transmission);
    const V3 base = load(v.color, i);
    const V rest = hn::Sub(one, metallic), opaque = hn::Mul(rest, hn::Sub(one, transmission));
    const V3 mirror = materials.color(&PathMaterial::mirror);
    const V3 specular = materials.color(&PathMaterial::specular);
    const V white = materials.number(&PathMaterial::is_white);
    const V ior = materials.number(&PathMaterial::ior);
    const M outside = hn::Gt(side, zero);
    const auto either = [&](U a, U b)
                            HWY_ATTR { return hn::IfThenElse(hn::RebindMask(du, outside), a, b); };
    const U entering = materials.whole(&PathMaterial::entering);
    const U leaving = materials.whole(&PathMaterial::leaving);
    Lobes lobes = {.diffuse = base * hn::Mul(opaque, materials.number(&PathMaterial::diffuse)),
                   .mirror = base * metallic + mirror,
                   .mirror_edge = hn::Add(metallic, largest(mirror)),
                   .coat = specular * opaque,
                   .cover = largest(specular),
                   .glass = hn::Mul(rest, transmission),
                   .tint = base + (set3(d, Rgb(1)) - base) * white,
                   .roughness = roughness,
                   .ior = ior,
                   .eta = hn::IfThenElse(outside, ior, hn::Div(one, ior)),
                   .thin = hn::Gt(materials.number(&PathMaterial::is_thin), zero),
                   .conductor = materials.whole(&PathMaterial::conductor),
                   .reflection = materials.whole(&PathMaterial::reflection),
                   .front = either(entering, leaving),
                   .back = either(leaving, entering),
                   .clearcoat = zero,
                   .clearcoat_roughness = zero,
                   .clearcoat_normal = set3(d, Vec3f(0, 0, 1)),
                   .sheen = set3(d, Rgb()),
                   .sheen_roughness = zero,
                   .layers = hn::Zero(du)};
    if (path_.any_layers) add_layers(materials, outside, lobes);
    return lobes;
  }

  // Inside solid glass, the surface has none.
  static HWY_INLINE void add_layers(const Materials& materials, M outside, Lobes& lobes) {
    const V zero = hn::Zero(d);
    const M above = hn::Or(hn::Or(outside, lobes.thin), hn::Eq(lobes.glass, zero));
    const auto either = [&](uint32_t PathMaterial::* member, U& other) HWY_ATTR {
      other = hn::IfThenElse(hn::RebindMask(du, above), other, materials.whole(member));
    };
    lobes.clearcoat = hn::IfThenElseZero(above, materials.number(&PathMaterial::clearcoat));
    lobes.clearcoat_roughness = materials.number(&PathMaterial::clearcoat_roughness);
    lobes.sheen = select(above, materials.color(&PathMaterial::sheen), set3(d, Rgb()));
    lobes.sheen_roughness = materials.number(&PathMaterial::sheen_roughness);
    lobes.layers = materials.whole(&PathMaterial::layers);
    either(&PathMaterial::inner_conductor, lobes.conductor);
    either(&PathMaterial::inner_reflection, lobes.reflection);
    either(&PathMaterial::inner_entering, lobes.back);
  }

  void scale_by_textures(const Wavefront& w, const Materials& materials, size_t i, V& metallic,
                         V& roughness, V& transmission) const {
    HWY_ALIGN float scale[3][kWidth];
    bool any = false;
    for (size_t k = 0; k < kWidth; ++k) {
      const PathMaterial& m = materials[k];
      scale[0][k] = scale[1][k] = scale[2][k] = 1;
      if (m.metallic_roughness_texture != kNoTexture) {
        const Rgb texel = texture_at(w, i + k, m.metallic_roughness_texture, texture_value);
        scale[0][k] = texel.z, scale[1][k] = texel.y, any = true;
      }
      if (m.transmission_texture != kNoTexture)
        scale[2][k] = texture_at(w, i + k, m.transmission_texture, texture_value).x, any = true;
    }
    if (!any) return;
    metallic = hn::Mul(metallic, hn::Load(d, scale[0]));
    roughness = hn::Mul(roughness, hn::Load(d, scale[1]));
    transmission = hn::Mul(transmission, hn::Load(d, scale[2]));
  }

  // One light for each of rays i, i + 1, ...
  LightRays sample_lights(const Wavefront& w, size_t i, size_t n, const WideSampler<D>& sampler,
                          U place, U branch) {
    using Kind = PathLights::Choice::Kind;
    const SurfacePoints& v = w.points();
    const V3 from = load(v.outside, i);
    const Wide2<D> square = sampler.in_square(place, branch, kLightPoint);
    HWY_ALIGN float u[kWidth], probability[kWidth] = {};
    hn::Store(sampler.in_unit(place, branch, kLightChoice), d, u);
    const size_t lanes = std::min(kWidth, n - i);
    for (size_t k = 0; k < lanes; ++k) {
      const Vec3f point(v.outside.x.at[i + k], v.outside.y.at[i + k], v.outside.z.at[i + k]);
      choices_[k] = lights_.choose(point, Vec3f(), u[k]);
      probability[k] = choices_[k].probability;
      groups_.at[i + k] = float(group_of(choices_[k].kind));
    }
    LightRays all{set3(d, Vec3f(0, 0, 1)), set3(d, Rgb()), hn::Zero(d), hn::Zero(d)};
    const V chosen = hn::Load(d, probability);
    // Lanes with the same light are sampled together.
    uint32_t left = (1u << lanes) - 1;
    while (left) {
      const PathLights::Choice& first = choices_[std::countr_zero(left)];
      HWY_ALIGN uint32_t same[kWidth] = {};
      uint32_t taken = 0;
      const bool is_triangle = first.kind == Kind::triangle;
      for (size_t k = 0; k < lanes; ++k)
        if ((left >> k & 1) && choices_[k].kind == first.kind &&
            (is_triangle || choices_[k].index == first.index))
          same[k] = ~0u, taken |= 1u << k;
      left &= ~taken;
      if (first.kind == Kind::none) continue;
      const M mask = hn::RebindMask(d, hn::Ne(hn::Load(du, same), hn::Zero(du)));
      const LightRays some = first.kind == Kind::environment ? to_environment(square, chosen)
                             : is_triangle ? to_triangles(choices_, taken, from, square, chosen)
                                           : to_light(first, from, square, chosen);
      all.dir = select(mask, some.dir, all.dir);
      all.radiance = select(mask, some.radiance, all.radiance);
      all.length = hn::IfThenElse(mask, some.length, all.length);
      all.pdf = hn::IfThenElse(mask, some.pdf, all.pdf);
    }
    return all;
  }

  LightRays to_light(const PathLights::Choice& choice, const V3& from, const Wide2<D>& square,
                     V chosen) const {
    const bool is_near = choice.kind == PathLights::Choice::Kind::near;
    const SampledLight& light = (is_near ? lights_.near() : lights_.distant())[choice.index];
    const LightSample to = sample_light(light, from, square);
    return {to.dir, set3(d, light.emission) * hn::Div(to.part, chosen), to.length, hn::Zero(d)};
  }

  LightRays to_environment(const Wide2<D>& square, V chosen) const {
    const EnvironmentSampler::Sample to = environment_sampler_->sample(square);
    const V zero = hn::Zero(d), density = hn::Mul(to.density, chosen);
    const V inverse = hn::IfThenElseZero(hn::Gt(density, zero), hn::Div(hn::Set(d, 1), density));
    return {to.dir, surrounding(to.dir) * inverse,
            hn::Set(d, std::numeric_limits<float>::infinity()), density};
  }

  LightRays to_triangles(const PathLights::Choice* choices, uint32_t lanes, const V3& from,
                         const Wide2<D>& square, V chosen) const {
    // Heitz 2019, "A Low-Distortion Map Between Triangle and Square".
    const V half = hn::Set(d, 0.5f), zero = hn::Zero(d), one = hn::Set(d, 1);
    const M upper = hn::Gt(square.y, square.x);
    const V least = hn::Mul(hn::Min(square.x, square.y), half);
    const V most = hn::Sub(hn::Max(square.x, square.y), least);
    const V b1 = hn::IfThenElse(upper, least, most), b2 = hn::IfThenElse(upper, most, least);
    enum : uint8_t { kCorner, kEdge1, kEdge2, kNormal, kEmission, kVectors };
    HWY_ALIGN float at[kVectors][3][kWidth] = {}, area[kWidth] = {}, two_sided[kWidth] = {};
    HWY_ALIGN float clearcoat[kWidth] = {};
    HWY_ALIGN uint32_t layers[kWidth] = {};
    HWY_ALIGN float b[2][kWidth];
    hn::Store(b1, d, b[0]), hn::Store(b2, d, b[1]);
    for (uint32_t left = lanes; left; left &= left - 1) {
      const auto k = size_t(std::countr_zero(left));
      const TriangleLight& t = lights_.triangles()[choices[k].index];
      const Vec3f* const vectors[kVectors] = {&t.corner, &t.edge1, &t.edge2, &t.normal,
                                              &t.emission};
      for (size_t j = 0; j < kVectors; ++j)
        for (size_t c = 0; c < 3; ++c) at[j][c][k] = (*vectors[j])[int(c)];
      area[k] = t.area, two_sided[k] = t.is_two_sided;
      if (path_.any_layers) {
        const PathMaterial& material = path_.materials[t.material];
        clearcoat[k] = material.clearcoat, layers[k] = material.layers;
      }
      const float opacity =
          triangle_opacity_at(scene_.scene, *t.geometry, t.triangle, b[0][k], b[1][k]);
      Rgb part(opacity);
      if (t.emission_texture != kNoTexture)
        part = part * texture_color(scene_.scene, t.emission_texture,
                                    texture_coordinates(*t.geometry, t.triangle, b[0][k], b[1][k]));
      for (size_t c = 0; c < 3; ++c) at[kEmission][c][k] *= part[int(c)];
    }
    const auto vector = [&](size_t j) HWY_ATTR {
      return V3{hn::Load(d, at[j][0]), hn::Load(d, at[j][1]), hn::Load(d, at[j][2])};
    };
    const V3 to = vector(kCorner) + vector(kEdge1) * b1 + vector(kEdge2) * b2 - from;
    const V squared_distance = dot(to, to), distance = hn::Sqrt(squared_distance);
    const V3 dir = to * hn::IfThenElseZero(hn::Gt(distance, zero), hn::Div(one, distance));
    V cosine = hn::Neg(dot(dir, vector(kNormal)));
    cosine = hn::IfThenElse(hn::Gt(hn::Load(d, two_sided), zero), hn::Abs(cosine), cosine);
    const V facing = hn::Mul(cosine, hn::Load(d, area));
    const M seen = hn::Gt(facing, zero);
    const V density = hn::IfThenElseZero(seen, hn::Div(hn::Mul(squared_distance, chosen), facing));
    const V inverse = hn::IfThenElseZero(hn::Gt(density, zero), hn::Div(one, density));
    // Ends just short of the light, by the possible rounding of point and direction.
    const V length = hn::Mul(distance, hn::Set(d, 1 - 16 * std::numeric_limits<float>::epsilon()));
    V3 radiance = vector(kEmission) * inverse;
    if (path_.any_layers)
      radiance = radiance * through_coat(hn::Load(d, clearcoat), hn::Load(du, layers), cosine);
    return {dir, radiance, length, density};
  }

  const PreparedScene& scene_;
  const PathScene& path_;
  const PathLights& lights_;
  const bool has_groups_;  // the film has light groups
  std::optional<EnvironmentLight> environment_;
  std::optional<EnvironmentSampler> environment_sampler_;
  PathLights::Choice choices_[kWidth];  // of lights, for some of the current rays
  // Of the current rays: the light of shadow rays, and their children. `across`: the cosine with
  // the geometric normal; 0: none.
  Floats3 direct_, origin_, dir_, weight_;
  Floats pdf_, across_;
  Floats groups_;  // of the lights of shadow rays, if there are any
};

}  // namespace

std::unique_ptr<Shading> make_path_shading(const PreparedScene& scene) {
  return std::make_unique<PathShading>(scene);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

// No limit is sure, since surfaces concentrate light. This one leaves room for that; the film's
// unit is still below a hundred-millionth of the brightest light.
double path_bound(const Scene& scene, const RenderSettings& settings) {
  constexpr double kRoom = 4096;
  constexpr double kNear = 1e4;  // from where point lights stop to increase to a tenth of the scene
  const double sky = max_component(settings.figure.sky_light) *
                     (scene.environment.empty() ? 1 : brightest_texel(scene));
  double brightest = std::max({1.0, double(max_component(settings.background)), sky});
  for (const StandardSurface& s : scene.standard_surfaces)
    if (s.is_standard) brightest = std::max(brightest, double(max_component(s.emission)));
  for (const SampledLight& light : sampled_lights(scene, settings.camera))
    brightest = std::max(brightest, light.brightest() / std::numbers::pi /
                                        (light.decreases && !light.is_distant ? kNear : 1));
  return kRoom * brightest;
}

}  // namespace raio::core
#endif
