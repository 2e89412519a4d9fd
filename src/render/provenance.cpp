#include "render/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <type_traits>
#include <utility>

#include "io/file.h"
#include "render/picture.h"
#include "render/read_options.h"

namespace raio::core {
namespace {

constexpr std::string_view kRead = "read_";  // prefix of reading options

// Names of settings have underscores instead of dashes.
std::string key_of(const auto& spec) {
  constexpr bool kReads = std::is_same_v<decltype(spec), const ReadOptionSpec&>;
  std::string key = (kReads ? std::string(kRead) : "") + std::string(spec.name);
  std::ranges::replace(key, '-', '_');
  return key;
}

// Adds all options that are set.
template <class Options>
void add_settings(std::span<const OptionEntry<Options>> table, const Options& options,
                  Metadata& settings) {
  for (const OptionEntry<Options>& spec : table)
    if (std::string text = spec.text(options); spec.of_picture && !text.empty())
      settings.emplace_back(key_of(spec), std::move(text));
}

// Settings that are not options.
constexpr std::array<std::string_view, 8> kNoOptions = {"version",     "scene",      "scene_hash",
                                                        "sky",         "sky_hash",   "samples_done",
                                                        "denoised_by", "exposure_ev"};

}  // namespace

Metadata settings_of(const Scene& scene, const RenderSettings& used, const ReadOptions& read,
                     const std::string& scene_hash) {
  RenderOptions o = options_of(used, scene);
  if (!used.dof) o.aperture = o.focus = 0;  // unused
  Metadata settings = {{"version", RAIO_VERSION},
                       {"scene", scene.name},
                       {"scene_hash", scene_hash.empty() ? content_hash(scene) : scene_hash}};
  add_settings(read_option_table(), read, settings);
  if (used.sky) {
    settings.emplace_back("sky", used.sky->folder);
    settings.emplace_back("sky_hash", hex(used.sky->hash));
  }
  add_settings(render_option_table(), o, settings);
  return settings;
}

void set_setting(Metadata& settings, const OptionSpec& spec, const RenderOptions& options) {
  const std::string key = key_of(spec);
  std::erase_if(settings, [&](const auto& entry) { return entry.first == key; });
  std::string text = spec.text(options);
  if (text.empty()) return;
  // In the order of the table.
  const auto table = render_option_table();
  const auto later = std::ranges::find_if(settings, [&](const auto& entry) {
    return std::any_of(table.begin() + (&spec - table.data()), table.end(),
                       [&](const OptionSpec& other) { return key_of(other) == entry.first; });
  });
  settings.emplace(later, key, std::move(text));
}

std::expected<ReadOptions, Error> read_options_from(const Metadata& settings) {
  ReadOptions read = kForPictures;
  for (const auto& [key, text] : settings) {
    if (!key.starts_with(kRead)) continue;
    const auto table = read_option_table();
    const auto spec = std::ranges::find_if(
        table, [&](const ReadOptionSpec& option) { return key_of(option) == key; });
    const auto set =
        spec == table.end()
            ? std::expected<void, std::string>(std::unexpected("is unknown to this version"))
            : spec->set(read, text);
    if (!set)
      return std::unexpected(
          Error{ErrorKind::bad_input, "", fmt::format("its setting {}: {}", key, set.error())});
  }
  return read;
}

std::string_view setting(const Metadata& settings, std::string_view key) {
  const auto found = std::ranges::find(settings, key, &Metadata::value_type::first);
  return found == settings.end() ? std::string_view() : found->second;
}

std::expected<RenderOptions, Error> options_from(const Metadata& settings, bool reads_sky) {
  const auto refused = [](std::string why) {
    return std::unexpected(Error{ErrorKind::bad_input, "", std::move(why)});
  };
  if (setting(settings, "version").empty() || setting(settings, "scene_hash").empty())
    return refused("it has no settings of Raio");
  const auto table = render_option_table();
  RenderOptions options;
  for (const auto& [key, text] : settings) {
    if (std::ranges::find(kNoOptions, key) != kNoOptions.end() || key.starts_with(kRead)) continue;
    if (key == "background" && !reads_sky && !setting(settings, "sky_hash").empty()) continue;
    const auto spec = std::ranges::find_if(
        table, [&](const OptionSpec& option) { return key_of(option) == key; });
    if (spec == table.end() || !spec->of_picture)
      return refused(fmt::format("its setting {} is unknown to this version", key));
    if (const auto set = set_option(options, *spec, text); !set)
      return refused(fmt::format("its setting {}: {}", key, set.error().message));
  }
  if (const auto why = option_conflict(options, nullptr, true))
    return refused(
        fmt::format("its settings cannot be combined: `{}`: {}", why->subject, why->message));
  return options;
}

std::expected<Image, Error> read_displayed(const std::filesystem::path& path) {
  auto picture = read_picture(path);
  if (!picture) return std::unexpected(std::move(picture.error()));
  if (lower_suffix(path) == ".exr")
    if (const auto settings = read_metadata(path))
      if (const auto o = options_from(*settings, false))  // not for other programs' pictures
        tone_map(picture->color, picture->alpha, o->tone.value_or(Tone::none), o->exposure);
  return std::move(picture->color);
}

std::string difference(const Metadata& a, const Metadata& b) {
  // Then values from the scene differ, too.
  if (setting(a, "scene_hash") != setting(b, "scene_hash")) return "the scene differs";
  std::string out;
  const auto add = [&](const std::string& what) { out += (out.empty() ? "" : "; ") + what; };
  if (const auto in_a = setting(a, "version"), in_b = setting(b, "version"); in_a != in_b)
    add(fmt::format("made by Raio {}, not {}", in_a, in_b));
  // A sky's location does not matter.
  const auto sky = setting(a, "sky_hash"), other_sky = setting(b, "sky_hash");
  if (!sky.empty() && !other_sky.empty() && sky != other_sky) add("the sky differs");
  for (const OptionSpec& spec : render_option_table()) {
    if (spec.name == "background" && !sky.empty() && !other_sky.empty()) continue;
    const std::string key = key_of(spec);
    const std::string_view in_a = setting(a, key), in_b = setting(b, key);
    const auto given = [&](std::string_view text) { return !text.empty() && text != "false"; };
    if (in_a == in_b || (!given(in_a) && !given(in_b))) continue;
    const std::string value = spec.is_switch() ? "" : " " + std::string(in_a);
    if (given(in_a))
      add(fmt::format("`{}`{}, not {}", spec.name, value, given(in_b) ? in_b : "without it"));
    else
      add(fmt::format("without `{}`, not {}", spec.name, spec.is_switch() ? "with it" : in_b));
  }
  return out;
}

}  // namespace raio::core
