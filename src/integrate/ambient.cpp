#include "integrate/ambient.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "integrate/ambient.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include "integrate/environment-inl.h"
#include "integrate/features-inl.h"
#include "integrate/lights-inl.h"
#include "integrate/optics-inl.h"
#include "integrate/shading-inl.h"
#include "integrate/shadings-inl.h"
#include "integrate/sky-inl.h"
#include "scene/columns.h"

HWY_BEFORE_NAMESPACE();
namespace raio::core::HWY_NAMESPACE {
namespace {

class AmbientShading final : public Shading {
 public:
  explicit AmbientShading(const PreparedScene& scene)
      : scene_(scene),
        figure_(scene.settings.figure),
        look_(params_of(figure_.look)),
        outline_(figure_.outline * scene.settings.line_scale() * (look_.turns ? kTurningReach : 1)),
        occlusion_sampler_(scene.sampler) {
    if (!scene.scene.environment.empty()) environment_.emplace(scene.scene);
    occlusion_sampler_.kind =
        SamplerKind::sobol;  // one sequence per pixel, split among its samples
    // Lines contrast with the background or, if that is omitted, with the style's.
    const bool is_open =
        scene.settings.channels.has(Channel::alpha) && scene.settings.background == Rgb();
    const Rgb ground = is_open ? look_.background : scene.settings.background;
    if (max_component(ground) < 0.1f) line_color_ = Rgb(0.7f);
    const SampledLight key = key_light(scene.eye, scene.forward, look_);
    to_key_ = key.position, key_u_ = key.edge_u, key_v_ = key.edge_v;
    if (outline_ == 0) return;
    if (scene.scene.moves()) crease_rays_.add_time();
    crease_rays_.resize(kChunk + kWidth), crease_hits_.reset(kChunk + kWidth);
    around_ = std::make_unique_for_overwrite<SurfacePoints>();
  }

  Rgb background() const override { return scene_.settings.background; }
  bool has_sky() const override {
    return scene_.settings.sky != nullptr || scene_.settings.sees_environment;
  }
  V3 sky(const V3& dir) const override {
    return scene_.settings.sees_environment ? environment_->radiance(dir)
                                            : sky_towards(*scene_.settings.sky, dir);
  }

  void shade(Wavefront& w, int, size_t n, const WideSampler<D>& sampler) override {
    SurfacePoints& v = w.points();
    for (size_t i = 0; i < n; i += kWidth) store(set3(d, Rgb()), v.radiance, i);
    if (outline_ > 0) find_outlines(w, n, sampler.sample());
    if (w.stopped()) return;
    const bool physical = figure_.key_light == KeyLight::scene;
    if (look_.soft > 0 && !physical) soften(w, n);
    add_sky_light(w, n, sampler.sample(), figure_.sky_light,
                  environment_ ? &*environment_ : nullptr);
    if (physical) add_scene_lights(w, n, sampler);
    if (has_key_light()) add_key_light(w, n, sampler, look_.highlight);
    if (scene_.extent > 0) fade(w, n);
    for (size_t i = 0; outline_ > 0 && i < n; ++i)
      if (on_line_[i] != 0) v.radiance.set(i, line_color_);
  }

  // The shadows on a floor that only eye rays hit. Eye rays that hit nothing else get the
  // background, darkened by the shadows, or, with a transparent background, the coverage of the
  // shadows.
  bool shade_misses(Wavefront& w, int level, bool transparent,
                    const WideSampler<D>& sampler) override {
    if (level > 1 || scene_.floor_distance <= 0) return false;
    PathRays& rays = w.rays();
    const size_t n = rays.rays.size();
    others_.use_columns_of(rays);
    std::swap(others_, rays), std::swap(other_hits_, w.hits());
    rays.resize(n), w.hits().reset(n);
    size_t missed = 0, met = 0;
    for (const bool on_floor : {true, false}) {
      for (size_t i = 0; i < n; ++i) {
        if (other_hits_.primitive[i] != kNoPrimitive) continue;
        const float t = floor_distance(others_.rays[i]);
        if ((t > 0) != on_floor) continue;
        w.hits().t[missed] = t;
        rays.set(missed++, others_, i);
      }
      if (on_floor) met = missed;
    }
    rays.rays.resize(missed);
    w.fill_up(missed);
    w.set_times(rays.rays);
    Floats& dark = w.points().kd;
    std::fill_n(dark.at, missed + kWidth, 0.0f);
    if (met > 0) {
      rays.rays.resize(met);
      shade_floor(w, met, sampler);
      if (w.stopped()) return true;
      std::fill(dark.at + met, dark.at + missed + kWidth, 0.0f);
      rays.rays.resize(missed);
    }
    std::vector<int64_t> coverage(transparent ? padded(missed) : 0);
    for (size_t i = 0; i < missed; i += kWidth) {
      const uint32_t* const pixels = &rays.pixel[i];
      const M mask = hn::FirstN(d, missed - i);
      if (transparent) {
        for (size_t k = i; k < std::min(i + kWidth, missed); ++k)
          coverage[k] = covered(rays.weight[0][k] * dark.at[k]);
        w.sums().add(set3(d, Rgb()), pixels, mask, &coverage[i]);
      } else {
        const V left = hn::Sub(hn::Set(d, 1), load(dark, i));
        w.add_escaped(rays.weights(i) * left, directions(rays.rays, i), pixels, mask);
      }
    }
    std::swap(others_, rays), std::swap(other_hits_, w.hits());
    return true;
  }

