#include "render/picture_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "io/cube_map.h"
#include "io/image/image.h"
#include "render/figure_options.h"

namespace raio::core {
namespace {

constexpr std::string_view kSky = "sky";  // a background

std::optional<Error> crop_conflict(const RenderOptions& options, const Scene* scene) {
  if (!options.crop || (!scene && options.width == 0)) return std::nullopt;
  int width = options.width, height = options.height;
  if (scene) {
    const RenderSettings settings = resolve_options(options, *scene);
    width = settings.width, height = settings.height;
  }
  if (options.crop->x1 <= width && options.crop->y1 <= height) return std::nullopt;
  return bad_option(
      "crop", fmt::format("{},{},{},{} ends outside the picture, which has {}x{} pixels; "
                          "choose an X1 of at most {} and a Y1 of at most {}",
                          options.crop->x0, options.crop->y0, options.crop->x1, options.crop->y1,
                          width, height, width, height));
}

// The option by which `options` show something other than light, as in "`view` normals"; empty if
// they show light.
std::string no_light_in(const RenderOptions& options) {
  if (options.view != View::picture) return fmt::format("`view` {}", view_name(options.view));
  return options.integrator == IntegratorKind::views ? "`integrator` views" : "";
}

std::optional<Error> look_conflict(const RenderOptions& options) {
  const std::string instead = no_light_in(options);
  if (instead.empty()) return std::nullopt;
  const auto without_effect = [&](std::string_view option, std::string_view but) {
    return bad_option(option,
                      fmt::format("has no effect with {}{}; leave one of them out", instead, but));
  };
  if (options.exposure != Exposure()) return without_effect("exposure", "");
  if (options.tone && *options.tone != Tone::none) return without_effect("tone", "");
  if (options.denoise != Denoiser::none) return without_effect("denoise", "");
  if (options.background && !options.background->transparent)
    return without_effect("background", ", but transparent has");
  return std::nullopt;
}

}  // namespace

std::expected<void, std::string> set_crop(RenderOptions& options, const OptionSpec&,
                                          std::string_view text) {
  std::array<int, 4> edges{};
  const bool sound = parse_list(text, ',', edges) && std::ranges::min(edges) >= 0;
  const Crop crop{edges[0], edges[1], edges[2], edges[3]};
  if (!sound || crop.x0 >= crop.x1 || crop.y0 >= crop.y1)
    return expected_but(
        "a part of the picture in pixels as X0,Y0,X1,Y1 with X0 below X1 and Y0 below Y1, as in "
        "200,100,400,300",
        text);
  options.crop = crop;
  return {};
}

std::string crop_text(const RenderOptions& options, const OptionSpec&) {
  const auto& crop = options.crop;
  return crop ? fmt::format("{},{},{},{}", crop->x0, crop->y0, crop->x1, crop->y1) : "";
}

std::expected<void, std::string> set_background(RenderOptions& options, const OptionSpec&,
                                                std::string_view text) {
  auto color = parse_color(text);
  if (color) {
    options.background = std::move(*color);
    return {};
  }
  std::error_code ignored;
  const bool is_folder = std::filesystem::is_directory(text, ignored);
  const std::string suffix = lower_suffix(text);
  if (!is_folder && (text == kSky || suffix == ".exr" || suffix == ".hdr")) {
    options.background = WrittenColor{.color = {}, .environment = std::string(text)};
    return {};
  }
  if (!is_folder)
    return std::unexpected(color.error() +
                           "; nor is it sky, a picture of all directions as .exr or .hdr, or a "
                           "folder");
  auto sky = read_cube_map(text);
  if (!sky) return std::unexpected(sky.error().text());
  options.background = WrittenColor{.color = {}, .sky = std::move(*sky)};
  return {};
}

std::string background_text(const RenderOptions& options, const OptionSpec&) {
  if (!options.background) return {};
  const auto& [color, transparent, encoded, sky, environment] = *options.background;
  if (!environment.empty()) return environment;
  if (sky) return sky->folder;
  if (transparent) return "transparent";
  if (!encoded) return fmt::format("{},{},{}", color.x, color.y, color.z);
  return fmt::format("#{:02x}{:02x}{:02x}", to_byte(color.x), to_byte(color.y), to_byte(color.z));
}

std::optional<Error> read_background(RenderOptions& options, ReadOptions& read) {
  if (!options.background || options.background->environment.empty()) return std::nullopt;
  const std::string wanted = options.background->environment;
  const bool is_sky = wanted == kSky;
  const bool other_file = !read.environment.empty() && (is_sky || read.environment != wanted);
  if (other_file || (read.sky && !is_sky))
    return bad_option("background",
                      fmt::format("{} cannot be combined with `{}`; leave one of them out", wanted,
                                  other_file ? "environment" : "sky"));
  constexpr std::array kUsualSky = {3.f, 45.f, 0.f};
  if (is_sky && !read.sky) read.sky = kUsualSky;
  if (!is_sky) read.environment = wanted;
  options.background.reset();
  return std::nullopt;
}

Tone tone_of(const RenderOptions& options, const Scene& scene) {
  const bool figure =
      no_light_in(options).empty() && integrator_of(options, scene) != IntegratorKind::classic;
  return options.tone.value_or(figure ? Tone::srgb : Tone::none);
}

Background background_of(const RenderOptions& options, const Scene& scene) {
  if (!no_light_in(options).empty()) return {scene.background, nullptr};
  const IntegratorKind integrator = integrator_of(options, scene);
  const bool is_figure = integrator == IntegratorKind::ambient ||
                         (integrator == IntegratorKind::path && !has_own_light(scene));
  if (!options.background && scene.dialect == Dialect::data && is_figure)
    return {params_of(options.look.value_or(FigureSettings().look)).background, nullptr};
  if (!options.background) return {scene.background, scene.sky};
  const WrittenColor& written = *options.background;
  if (!written.encoded || tone_of(options, scene) == Tone::none)
    return {written.color, written.sky};
  return {linear_from_srgb(written.color), nullptr};
}

bool sees_environment(const RenderOptions& options, const Scene& scene) {
  return !options.background && lights_from_all_sides(integrator_of(options, scene)) &&
         !scene.environment.empty() && scene.environment[0].visible;
}

ChannelSet channels_of(const RenderOptions& options) {
  ChannelSet channels = options.channels;
  if (options.background && options.background->transparent) channels.add(Channel::alpha);
  return channels;
}

std::optional<Error> picture_conflict(const RenderOptions& options, const Scene* scene) {
  if (auto why = look_conflict(options)) return why;
  if (scene && options.background && !options.background->environment.empty())
    return bad_option("background",
                      fmt::format("{} also lights the scene, so it is for reading a file; give it, "
                                  "`sky` or `environment` where the scene is read",
                                  options.background->environment));
  return crop_conflict(options, scene);
}

std::optional<Error> window_conflict(const RenderOptions& options) {
  if (options.print || options.dpi > 0)
    return bad_option(options.print ? "width" : "dpi",
                      "the window has no printed size; leave it out, or render to a file");
  if (options.denoise != Denoiser::none)
    return bad_option("denoise",
                      "the window refines its pictures instead; leave it out, or render to a file");
  if (options.crop)
    return bad_option("crop", "the window shows whole pictures; leave it out, or render to a file");
  if (options.noise > 0)
    return bad_option("noise",
                      "the window gives all pixels the same number of samples; leave it out, or "
                      "render to a file");
  if (options.projection == Projection::omnidirectional)
    return bad_option("projection",
                      "the window shows no omnidirectional pictures; choose another, or render to "
                      "a file");
  if (options.background && options.background->transparent)
    return bad_option("background",
                      "the window cannot show transparency; give a colour, or render to a file");
  return std::nullopt;
}

}  // namespace raio::core
