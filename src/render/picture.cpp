#include "render/picture.h"

#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "render/provenance.h"
#include "render/render.h"

namespace raio::core {
namespace {

// The channels that become layers.
std::vector<const ChannelSpec*> layers_of(ChannelSet channels) {
  std::vector<const ChannelSpec*> layers;
  for (const ChannelSpec& spec : kChannels)
    if (spec.channel != Channel::alpha && channels.has(spec.channel)) layers.push_back(&spec);
  return layers;
}

}  // namespace

Picture picture_of(const Film& film, const RenderSettings& settings) {
  Picture picture;
  picture.color = picture_of(film, settings.view);
  const ChannelSet channels = film.layout().channels();
  if (channels.has(Channel::alpha))
    picture.alpha = std::get<Column<float>>(film.resolve(Channel::alpha));
  for (const ChannelSpec* spec : layers_of(channels)) {
    Layer& layer = picture.layers.emplace_back();
    layer.name = spec->name;
    for (const char component : spec->components) layer.components.emplace_back(1, component);
    layer.values = film.resolve(spec->channel);
  }
  return picture;
}

std::optional<Error> output_problem(const std::filesystem::path& path, ChannelSet channels) {
  if (!is_part_path(path)) {
    const auto format = image_format(path);
    if (!format) return format.error();
    std::vector<std::string> layers;
    for (const ChannelSpec* spec : layers_of(channels)) layers.emplace_back(spec->name);
    if (std::string lost = unkept(*format, channels.has(Channel::alpha), layers); !lost.empty())
      return Error{ErrorKind::bad_input, path.string(), std::move(lost)};
  }
  if (auto writable = check_writable(path); !writable) return std::move(writable.error());
  return std::nullopt;
}

void tone_map(Image& image, std::span<const float> alpha, Tone tone, float exposure_ev) {
  if (tone == Tone::none && exposure_ev == 0) return;
  const ToneMap map(tone, exposure_ev);
  for_each_index(image.pixels.size(), [&](size_t i) {
    Rgb& color = image.pixels[i];
    const float covered = alpha.empty() ? 1 : alpha[i];
    if (covered == 1)
      color = map(color);
    else if (covered > 0)
      color = map(color / covered) * covered;
  });
}

namespace {

// As stored in a file of this name: with tone, exposure and overlay.
std::expected<void, Error> finish(Picture& picture, const std::filesystem::path& path,
                                  const Metadata& settings, const Overlay& overlay) {
  const auto options = options_from(settings, false);
  if (!options)
    return std::unexpected(Error{options.error().kind, path.string(), options.error().message});
  const auto format = image_format(path);
  const bool for_displays = format == ImageFormat::png || format == ImageFormat::ppm;
  const Tone tone = options->tone.value_or(Tone::none);
  picture.dpi = options->dpi;
  if (for_displays) tone_map(picture.color, picture.alpha, tone, options->exposure);
  return overlay ? overlay(picture, !for_displays && tone != Tone::none)
                 : std::expected<void, Error>();
}

std::expected<Picture, Error> picture_of(const Part& part, const std::filesystem::path& path) {
  const auto options = options_from(part.header.settings, false);
  if (!options)
    return std::unexpected(Error{options.error().kind, path.string(), options.error().message});
  RenderSettings settings;
  settings.view = options->view;
  return picture_of(*part.film, settings);
}

}  // namespace

std::expected<void, Error> write_picture(Picture picture, const std::filesystem::path& path,
                                         const Metadata& settings, const Overlay& overlay) {
  if (auto done = finish(picture, path, settings, overlay); !done) return done;
  return write_image(picture, path, settings);
}

std::expected<Picture, Error> finished_picture(const Part& part, const std::filesystem::path& name,
                                               const Overlay& overlay) {
  auto picture = picture_of(part, name);
  if (picture)
    if (auto done = finish(*picture, name, part.header.settings, overlay); !done)
      return std::unexpected(std::move(done.error()));
  return picture;
}

std::expected<void, Error> write_result(const std::filesystem::path& path, const Part& part,
                                        const Overlay& overlay) {
  if (is_part_path(path)) return write_part(path, part.header, *part.film);
  auto picture = picture_of(part, path);
  if (!picture) return std::unexpected(std::move(picture.error()));
  return write_picture(*std::move(picture), path, part.header.settings, overlay);
}

}  // namespace raio::core