 private:
  bool has_key_light() const { return figure_.key_light == KeyLight::on && look_.key > 0; }

  // The distance of the floor; 0: the ray does not hit it.
  float floor_distance(const Ray& ray) const {
    const float height = dot(ray.origin, scene_.floor_normal) - scene_.floor_height;
    const float t = -height / dot(ray.dir, scene_.floor_normal);
    return height > 0 && t > 0 && t < scene_.floor_distance ? t : 0;
  }
  // Sets points().kd to the part of the light that shadows on a white floor take away.
  void shade_floor(Wavefront& w, size_t n, const WideSampler<D>& sampler) {
    SurfacePoints& v = w.points();
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    const V3 normal = set3(d, scene_.floor_normal), black = set3(d, Rgb());
    for (size_t i = 0; i < n; i += kWidth) {
      const RayBatch& rays = w.rays().rays;
      const V3 point = origins(rays, i) + directions(rays, i) * load(w.hits().t, i);
      const V scale = hn::Max(hn::Abs(point.x), hn::Max(hn::Abs(point.y), hn::Abs(point.z)));
      store(point, v.point, i), store(offset_point(point, normal, scale, true), v.outside, i);
      store(normal, v.normal, i), store(normal, v.geometric, i);
      store(set3(d, Rgb(1)), v.color, i), store(one, v.kd, i), store(black, v.radiance, i);
      hn::Store(zero, d, &rim_[i]), hn::Store(zero, d, &on_line_[i]);
    }
    const float sky = max_component(figure_.sky_light);
    const bool key = has_key_light();
    add_sky_light(w, n, sampler.sample(), Rgb(sky), nullptr);
    if (key) add_key_light(w, n, sampler, 0);
    if (w.stopped()) return;
    for (size_t i = 0; i < n; i += kWidth) {
      V all = hn::Set(d, sky);
      if (key) {
        const V cosine = hn::Max(dot(normal, directions(w.shadow_rays(), i)), zero);
        all = hn::Add(all, hn::Mul(hn::Set(d, look_.key), cosine));
      }
      V dark = hn::Sub(one, hn::Div(load(v.radiance, i).x, all));
      if (scene_.extent > 0) dark = hn::Mul(dark, hn::Sub(one, depth_cue(load(v.point, i))));
      // Smaller values are rounding errors of the sums: outside shadows, the background stays
      // exact.
      dark = hn::IfThenElseZero(hn::Gt(dark, hn::Set(d, 1e-5f)), hn::Min(dark, one));
      store(dark, v.kd, i);
    }
  }

  // The colours of StyleParams::soft, and the sky mirrored by dark surfaces.
  void soften(Wavefront& w, size_t n) {
    SurfacePoints& v = w.points();
    const V one = hn::Set(d, 1), zero = hn::Zero(d);
    const V soft = hn::Set(d, look_.soft), rim = hn::Set(d, look_.rim);
    for (size_t i = 0; i < n; i += kWidth) {
      const V3 color = load(v.color, i);
      const V brightest = hn::Min(hn::Max(color.x, hn::Max(color.y, color.z)), one);
      store(color * hn::Sub(one, hn::Mul(soft, brightest)), v.color, i);
      const V facing = hn::Abs(dot(load(v.normal, i), directions(w.rays().rays, i)));
      const V aside = hn::Max(hn::Sub(one, facing), zero), black = hn::Sub(one, brightest);
      hn::Store(hn::Mul(hn::Mul(rim, hn::Mul(black, black)), hn::Mul(aside, aside)), d, &rim_[i]);
    }
  }

