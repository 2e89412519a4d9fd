#include "render/figure_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/picture_options.h"

namespace raio::core {

std::expected<void, std::string> set_look(RenderOptions& options, const OptionSpec&,
                                          std::string_view text) {
  // The newest version of a style has the plain name.
  for (size_t i = kLookNames.size(); i-- > 0;)
    if (const std::string_view name = kLookNames[i];
        text == name || text == name.substr(0, name.find('-')))
      return options.look = FigureStyle(i), std::expected<void, std::string>();
  return expected_but("paper, dark, flat or matte", text);
}

std::string look_text(const RenderOptions& options, const OptionSpec&) {
  return options.look ? std::string(kLookNames[size_t(*options.look)]) : "";
}

std::expected<void, std::string> set_sky_light(RenderOptions& options, const OptionSpec& spec,
                                               std::string_view text) {
  const ColorLimits limits{.transparent = false, .brightest = spec.most};
  if (const auto grey = parse_number<float>(text);
      grey && *grey >= 0 && double(*grey) <= limits.brightest) {
    options.sky_light = Rgb(*grey);
    return {};
  }
  const auto color = parse_color(text, limits);
  constexpr std::string_view kExpected = "expected ";  // begins the error
  if (!color)
    return std::unexpected("expected a number, or " + color.error().substr(kExpected.size()));
  options.sky_light = color->encoded ? linear_from_srgb(color->color) : color->color;
  return {};
}

std::string sky_light_text(const RenderOptions& options, const OptionSpec&) {
  if (!options.sky_light) return "";
  const Rgb& light = *options.sky_light;
  return light == Rgb(light.x) ? fmt::format("{}", light.x)
                               : fmt::format("{},{},{}", light.x, light.y, light.z);
}

namespace {

// Whether the background is one colour, for depth cueing to fade into.
bool has_plain_background(const RenderOptions& options, const Scene& scene) {
  const bool transparent = options.background && options.background->transparent;
  return !transparent && !background_of(options, scene).sky && !sees_environment(options, scene);
}

// The defaults that the scene decides: its own light as it is, if it has any.
KeyLight usual_key_light(const RenderOptions& options, const Scene& scene) {
  const bool is_path = integrator_of(options, scene) == IntegratorKind::path;
  const bool is_lit = is_path ? has_own_light(scene) : !scene.physical_lights.empty();
  return is_lit ? KeyLight::scene : KeyLight::on;
}
Rgb usual_sky_light(const RenderOptions& options, const Scene& scene, const StyleParams& look) {
  if (!scene.environment.empty()) return Rgb(1);
  const bool is_path = integrator_of(options, scene) == IntegratorKind::path;
  return Rgb(is_path && has_own_light(scene) ? 0 : look.sky);
}

}  // namespace

bool has_bright_surfaces(const Scene& scene) {
  return std::ranges::any_of(scene.standard_surfaces, [](const StandardSurface& s) {
    return s.is_standard && max_component(s.emission) > 1;
  });
}

bool has_own_light(const Scene& scene) {
  return scene.dialect != Dialect::data || !scene.lights.empty() ||
         !scene.physical_lights.empty() || !scene.environment.empty() || has_bright_surfaces(scene);
}

FigureSettings figure_settings(const RenderOptions& options, const Scene& scene) {
  FigureSettings figure;
  figure.look = options.look.value_or(FigureSettings().look);
  if (options.occlusion_rays > 0) figure.occlusion_rays = options.occlusion_rays;
  figure.occlusion_distance = options.occlusion_distance;
  figure.key_light = options.key_light.value_or(usual_key_light(options, scene));
  figure.shadow_catcher = options.shadow_catcher;
  const StyleParams look = params_of(figure.look);
  figure.sky_light = options.sky_light.value_or(usual_sky_light(options, scene, look));
  figure.outline = options.outline.value_or(look.outline);
  const bool fades = has_plain_background(options, scene);
  figure.depth_cue = options.depth_cue.value_or(fades ? look.depth_cue : 0);
  return figure;
}

void set_figure(RenderOptions& options, const FigureSettings& figure, const Scene& scene) {
  options.look = figure.look;
  options.occlusion_rays = figure.occlusion_rays;
  options.occlusion_distance = figure.occlusion_distance;
  if (figure.key_light != usual_key_light(options, scene)) options.key_light = figure.key_light;
  options.shadow_catcher = figure.shadow_catcher;
  const StyleParams look = params_of(figure.look);
  if (figure.sky_light != usual_sky_light(options, scene, look))
    options.sky_light = figure.sky_light;
  if (figure.outline != look.outline) options.outline = figure.outline;
  if (figure.depth_cue != look.depth_cue) options.depth_cue = figure.depth_cue;
}

bool fades_into_nothing(const RenderOptions& options, const Scene& scene) {
  return options.depth_cue.value_or(0) > 0 && !has_plain_background(options, scene);
}

}  // namespace raio::core
