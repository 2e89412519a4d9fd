#include "render/picture.h"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "integrate/oidn.h"
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
  if (settings.channels.has(Channel::alpha))
    picture.alpha = std::get<Column<float>>(film.resolve(Channel::alpha));
  for (const ChannelSpec* spec : layers_of(settings.channels)) {
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

float tone_map(Image& image, std::span<const float> alpha, Tone tone, const Exposure& exposure) {
  const float ev = exposure.automatic ? exposure_of(image.pixels, alpha) : exposure.ev;
  if (tone == Tone::none && ev == 0) return ev;
  const ToneMap map(tone, ev);
  for_each_index(image.pixels.size(), [&](size_t i) {
    Rgb& color = image.pixels[i];
    const float covered = alpha.empty() ? 1 : alpha[i];
    if (covered == 1)
      color = map(color);
    else if (covered > 0)
      color = map(color / covered) * covered;
  });
  return ev;
}

std::optional<Error> denoiser_problem(Denoiser denoiser) {
  if (denoiser != Denoiser::oidn) return std::nullopt;
  const auto version = oidn_version();
  if (version) return std::nullopt;
  return Error{ErrorKind::no_resource, "denoise",
               fmt::format("Open Image Denoise is missing ({}); install it, name its library in "
                           "RAIO_OIDN, or choose raio",
                           version.error())};
}

namespace {

std::expected<RenderOptions, Error> options_of(const Metadata& settings,
                                               const std::filesystem::path& path) {
  auto options = options_from(settings, false);
  if (!options)
    return std::unexpected(Error{options.error().kind, path.string(), options.error().message});
  return options;
}

// Removes the noise of the film's picture. The settings then name the filter, which `auto` chose.
std::expected<void, Error> denoise_picture(const Film& film, Denoiser denoiser,
                                           FinishedPicture& finished) {
  std::array<Column<float>, kGuideChannels.size()> guides;
  for (size_t i = 0; i < guides.size(); ++i)
    guides[i] = std::get<Column<float>>(film.resolve(kGuideChannels[i]));
  const auto samples = std::get<Column<uint32_t>>(film.resolve(Channel::samples));
  const PixelGuides known{
      finished.picture.alpha, guides[0], guides[1], guides[2], guides[3], samples};
  const auto version = oidn_version();
  RenderOptions used;
  std::string name = "Raio's own filter";
  if (denoiser == Denoiser::oidn || (denoiser == Denoiser::automatic && version)) {
    if (auto why = denoiser_problem(denoiser)) return std::unexpected(*std::move(why));
    if (auto done = denoise_by_oidn(finished.picture.color, known); !done)
      return std::unexpected(Error{ErrorKind::no_resource, "denoise", std::move(done.error())});
    used.denoise = Denoiser::oidn, name = "Open Image Denoise " + *version;
  } else {
    denoise(finished.picture.color, known);
    used.denoise = Denoiser::raio;
  }
  set_setting(finished.settings, option_of("denoise"), used);
  finished.settings.emplace_back("denoised_by", name);
  finished.notes.push_back("denoised by " + name);
  return {};
}

// As stored in a file of this name: with tone, exposure and overlay.
std::expected<void, Error> finish(FinishedPicture& finished, const std::filesystem::path& path,
                                  const RenderOptions& options, const Overlay& overlay) {
  auto& [picture, settings, notes] = finished;
  const auto format = image_format(path);
  const bool for_displays = format == ImageFormat::png || format == ImageFormat::ppm;
  const Tone tone = options.tone.value_or(Tone::none);
  picture.dpi = options.dpi;
  if (for_displays) {
    const float ev = tone_map(picture.color, picture.alpha, tone, options.exposure);
    if (options.exposure.automatic) {
      settings.emplace_back("exposure_ev", fmt::format("{}", ev));
      notes.push_back(fmt::format("exposure {:+.2f} EV, chosen from the picture", ev));
    }
  }
  return overlay ? overlay(picture, !for_displays && tone != Tone::none)
                 : std::expected<void, Error>();
}

}  // namespace

std::expected<ChannelSet, Error> channels_of(const Part& part) {
  const auto options = options_of(part.header.settings, {});
  if (!options) return std::unexpected(options.error());
  return options->channels;
}

std::expected<void, Error> write_picture(Picture picture, const std::filesystem::path& path,
                                         const Metadata& settings, const Overlay& overlay) {
  const auto options = options_of(settings, path);
  if (!options) return std::unexpected(options.error());
  FinishedPicture finished{std::move(picture), settings, {}};
  if (auto done = finish(finished, path, *options, overlay); !done) return done;
  return write_image(finished.picture, path, finished.settings);
}

std::expected<FinishedPicture, Error> finished_picture(const Part& part,
                                                       const std::filesystem::path& name,
                                                       const Overlay& overlay) {
  const auto options = options_of(part.header.settings, name);
  if (!options) return std::unexpected(options.error());
  RenderSettings settings;
  settings.view = options->view, settings.channels = options->channels;
  FinishedPicture finished{picture_of(*part.film, settings), part.header.settings, {}};
  if (options->denoise != Denoiser::none)
    if (auto done = denoise_picture(*part.film, options->denoise, finished); !done)
      return std::unexpected(std::move(done.error()));
  if (auto done = finish(finished, name, *options, overlay); !done)
    return std::unexpected(std::move(done.error()));
  return finished;
}

std::expected<std::vector<std::string>, Error> write_result(const std::filesystem::path& path,
                                                            const Part& part,
                                                            const Overlay& overlay) {
  if (is_part_path(path)) {
    if (auto written = write_part(path, part.header, *part.film); !written)
      return std::unexpected(std::move(written.error()));
    return std::vector<std::string>();
  }
  auto finished = finished_picture(part, path, overlay);
  if (!finished) return std::unexpected(std::move(finished.error()));
  if (auto written = write_image(finished->picture, path, finished->settings); !written)
    return std::unexpected(std::move(written.error()));
  return std::move(finished->notes);
}

}  // namespace raio::core