  // Sky light, by rays with a cosine-weighted density: each unoccluded one contributes equally.
  // Shirley and Chiu's disc, projected onto the hemisphere after Malley.
  void add_sky_light(Wavefront& w, size_t n, uint32_t sample, Rgb radiance,
                     const EnvironmentLight* environment) {
    if (radiance == Rgb()) return;
    SurfacePoints& v = w.points();
    const auto rays_each = uint32_t(figure_.occlusion_rays);
    const V3 share = set3(d, radiance / float(rays_each));
    const V one = hn::Set(d, 1);
    const V zero = hn::Zero(d);
    const V tmax =
        hn::Set(d, figure_.occlusion_distance > 0 ? figure_.occlusion_distance
                                                  : std::numeric_limits<float>::infinity());
    for (uint32_t k = 0; k < rays_each && !w.stopped(); ++k) {
      const WideSampler<D> sampler(occlusion_sampler_, sample * rays_each + k);
      RayBatch& rays = w.shadow_rays();
      rays.resize(n);
      for (size_t i = 0; i < n; i += kWidth) {
        const Wide2<D> square = sampler.in_square(w.place_of(load(w.rays().pixel, i)),
                                                  load(w.rays().branch, i), kOcclusion);
        const Wide2<D> disc = square_to_disc(d, square.x, square.y);
        const V r2 = hn::Add(hn::Mul(disc.x, disc.x), hn::Mul(disc.y, disc.y));
        const V up = hn::Sqrt(hn::Max(hn::Sub(one, r2), zero));
        const V3 normal = load(v.normal, i), geometric = load(v.geometric, i);
        const WideFrame frame(normal);
        V3 dir = frame.u * disc.x + frame.v * disc.y + normal * up;
        // A smooth normal may tilt: directions into the surface are mirrored out of it.
        const V across = dot(dir, geometric);
        const V3 out = dir - geometric * hn::Add(across, across);
        dir = select(hn::Lt(across, zero), out, dir);
        put_ray(rays, i, load(v.outside, i), dir, tmax, lit_lanes(i, n));
      }
      add_lit(w, n, sampler, kSkyDepth, [&](size_t i, V lit) HWY_ATTR {
        V3 light = share * lit;
        if (environment) light = light * environment->radiance(directions(rays, i));
        return load(v.color, i) * (light * load(v.kd, i)) + light * hn::Load(d, &rim_[i]);
      });
    }
  }

  // A distant disc: diffuse light and a highlight after Blinn.
  void add_key_light(Wavefront& w, size_t n, const WideSampler<D>& sampler, float highlight) {
    SurfacePoints& v = w.points();
    const V zero = hn::Zero(d), inf = hn::Set(d, std::numeric_limits<float>::infinity());
    RayBatch& rays = w.shadow_rays();
    rays.resize(n);
    for (size_t i = 0; i < n; i += kWidth) {
      const Wide2<D> square = sampler.in_square(w.place_of(load(w.rays().pixel, i)),
                                                load(w.rays().branch, i), kKeyLight);
      const Wide2<D> disc = square_to_disc(d, square.x, square.y);
      const V3 dir =
          normalize(d, set3(d, to_key_) + set3(d, key_u_) * disc.x + set3(d, key_v_) * disc.y);
      const M facing =
          hn::And(lit_lanes(i, n), hn::And(hn::Gt(dot(load(v.normal, i), dir), zero),
                                           hn::Gt(dot(load(v.geometric, i), dir), zero)));
      put_ray(rays, i, load(v.outside, i), dir, inf, facing);
    }
    const V key = hn::Set(d, look_.key), one = hn::Set(d, 1);
    add_lit(w, n, sampler, kKeyDepth, [&](size_t i, V lit) HWY_ATTR {
      const V3 dir = directions(rays, i), normal = load(v.normal, i);
      const V diffuse = hn::Mul(hn::Mul(key, load(v.kd, i)), dot(normal, dir));
      V3 light = load(v.color, i) * hn::Mul(lit, diffuse);
      if (highlight > 0) {
        const V cosine = dot(normal, normalize(d, dir - directions(w.rays().rays, i)));
        const V power = pow_unit(d, hn::Min(hn::Max(cosine, zero), one), hn::Set(d, look_.shine));
        const V much = hn::Mul(hn::Mul(lit, hn::Set(d, highlight)), power);
        light = light + V3{much, much, much};
      }
      return light;
    });
  }

