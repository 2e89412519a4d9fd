// Resolves options for a scene, and finds those that cannot be combined.
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "integrate/classic.h"
#include "io/plain_scene.h"
#include "render/figure_options.h"
#include "render/options.h"
#include "render/picture_options.h"

namespace raio::core {
namespace {

constexpr int kUsualPathDepth = 16;

bool shows_rays(const RenderOptions& options) {
  return options.view != View::picture && options.view != View::samples;
}

// The integrator, unless it depends on the scene.
std::optional<IntegratorKind> selected_integrator(const RenderOptions& options) {
  if (!options.integrator && shows_rays(options)) return IntegratorKind::views;
  return options.integrator;
}

}  // namespace

IntegratorKind integrator_of(const RenderOptions& options, const Scene& scene) {
  const bool is_figure = scene.dialect == Dialect::data || !scene.physical_lights.empty();
  // Only paths find the suns of environments by more than chance.
  const bool needs_paths = count_standard_surfaces(scene) > 0 || !scene.environment.empty();
  return selected_integrator(options).value_or(needs_paths ? IntegratorKind::path
                                               : is_figure ? IntegratorKind::ambient
                                                           : IntegratorKind::classic);
}

std::optional<Error> ignored_option(const RenderOptions& options, const Scene* scene) {
  const auto selected = selected_integrator(options);
  if (!selected && !scene) return std::nullopt;
  const IntegratorKind integrator = selected ? *selected : integrator_of(options, *scene);
  for (const OptionSpec& spec : render_option_table()) {
    if (spec.applies_to(integrator) || !spec.is_given(options)) continue;
    const std::string with = selected && !options.integrator
                                 ? fmt::format("`view` {}", view_name(options.view))
                                 : fmt::format("`integrator` {}", integrator_name(integrator));
    return bad_option(spec.name,
                      selected ? fmt::format("has no effect with {}; leave one of them out", with)
                               : fmt::format("has no effect with {}, the default for this scene; "
                                             "leave it out, or add `integrator` {}",
                                             with, fmt::join(names_of(spec.integrators), " or ")));
  }
  return std::nullopt;
}

void drop_ignored_options(RenderOptions& options, const Scene& scene) {
  const IntegratorKind integrator = integrator_of(options, scene);
  for (const OptionSpec& spec : render_option_table())
    if (!spec.applies_to(integrator)) spec.value.reset(options);
  if (fades_into_nothing(options, scene)) options.depth_cue.reset();
}

namespace {

Error without(std::string_view option, std::string_view other) {
  return bad_option(option, fmt::format("has no effect without `{0}`; add `{0}` or leave `{1}` out",
                                        other, option));
}

std::optional<Error> accel_conflict(const RenderOptions& options) {
  const AccelOptions& accel = options.accel;
  const bool resolution = accel.grid_resolution[0] > 0, factor = accel.grid_factor > 0;
  const bool grid = accel.kind == AccelKind::automatic || accel.kind == AccelKind::grid;
  if ((resolution || factor) && !grid)
    return bad_option(resolution ? "grid-resolution" : "grid-factor",
                      fmt::format("has no effect with `accel` {}; leave one of them out",
                                  accel_name(accel.kind)));
  if (accel.kind != AccelKind::embree) return std::nullopt;
  if (accel.counters)
    return bad_option("counters",
                      "Embree does not count tests and steps; leave it or `accel` embree out");
  if (options.view == View::steps || options.view == View::tests)
    return bad_option("view", fmt::format("Embree does not count {}; leave out `accel` embree",
                                          view_name(options.view)));
  for (const Channel channel : {Channel::steps, Channel::tests})
    if (options.channels.has(channel))
      return bad_option("channels",
                        fmt::format("Embree does not count {}; leave them or `accel` embree out",
                                    spec_of(channel).name));
  return std::nullopt;
}

// The samples of a picture with `noise`.
constexpr int kMinSamples = 16, kMaxSamplesOfNoise = 4096;
int min_samples(const RenderOptions& o) {
  return o.min_samples > 0 ? o.min_samples
                           : std::min(kMinSamples, o.max_samples > 0 ? o.max_samples : kMinSamples);
}
int max_samples(const RenderOptions& o) {
  return o.max_samples > 0 ? o.max_samples : std::max(kMaxSamplesOfNoise, o.min_samples);
}

// Checks that need no scene.
std::optional<Error> sample_conflict(const RenderOptions& options) {
  for (const std::string_view limit : {"min-samples", "max-samples"})
    if (options.noise == 0 && option_of(limit).is_given(options)) return without(limit, "noise");
  if (min_samples(options) > max_samples(options))
    return bad_option("min-samples", "is above `max-samples`; give a smaller number");
  if (options.samples == 0 && options.noise == 0) return std::nullopt;
  const std::string_view given = options.noise > 0 ? "noise" : "samples";
  if (options.aa > 1 || (options.noise > 0 && options.lens_samples > 0))
    return bad_option(options.aa > 1 ? "aa" : "lens-samples",
                      fmt::format("cannot be combined with `{}`; leave one of them out", given));
  if (options.sampler == SamplerKind::jitter)
    return bad_option("sampler",
                      fmt::format("jitter takes its cells from `aa` and `lens-samples`; leave out "
                                  "`{}` or `sampler` jitter",
                                  given));
  return std::nullopt;
}

std::optional<Error> filter_conflict(const RenderOptions& options, const RenderSettings& settings) {
  if (options.filter != PixelFilter::blackman_harris || settings.aa != 1) return std::nullopt;
  return bad_option("filter",
                    "blackman-harris needs several samples per pixel, and there is one ray through "
                    "its centre; give `samples` or a larger `aa`");
}

std::optional<Error> size_conflict(const RenderOptions& options, const RenderSettings& settings) {
  if (options.print && (settings.width > kMaxSide || settings.height > kMaxSide))
    return bad_option(
        "dpi",
        fmt::format(
            "a picture of {}x{} pixels is too large, the maximum side is {}; choose a smaller size",
            settings.width, settings.height, kMaxSide));
  return std::nullopt;
}

// Options that need another projection.
std::optional<Error> projection_conflict(const RenderOptions& options, Projection projection) {
  if (projection == Projection::perspective) return std::nullopt;
  const std::string_view name = projection_name(projection);
  const std::string why =
      fmt::format("a lens needs `projection` perspective; leave it or `projection` {} out", name);
  if (options.dof == true) return bad_option("dof", why);
  if (options.aperture > 0) return bad_option("aperture", why);
  if (options.focus > 0) return bad_option("focus", why);
  if (projection == Projection::orthographic) return std::nullopt;
  for (const std::string_view angle : {"fov", "angle-to-centers"})
    if (option_of(angle).is_given(options))
      return bad_option(
          angle, fmt::format("has no effect with `projection` {}; leave one of them out", name));
  return std::nullopt;
}

// Checks that need no scene.
std::optional<Error> fit_conflict(const RenderOptions& options) {
  if (options.fit && (options.from || options.at))
    return bad_option("fit",
                      "cannot be combined with a camera position; leave it or the numbers in "
                      "`from` and `at` out");
  if (options.fit && options.up == Vec3d()) return bad_option("up", "must not be 0");
  if (!options.side) return std::nullopt;
  if (options.at)
    return bad_option("at",
                      "cannot be combined with a side in `from`, where the camera looks at the "
                      "whole scene; give `from` numbers or leave `at` out");
  if (options.up == Vec3d()) return bad_option("up", "must not be 0");
  return std::nullopt;
}

// Light that the picture would leave out.
std::optional<Error> light_conflict(const Scene& scene, const RenderSettings& s) {
  if (s.integrator == IntegratorKind::classic)
    if (const std::string light = text_of(scene, {Feature::physical_lights, Feature::environment});
        !light.empty())
      return bad_option("integrator",
                        fmt::format("classic would leave out {}; choose ambient or path", light));
  if (s.figure.shadow_catcher && s.figure.key_light == KeyLight::scene)
    return bad_option("shadow-catcher",
                      "catches no shadows of `key-light` scene; leave it out, or choose on or off");
  return std::nullopt;
}

std::optional<Error> scene_conflict(const RenderOptions& options, const Scene& scene) {
  for (const Channel group : kLightGroups)
    if (options.channels.has(group) && integrator_of(options, scene) != IntegratorKind::path)
      return bad_option("channels", fmt::format("{} needs the integrator path; add `integrator` "
                                                "path, or leave the channel out",
                                                spec_of(group).name));
  if (options.channels.has(Channel::id) && scene.primitive_count() > kMaxPrimitives)
    return bad_option(
        "channels",
        fmt::format("the scene has more primitives than `id` can number, {}; leave it out",
                    kMaxPrimitives));
  if ((options.side || options.fit) && bounds(scene).empty())
    return bad_option(options.fit ? "fit" : "from",
                      "needs a bounded scene, and this one has only infinite planes; give the "
                      "camera's position in numbers");
  if (const auto why = camera_problem(camera_of(scene, options)); !why.empty())
    return bad_option("", fmt::format("`from`, `at`, `up`: {}", why));
  if (fades_into_nothing(options, scene))
    return bad_option("depth-cue",
                      "fades into a colour; give one as `background`, or leave it out");
  const RenderSettings s = resolve_options(options, scene);
  if (auto why = size_conflict(options, s)) return why;
  if (auto why = filter_conflict(options, s)) return why;
  if (auto why = projection_conflict(options, s.camera.projection)) return why;
  if (auto why = light_conflict(scene, s)) return why;
  if (!s.dof && options.aperture > 0) return without("aperture", "dof");
  if (!s.dof && options.focus > 0) return without("focus", "dof");
  if (options.shutter && !scene.moves())
    return bad_option("shutter", "has no effect on a scene without motion; leave it out");
  const bool no_effects = !s.dof && !s.soft_shadows && s.aa == 1 && !is_rough(scene, s) &&
                          !lights_from_all_sides(s.integrator) &&
                          !(scene.moves() && s.shutter_open < s.shutter_close);
  if (s.denoise != Denoiser::none && s.samples_per_pixel() < 2)
    return bad_option("denoise",
                      "learns the noise from the spread of a pixel's samples, so it needs at least "
                      "two; add `samples` or `aa`, or leave it out");
  if (s.samples > 1 && no_effects)
    return bad_option(s.noise > 0 ? "noise" : "samples",
                      "has no effect with only `aa` 1; add `dof`, `soft-shadows` or `gloss`, or "
                      "leave one of them out");
  if (s.lens_samples > 1 && no_effects)
    return bad_option("lens-samples",
                      "has no effect without `dof`, `soft-shadows`, `gloss` or `aa`; add one of "
                      "them or leave `lens-samples` out");
  if (const double samples = double(s.aa) * s.aa * s.lens_samples; samples > kMaxSamples)
    return bad_option(
        "aa",
        fmt::format(
            "{:.0f} samples per pixel are too many, the maximum is {}; choose a smaller `aa`{}",
            samples, kMaxSamples, s.lens_samples > 1 ? " or `lens-samples`" : ""));
  return std::nullopt;
}

}  // namespace

std::optional<Error> option_conflict(const RenderOptions& options, const Scene* scene,
                                     bool from_file) {
  for (const OptionSpec& spec : render_option_table())
    if (!spec.excludes.empty() && spec.is_given(options) &&
        option_of(spec.excludes).is_given(options))
      return bad_option(
          spec.name,
          fmt::format("cannot be combined with `{}`; leave one of them out", spec.excludes));
  if (!from_file)
    if (auto why = ignored_option(options, scene)) return why;
  if (auto why = accel_conflict(options)) return why;
  if (auto why = sample_conflict(options)) return why;
  if (auto why = fit_conflict(options)) return why;
  if (options.light_size > 0 && !options.soft_shadows) return without("light-size", "soft-shadows");
  if (shows_rays(options) && options.integrator && *options.integrator != IntegratorKind::views)
    return bad_option("view", fmt::format("{} belongs to `integrator` views; leave one of them out",
                                          view_name(options.view)));
  if (auto why = picture_conflict(options, scene)) return why;
  if (auto why = projection_conflict(options, options.projection.value_or(Projection())))
    return why;
  if (scene) return scene_conflict(options, *scene);
  if (options.dof == false && options.aperture > 0) return without("aperture", "dof");
  if (options.dof == false && options.focus > 0) return without("focus", "dof");
  return std::nullopt;
}

namespace {

// The defaults of a dialect.
struct Usual {
  ShadingModel shading;
  Fresnel fresnel;
};
constexpr Usual usual(Dialect dialect) {
  return dialect == Dialect::p3f ? Usual{ShadingModel::blinn_phong, Fresnel::schlick}
                                 : Usual{ShadingModel::nff, Fresnel::none};
}

}  // namespace

AccelKind hinted_accel(const Scene& scene) {
  switch (scene.requests.structure) {
    case AccelHint::any:
      break;
    case AccelHint::none:
      return AccelKind::none;
    case AccelHint::grid:
      return AccelKind::grid;
    case AccelHint::bvh:
      return AccelKind::bvh;
  }
  return AccelKind::automatic;
}

namespace {

PixelFilter usual_filter(IntegratorKind integrator) {
  return integrator == IntegratorKind::path ? PixelFilter::blackman_harris : PixelFilter::box;
}

// From the start of the first movement to the end of the last.
std::array<float, 2> usual_shutter(const Scene& scene) {
  if (!scene.moves()) return {0, 1};
  std::array shutter = {std::numeric_limits<float>::infinity(),
                        -std::numeric_limits<float>::infinity()};
  const auto add = [&](const auto& moving) {
    shutter = {std::min(shutter[0], moving.begin), std::max(shutter[1], moving.end)};
  };
  std::ranges::for_each(scene.moving_spheres, add);
  std::ranges::for_each(scene.moving_triangles, add);
  if (scene.camera.movement) add(*scene.camera.movement);
  return shutter;
}

}  // namespace

namespace {

void set_printed_size(PrintSize size, RenderSettings& s) {
  if (s.dpi == 0) s.dpi = kPrintDpi;
  const double shape =
      size.height > 0 ? double(size.height) / double(size.width) : double(s.height) / s.width;
  const double width = double(size.width) / 25.4 * double(s.dpi);
  s.width = std::max(1, int(std::lround(width)));
  s.height = std::max(1, int(std::lround(width * shape)));
}

}  // namespace

RenderSettings resolve_options(const RenderOptions& o, const Scene& scene) {
  RenderSettings s;
  static_cast<PlainOptions&>(s) = static_cast<const PlainOptions&>(o);
  s.accel.opacity = o.opacity.value_or(1);
  const bool asks_for_grid = o.accel.grid_factor > 0 || o.accel.grid_resolution[0] > 0;
  if (o.accel.kind == AccelKind::automatic)
    s.accel.kind = asks_for_grid ? AccelKind::grid : hinted_accel(scene);
  s.integrator = integrator_of(o, scene);
  if (s.integrator == IntegratorKind::views && o.view == View::picture) s.view = View::normals;
  s.channels = channels_of(o);
  if (s.channels.has(Channel::position) && scene.origin != Vec3d())
    s.channels.add(Channel::position_low);
  const Background background = background_of(o, scene);
  s.background = background.color, s.sky = background.sky;
  s.sees_environment = sees_environment(o, scene);
  s.tone = tone_of(o, scene);
  s.accel.counters |= s.view == View::steps || s.view == View::tests ||
                      s.channels.has(Channel::steps) || s.channels.has(Channel::tests);

  s.camera = camera_of(scene, o);
  if (o.width == 0) s.width = s.camera.width > 0 ? s.camera.width : 512;
  if (o.height == 0) s.height = s.camera.height > 0 ? s.camera.height : 512;
  if (o.print) set_printed_size(*o.print, s);
  if (!(o.fov_deg > 0)) s.camera.fov_deg = fitted_fov_deg(s.camera, s.width, s.height);
  if (s.crop == Crop{0, 0, s.width, s.height}) s.crop.reset();

  if (o.noise > 0)
    s.min_samples = min_samples(o), s.max_samples = max_samples(o), s.samples = s.max_samples;
  s.sampler = s.samples > 0 ? SamplerKind::sobol : o.sampler.value_or(SamplerKind::jitter);
  const bool path = s.integrator == IntegratorKind::path;
  const bool figure = lights_from_all_sides(s.integrator);
  s.filter = o.filter.value_or(usual_filter(s.integrator));
  if (o.depth == 0) s.depth = path ? kUsualPathDepth : RenderSettings().depth;
  if (figure && s.samples == 0 && o.aa == 0 && o.lens_samples == 0 &&
      o.sampler != SamplerKind::jitter && scene.requests.samples_per_pixel == 0)
    s.samples = kFigureSamples, s.sampler = SamplerKind::sobol;
  if (s.samples == 0 && o.aa == 0)
    s.aa = std::max(1, int(std::lround(std::sqrt(double(scene.requests.samples_per_pixel)))));
  if (s.samples == 0 && o.lens_samples == 0) s.lens_samples = 1;

  s.dof = s.camera.can_have_lens() && o.dof.value_or(s.camera.lens_radius.value_or(0) > 0);
  if (o.focus == 0) s.focus = s.camera.focus_distance.value_or(length(s.camera.at - s.camera.from));
  if (o.aperture == 0) s.aperture = s.camera.lens_radius.value_or(s.focus / 50);
  s.shading = o.shading.value_or(usual(scene.dialect).shading);
  s.fresnel = o.fresnel.value_or(usual(scene.dialect).fresnel);
  const std::array shutter = o.shutter.value_or(usual_shutter(scene));
  s.shutter_open = shutter[0], s.shutter_close = shutter[1];
  if (figure) s.figure = figure_settings(o, scene);
  if (o.threads == 0) s.threads = max_concurrency();
  return s;
}

RenderOptions options_of(const RenderSettings& s, const Scene& scene) {
  RenderOptions o;
  static_cast<PlainOptions&>(o) = static_cast<const PlainOptions&>(s);
  o.accel.opacity = 1;
  if (s.accel.opacity != 1) o.opacity = s.accel.opacity;
  if (s.integrator != integrator_of(o, scene)) o.integrator = s.integrator;
  if (lights_from_all_sides(s.integrator)) set_figure(o, s.figure, scene);
  // Pictures are written from their settings, without the scene.
  if (s.tone != Tone::none || tone_of(o, scene) != Tone::none) o.tone = s.tone;
  if (const Background own = background_of(o, scene);
      own != Background{s.background, s.sky} || s.sees_environment != sees_environment(o, scene))
    o.background = WrittenColor{.color = s.background, .sky = s.sky};
  set_camera(o, s.camera, scene);
  if (s.noise > 0) o.samples = 0;
  o.sampler = s.sampler, o.dof = s.dof;
  if (s.filter != usual_filter(s.integrator)) o.filter = s.filter;
  if (s.shading != usual(scene.dialect).shading) o.shading = s.shading;
  if (s.fresnel != usual(scene.dialect).fresnel) o.fresnel = s.fresnel;
  if (const std::array shutter = {s.shutter_open, s.shutter_close}; shutter != usual_shutter(scene))
    o.shutter = shutter;
  drop_ignored_options(o, scene);
  return o;
}

}  // namespace raio::core
