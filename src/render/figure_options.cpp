#include "render/figure_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "render/picture_options.h"

namespace raio::core {

std::expected<void, std::string> parse_look(RenderOptions& options, std::string_view text) {
  // The newest version of a style has the plain name.
  for (size_t i = kLookNames.size(); i-- > 0;)
    if (const std::string_view name = kLookNames[i];
        text == name || text == name.substr(0, name.find('-')))
      return options.look = FigureStyle(i), std::expected<void, std::string>();
  return std::unexpected(fmt::format("expected paper, dark, flat or matte, found '{}'", text));
}

std::string look_text(const RenderOptions& options) {
  return options.look ? std::string(kLookNames[size_t(*options.look)]) : "";
}

std::expected<void, std::string> parse_key_light(RenderOptions& options, std::string_view text) {
  const auto word = std::ranges::find(kOnOff, text);
  if (word == kOnOff.end())
    return std::unexpected(fmt::format("expected on or off, found '{}'", text));
  options.key_light = word != kOnOff.begin();
  return {};
}

std::string key_light_text(const RenderOptions& options) {
  return options.key_light ? std::string(kOnOff[*options.key_light]) : "";
}

namespace {

// Zero is a valid value: it switches off a property of the style.
std::expected<void, std::string> parse_part(std::string_view text, float most,
                                            std::optional<float>& out) {
  float value = -1;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, value);
  if (error != std::errc() || end != text_end || !(value >= 0 && value <= most))
    return std::unexpected(fmt::format("expected a number from 0 to {}, found '{}'", most, text));
  out = value;
  return {};
}

std::string text_of(const std::optional<float>& value) {
  return value ? fmt::format("{}", *value) : "";
}

}  // namespace

std::expected<void, std::string> parse_opacity(RenderOptions& options, std::string_view text) {
  return parse_part(text, 1, options.opacity);
}
std::string opacity_text(const RenderOptions& options) { return text_of(options.opacity); }

std::expected<void, std::string> parse_outline(RenderOptions& options, std::string_view text) {
  return parse_part(text, 64, options.outline);
}
std::string outline_text(const RenderOptions& options) { return text_of(options.outline); }

std::expected<void, std::string> parse_depth_cue(RenderOptions& options, std::string_view text) {
  return parse_part(text, 1, options.depth_cue);
}
std::string depth_cue_text(const RenderOptions& options) { return text_of(options.depth_cue); }

namespace {

// Whether the background is one colour, for depth cueing to fade into.
bool has_plain_background(const RenderOptions& options, const Scene& scene) {
  const bool transparent = options.background && options.background->transparent;
  return !transparent && !background_of(options, scene).sky;
}

}  // namespace

FigureSettings figure_settings(const RenderOptions& options, const Scene& scene) {
  FigureSettings figure;
  figure.look = options.look.value_or(FigureSettings().look);
  if (options.occlusion_rays > 0) figure.occlusion_rays = options.occlusion_rays;
  figure.occlusion_distance = options.occlusion_distance;
  figure.key_light = options.key_light.value_or(true);
  figure.shadow_catcher = options.shadow_catcher;
  const StyleParams look = params_of(figure.look);
  figure.outline = options.outline.value_or(look.outline);
  const bool fades = has_plain_background(options, scene);
  figure.depth_cue = options.depth_cue.value_or(fades ? look.depth_cue : 0);
  return figure;
}

void set_figure(RenderOptions& options, const FigureSettings& figure) {
  const FigureSettings usual;
  options.look = figure.look;
  options.occlusion_rays = figure.occlusion_rays;
  options.occlusion_distance = figure.occlusion_distance;
  if (figure.key_light != usual.key_light) options.key_light = figure.key_light;
  options.shadow_catcher = figure.shadow_catcher;
  const StyleParams look = params_of(figure.look);
  if (figure.outline != look.outline) options.outline = figure.outline;
  if (figure.depth_cue != look.depth_cue) options.depth_cue = figure.depth_cue;
}

namespace {

// Visits the names and members of options that belong to another integrator.
void visit_foreign_options(const RenderOptions& options, const Scene& scene, auto&& visit) {
  using O = RenderOptions;
  switch (integrator_of(options, scene)) {
    case IntegratorKind::classic:
    case IntegratorKind::views:
      visit("look", &O::look), visit("occlusion-rays", &O::occlusion_rays);
      visit("occlusion-distance", &O::occlusion_distance), visit("key-light", &O::key_light);
      visit("outline", &O::outline), visit("depth-cue", &O::depth_cue);
      visit("shadow-catcher", &O::shadow_catcher);
      break;
    case IntegratorKind::ambient:
      visit("depth", &O::depth), visit("soft-shadows", &O::soft_shadows);
      visit("light-size", &O::light_size), visit("shading", &O::shading);
      visit("fresnel", &O::fresnel), visit("gloss", &O::gloss);
      visit("translucency", &O::translucency), visit("no-reflection", &O::no_reflection);
      visit("no-refraction", &O::no_refraction);
      break;
  }
}

bool fades_into_nothing(const RenderOptions& options, const Scene& scene) {
  return options.depth_cue.value_or(0) > 0 && !has_plain_background(options, scene);
}

}  // namespace

std::optional<Error> figure_conflict(const RenderOptions& options, const Scene& scene) {
  std::optional<Error> why;
  visit_foreign_options(options, scene, [&](std::string_view option, auto member) {
    if (why || options.*member == RenderOptions().*member) return;
    const auto integrator = integrator_of(options, scene);
    const std::string other =
        integrator == IntegratorKind::views && !options.integrator
            ? fmt::format("`view` {}", view_name(options.view))
            : fmt::format("`integrator` {}", kIntegratorNames[size_t(integrator)]);
    why = bad_option(option, fmt::format("has no effect with {}; leave one of them out", other));
  });
  if (!why && fades_into_nothing(options, scene))
    why = bad_option("depth-cue", "fades into a colour; give one as `background`, or leave it out");
  return why;
}

void drop_figure_conflicts(RenderOptions& options, const Scene& scene) {
  visit_foreign_options(options, scene, [&](std::string_view, auto member) {
    options.*member = RenderOptions().*member;
  });
  if (fades_into_nothing(options, scene)) options.depth_cue.reset();
}

}  // namespace raio::core