  // The scene's lights on diffuse surfaces with the highlight of Blinn, normalized as in
  // Akenine-Moeller et al., Real-Time Rendering.
  void add_scene_lights(Wavefront& w, size_t n, const WideSampler<D>& sampler) {
    SurfacePoints& v = w.points();
    const V zero = hn::Zero(d);
    for (size_t i = 0; i < n; ++i) v.specular.set(i, scene_.scene.specular_of(v.material[i]));
    for (uint32_t l = 0; l < scene_.lights.size() && !w.stopped(); ++l) {
      const SampledLight& light = scene_.lights[l];
      RayBatch& rays = w.shadow_rays();
      rays.resize(n);
      for (size_t i = 0; i < n; i += kWidth) {
        const Wide2<D> square = sampler.in_square(w.place_of(load(w.rays().pixel, i)),
                                                  load(w.rays().branch, i), kLight + l);
        const V3 outside = load(v.outside, i);
        const LightSample to = sample_light(light, outside, square);
        const V part = hn::Mul(to.part, dot(load(v.normal, i), to.dir));
        hn::Store(part, d, &irradiance_[i]);
        const M facing =
            hn::And(hn::Gt(part, zero), hn::Gt(dot(load(v.geometric, i), to.dir), zero));
        put_ray(rays, i, outside, to.dir, to.length, hn::And(lit_lanes(i, n), facing));
      }
      add_lit(w, n, sampler, Purpose(kLightDepth + l), [&](size_t i, V lit) HWY_ATTR {
        const V3 irradiance = set3(d, light.emission) * hn::Mul(lit, hn::Load(d, &irradiance_[i]));
        constexpr auto kPi = float(std::numbers::pi);
        V3 reflected = load(v.color, i) * hn::Mul(load(v.kd, i), hn::Set(d, 1 / kPi));
        const V ks = load(v.ks, i);
        if (!hn::AllFalse(d, hn::Gt(ks, zero))) {
          const V3 half = halfway(directions(rays, i), directions(w.rays().rays, i));
          const V shine = load(v.shine, i), eight = hn::Set(d, 8);
          const V scale = hn::Mul(hn::Add(shine, eight), hn::Set(d, 1 / (8 * kPi)));
          const V lobe = hn::Mul(scale, highlight_power(dot(load(v.normal, i), half), shine));
          reflected = reflected + load(v.specular, i) * hn::Mul(ks, lobe);
        }
        return irradiance * reflected;
      });
    }
  }

  // Fades into the background with depth.
  void fade(Wavefront& w, size_t n) const {
    SurfacePoints& v = w.points();
    const V one = hn::Set(d, 1);
    const V3 background = set3(d, scene_.settings.background);
    for (size_t i = 0; i < n; i += kWidth) {
      const V part = depth_cue(load(v.point, i));
      store(load(v.radiance, i) * hn::Sub(one, part) + background * part, v.radiance, i);
    }
  }

  // The fraction of the background at the points.
  HWY_INLINE V depth_cue(const V3& point) const {
    const V depth = depth_of(scene_, point);
    const V far = hn::Div(hn::Sub(depth, hn::Set(d, scene_.nearest)), hn::Set(d, scene_.extent));
    return hn::Mul(hn::Min(hn::Max(far, hn::Zero(d)), hn::Set(d, 1)),
                   hn::Set(d, figure_.depth_cue));
  }

  // Four points of a circle, rotated per sample, reach as far over all edge directions as eight if
  // this much larger.
  static constexpr float kTurningReach = 1.0823922f;
  // The rotation of the circle's points for a sample: cosine and sine of sixteenths of a right
  // angle, far from those of the previous samples.
  static std::array<float, 2> turn_of(uint32_t sample) {
    static constexpr float kTurns[16][2] = {
        {1, 0},
        {0.707106781f, 0.707106781f},
        {0.923879533f, 0.382683432f},
        {0.382683432f, 0.923879533f},
        {0.980785280f, 0.195090322f},
        {0.555570233f, 0.831469612f},
        {0.831469612f, 0.555570233f},
        {0.195090322f, 0.980785280f},
        {0.995184727f, 0.098017140f},
        {0.634393284f, 0.773010453f},
        {0.881921264f, 0.471396737f},
        {0.290284677f, 0.956940336f},
        {0.956940336f, 0.290284677f},
        {0.471396737f, 0.881921264f},
        {0.773010453f, 0.634393284f},
        {0.098017140f, 0.995184727f},
    };
    // Samples in one column of cells get different rotations.
    const auto& [c, s] = kTurns[(sample + 7 * (sample / 16)) % 16];
    return {c, s};
  }

