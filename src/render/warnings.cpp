#include "render/warnings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/clock.h"
#include "base/exact_math.h"
#include "integrate/camera.h"
#include "render/render.h"

namespace raio::core {
namespace {

constexpr int kSide = 24;  // eye rays along each side of the picture
constexpr float kMuch =
    0.02f;  // spread of half of the visible points, relative to the picture's height
constexpr float kLittle = 0.01f;     // the same for the proposed lens
constexpr float kSharp = 0.005f;     // relative to the picture's height; a pixel if that is more
constexpr float kMinSharp = 0.025f;  // fraction of the visible points

// The depths of visible points along the view, nearest first.
std::vector<float> depths_seen(const RenderSettings& settings, const Camera& camera,
                               const EyeRays& eye, const Accel& accel) {
  const Crop frame = settings.frame();
  RayBatch rays;
  rays.add_time();
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      rays.push(eye.pinhole(float(frame.x0) + (float(x) + 0.5f) * float(frame.width()) / kSide,
                            float(frame.y0) + (float(y) + 0.5f) * float(frame.height()) / kSide,
                            settings.shutter_open));
  HitBatch hits;
  hits.reset(rays.size());
  TraceContext context;
  accel.closest_of_all(rays, hits, context);
  const Vec3f forward = normalize(camera.at - camera.from);
  std::vector<float> depths;
  for (size_t i = 0; i < rays.size(); ++i)
    if (hits[i].found()) depths.push_back(hits[i].t * dot(rays[i].dir, forward));
  std::ranges::sort(depths);
  return depths;
}

/// The blur of a lens in the picture.
struct Blur {
  float median = 0;       // relative to the picture's height
  float sharp_share = 0;  // of the visible points