  // Feature lines after Choudhury and Parker 2009, "Ray Tracing NPR-Style Feature Lines", NPAR: a
  // sample is on a line if rays through a circle around it in the picture hit something else. Of
  // two adjacent surfaces the nearer one has the line. Transparent surfaces have none.
  void find_outlines(Wavefront& w, size_t n, uint32_t sample) {
    static constexpr float kDiagonal = 0.70710678f;
    // Opposite points first: they decide most samples.
    static constexpr float kCircle[8][2] = {{1, 0},
                                            {-1, 0},
                                            {0, 1},
                                            {0, -1},
                                            {kDiagonal, kDiagonal},
                                            {-kDiagonal, -kDiagonal},
                                            {-kDiagonal, kDiagonal},
                                            {kDiagonal, -kDiagonal}};
    const Geometry& geometry = scene_.accel.geometry();
    // Samples that cannot be on a line also count as decided.
    std::array<float, kChunk + kWidth> decided{};
    for (size_t i = 0; i < n; ++i) {
      on_line_[i] = 0;
      const Hit hit = w.hits()[i];
      decided[i] = geometry.object_at(hit.instance).depth_of(hit.primitive) != kOpaque;
    }
    const bool parallel = scene_.eye.parallel, everywhere = scene_.eye.omnidirectional;
    const float pixel = length(scene_.eye.per_y);
    const auto [c, s] = look_.turns ? turn_of(sample) : std::array{1.0f, 0.0f};
    for (const auto& [x, y] : std::span(kCircle).first(look_.turns ? 4 : 8)) {
      RayBatch& rays = w.probe_rays();
      rays.resize(n);
      const float right = (x * c - y * s) * outline_, down = (x * s + y * c) * outline_;
      const V3 aside = set3(d, scene_.eye.per_x * right + scene_.eye.per_y * down);
      for (size_t i = 0; i < n; i += kWidth) {
        const V3 origin = origins(w.rays().rays, i), dir = directions(w.rays().rays, i);
        const M open = hn::Eq(hn::LoadU(d, &decided[i]), hn::Zero(d));
        V3 shift = aside;
        if (everywhere) {
          const WideFrame frame(dir);
          shift = frame.u * hn::Set(d, right * pixel) + frame.v * hn::Set(d, down * pixel);
        } else if (!parallel) {
          shift = aside * hn::Max(dot(dir, set3(d, scene_.forward)), hn::Set(d, 1e-6f));
        }
        put_ray(rays, i, parallel ? origin + shift : origin,
                parallel ? dir : normalize(d, dir + shift),
                hn::Set(d, std::numeric_limits<float>::infinity()),
                hn::And(open, hn::FirstN(d, n - i)));
      }
      w.probe();
      if (w.stopped()) return;
      find_lines(w, n, decided);
      for (size_t i = 0; i < n; ++i) decided[i] = std::max(decided[i], on_line_[i]);
    }
  }

  // Whether a line runs between samples and the hits of their probes at one side.
  void find_lines(Wavefront& w, size_t n, const std::array<float, kChunk + kWidth>& decided) {
    const SurfacePoints& v = w.points();
    const Geometry& geometry = scene_.accel.geometry();
    const RayBatch& rays = w.probe_rays();
    const float pixel = length(scene_.eye.per_y);
    size_t creases = 0;
    for (size_t i = 0; i < n; ++i) {
      if (decided[i] != 0) continue;
      const Hit here = w.hits()[i], hit = w.probed()[i];
      if (here.primitive == hit.primitive && here.instance == hit.instance) continue;
      const Vec3f point = at(v.point, i);
      const Ray ray = rays[i];
      const Vec3f other = ray.origin + ray.dir * hit.t;
      // The growth of a pixel with distance.
      const Vec3f forward = scene_.eye.omnidirectional ? w.rays().rays[i].dir : scene_.forward;
      const float depth = scene_.eye.parallel ? 1 : dot(point - scene_.eye.from, forward);
      const float behind = dot(other - point, forward);
      const float step =
          4 * outline_ * pixel * depth;  // the maximum step within a surface, as a slope
      const bool flat = PrimitiveKind(v.kind[i]) == PrimitiveKind::triangle;
      if (!hit.found() || (behind > step && !flat)) {
        on_line_[i] = 1;
      } else if (behind >= -step && !geometry.same_object(here, hit)) {
        on_line_[i] = behind > 0;
      } else if (behind > step) {
        on_line_[i] = dot(other - point, at(v.normal, i)) < -step / 4;
      } else if (behind >= -step && std::pair(here.instance, here.primitive) <
                                        std::pair(hit.instance, hit.primitive)) {
        crease_rays_.set(creases, ray), crease_hits_.set(creases, hit);
        crease_of_[creases++] = uint32_t(i);
      }
    }
    // Where two surfaces meet at an angle, the one with the lower number has the line.
    if (creases == 0) return;
    for (size_t i = creases; i % kWidth != 0; ++i)
      crease_rays_.set(i, crease_rays_[creases - 1]),
          crease_hits_.set(i, crease_hits_[creases - 1]);
    find_surfaces(geometry, scene_.scene, crease_rays_, crease_hits_, creases, *around_);
    for (size_t k = 0; k < creases; ++k)
      on_line_[crease_of_[k]] = dot(at(v.normal, crease_of_[k]), at(around_->normal, k)) < 0.5f;
  }

  static Vec3f at(const Floats3& f, size_t i) { return {f.x.at[i], f.y.at[i], f.z.at[i]}; }

  // The first `n` lanes from i that receive light, since they are not on a line.
  HWY_INLINE M lit_lanes(size_t i, size_t n) const {
    return hn::And(hn::FirstN(d, n - i), hn::Eq(hn::Load(d, &on_line_[i]), hn::Zero(d)));
  }

  const PreparedScene& scene_;
  FigureSettings figure_;
  StyleParams look_;
  float outline_;  // radius of the circle, pixels
  Sampler occlusion_sampler_;
  std::optional<EnvironmentLight> environment_;
  Vec3f to_key_, key_u_, key_v_;
  Rgb line_color_;  // contrasts with the background
  // For current rays: whether they are on a line. For undecided probes, which need normals: rays,
  // hits, surfaces, and the current ray they belong to.
  alignas(64) float on_line_[kChunk + kWidth] = {};
  RayBatch crease_rays_;
  HitBatch crease_hits_;
  std::unique_ptr<SurfacePoints> around_;
  std::array<uint32_t, kChunk> crease_of_{};
  alignas(64) float rim_[kChunk + kWidth] = {};         // of the current rays
  alignas(64) float irradiance_[kChunk + kWidth] = {};  // of their surfaces, by the current light
  PathRays others_;  // the other rays, while the current ones are those without hits
  HitBatch other_hits_;
};

}  // namespace

std::unique_ptr<Shading> make_ambient_shading(const PreparedScene& scene) {
  return std::make_unique<AmbientShading>(scene);
}

}  // namespace raio::core::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace raio::core {

double ambient_bound(const Scene& scene, const RenderSettings& settings) {
  const FigureSettings& figure = settings.figure;
  const StyleParams look = params_of(figure.look);
  const double environment = scene.environment.empty() ? 1 : brightest_texel(scene);
  const double sky = max_component(figure.sky_light) * environment;
  double lights = 0;  // irradiance
  if (figure.key_light == KeyLight::scene)
    for (const SampledLight& light : sampled_lights(scene, settings.camera))
      lights += light.brightest();
  const double light = sky + look.key + lights / std::numbers::pi;
  const float own_color = brightest_color(scene);  // may override a material's
  const float tint = brightest_tint(scene);
  double surface = 0, lobe = 0;
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    surface = std::max(surface, double(m.kd) * std::max(max_component(m.color), own_color) * tint);
    lobe = std::max(lobe, double(m.ks) * max_component(scene.specular_of(MaterialId(i))) *
                              (double(m.shine) + 8) / (8 * std::numbers::pi));
  }
  double background = max_component(settings.background);
  if (settings.sky) background = double(settings.sky->largest) / 255;
  if (settings.sees_environment) background = environment;
  return background +
         std::max(light * surface + lights * lobe + look.highlight + look.rim * std::max(sky, 1.0),
                  1.0);
}

}  // namespace raio::core
#endif