  bool is_too_much() const { return median > kMuch && sharp_share < kMinSharp; }
};

// A lens of radius R focused at F spreads a point at depth z over a circle of diameter 2 R |z - F|
// / (z F) at depth 1, where the picture has the height `height`.
Blur blur_of(const std::vector<float>& depths, float aperture, float focus, float height,
             float pixel) {
  std::vector<float> spread;
  spread.reserve(depths.size());
  for (const float z : depths)
    spread.push_back(2 * aperture * std::abs(z - focus) / (z * focus * height));
  std::ranges::sort(spread);
  const float sharp = std::max(kSharp, pixel / height);
  const auto first_blurred = std::ranges::upper_bound(spread, sharp);
  return {spread[spread.size() / 2], float(first_blurred - spread.begin()) / float(spread.size())};
}

// Two digits, rounded down.
float plain_number(float value) {
  const auto unit = float(exact_pow(10, std::floor(float(exact_log10(value))) - 1));
  return float(std::floor(double(value) / unit + 1e-6) * unit);
}

bool is_dark(const Scene& scene, const RenderSettings& settings) {
  const FigureSettings& figure = settings.figure;
  return figure.key_light != KeyLight::on && figure.sky_light == Rgb() && !settings.sky &&
         (figure.key_light == KeyLight::off ||
          (settings.background == Rgb() && scene.lights.empty() &&
           scene.physical_lights.empty())) &&
         !scene.has_emission();
}

// The parameters of standard surfaces that the integrator leaves out, in one sentence.
std::string unseen_parameters(const Scene& scene, IntegratorKind integrator) {
  if (integrator == IntegratorKind::views || integrator == IntegratorKind::path) return "";
  std::string list;
  const auto add = [&](std::string_view what, auto&& has) {
    const auto count = std::ranges::count_if(
        scene.standard_surfaces, [&](const StandardSurface& s) { return s.is_standard && has(s); });
    if (count > 0)
      list += fmt::format("{}{} ({} material{})", list.empty() ? "" : ", ", what, count,
                          count == 1 ? "" : "s");
  };
  add("emission", [](const auto& s) { return !s.is_unlit && s.emission != Rgb(); });
  add("transmission", [](const auto& s) { return s.transmission > 0; });
  add("normal maps", [](const auto& s) { return s.normal_texture != kNoTexture; });
  add("clearcoat", [](const auto& s) { return s.coat > 0; });
  add("sheen", [](const auto& s) { return s.sheen_color != Rgb(); });
  if (list.empty()) return list;
  return fmt::format("{} does not show {}; path does", kIntegratorNames[size_t(integrator)], list);
}

}  // namespace

std::vector<SceneWarning> scene_warnings(const Scene& scene, const RenderSettings& settings,
                                         const Accel* accel) {
  std::vector<SceneWarning> warnings;
  if (scene.lights.empty() && settings.integrator == IntegratorKind::classic)
    warnings.push_back(
        {SceneWarning::no_light, settings.shading == ShadingModel::nff
                                     ? "the scene has no light; surfaces show ambient light only"
                                     : "the scene has no light, and this shading model no ambient "
                                       "light, so surfaces are black"});
  if (settings.integrator == IntegratorKind::path && is_dark(scene, settings))
    warnings.push_back({SceneWarning::no_light,
                        "the scene has no light: no lights, no surfaces that emit, a black "
                        "background and no sky"});
  if (!settings.camera.can_have_lens() && settings.camera.lens_radius.value_or(0) > 0)
    warnings.push_back(
        {SceneWarning::no_lens,
         fmt::format("the scene's lens has no effect on {} rays; everything is sharp",
                     settings.camera.is_parallel() ? "parallel" : "omnidirectional")});
  if (const size_t count = scene.primitive_count(); scene.requests.structure == AccelHint::none &&
                                                    settings.accel.kind == AccelKind::none &&
                                                    count > kManyPrimitives)
    warnings.push_back(
        {SceneWarning::no_tree,
         fmt::format(
             "the file requests brute force, so each ray is tested with all of {} primitives",
             count)});
  if (std::string unseen = unseen_parameters(scene, settings.integrator); !unseen.empty())
    warnings.push_back({SceneWarning::unseen, std::move(unseen)});
  if (!settings.dof || !accel) return warnings;
  const Camera camera = camera_at(settings.camera, settings.shutter_open);
  const EyeRays eye(camera, settings.width, settings.height, settings.angle_to_centers);
  const float pixel = length(eye.per_y), height = pixel * float(settings.height);
  const std::vector<float> depths = depths_seen(settings, camera, eye, *accel);
  if (depths.empty()) return warnings;
  const auto blur = [&](float aperture, float focus) {
    return blur_of(depths, aperture, focus, height, pixel);
  };
  const Blur now = blur(settings.aperture, settings.focus);
  if (!now.is_too_much()) return warnings;

  SceneWarning warning{SceneWarning::blurred,
                       fmt::format("the lens blurs nearly the whole picture: half of the visible "
                                   "points are spread over {:.0f} pixels or more",
                                   now.median * float(settings.height))};
  // The spread is proportional to the radius of the lens.
  warning.aperture = plain_number(settings.aperture * kLittle / now.median);
  const float focus = plain_number(depths[depths.size() / 2]);
  if (blur(settings.aperture, focus).median <= kLittle) warning.focus = focus;
  warnings.push_back(std::move(warning));
  return warnings;
}

double seconds_with_tree(const Scene& scene, RenderSettings settings) {
  constexpr size_t kTiles = 16;
  settings.accel.kind = AccelKind::bvh;
  const auto start = Clock::now();
  const auto tree = build_accel(scene, settings.accel, settings.one_sided);
  const double build = seconds_since(start);
  const auto film = make_film(scene, settings);
  if (!tree || !film) return 0;
  const auto share = uint32_t(std::max<size_t>(1, (*film)->tiles() / kTiles));
  WorkControl control;
  const RenderResult done =
      render(scene, **tree, settings, **film, control, {.samples = 1, .shards = share});
  const Crop frame = settings.frame();
  const double rays = double(frame.width()) * frame.height() * settings.samples_per_pixel();
  const auto tried = double((*film)->rays().eye);
  return tried > 0 ? build + done.busy_s * rays / tried / std::max(1, settings.threads) : 0;
}

std::vector<std::string> fault_warnings(const Film& film, const std::optional<Crop>& crop) {
  const Crop frame = crop.value_or(Crop());
  const SampleFaults faults = film.faults();
  std::vector<std::string> warnings;
  const auto add = [&](const CountedSamples& some, std::string_view one, std::string_view many) {
    if (some.count > 0)
      warnings.push_back(fmt::format("{} {}; the first pixel with one is {},{}", some.count,
                                     some.count == 1 ? one : many, some.x + uint32_t(frame.x0),
                                     some.y + uint32_t(frame.y0)));
  };
  add(faults.nans, "sample is not a number (NaN) and counts as black",
      "samples are not a number (NaN) and count as black");
  const std::string limit =
      fmt::format(" clamped to {:.3g}, so the picture is too dark there", film.bound());
  add(faults.clamped, "sample is" + limit, "samples are" + limit);
  return warnings;
}

std::optional<std::string> blank_warning(const Film& film, const RenderSettings& settings,
                                         const Accel& accel) {
  const auto is_background = [&](const Rgb& pixel) {
    constexpr float kSame = 0.5f / 255;
    return max_component(abs(pixel - settings.background)) < kSame;
  };
  const auto is_transparent = [](float alpha) { return alpha == 0; };
  // With alpha, colours have no background.
  const bool is_blank =
      settings.channels.has(Channel::alpha)
          ? std::ranges::all_of(std::get<Column<float>>(film.resolve(Channel::alpha)),
                                is_transparent)
          : !settings.sky && !settings.sees_environment &&
                std::ranges::all_of(film.resolve().pixels, is_background);
  if (!is_blank) return std::nullopt;
  const Camera camera = camera_at(settings.camera, settings.shutter_open);
  const EyeRays eye(camera, settings.width, settings.height, settings.angle_to_centers);
  const bool looks_elsewhere = depths_seen(settings, camera, eye, accel).empty();
  return std::string("the picture shows only its background: ") +
         (looks_elsewhere ? "the camera looks elsewhere, or the primitives have no area, no "
                            "opacity or are smaller than a pixel"
                          : "surfaces are fully transparent, or have the background's colour");
}

}  // namespace raio::core
