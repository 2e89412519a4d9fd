// Film of the public interface: a part of a picture, or all of it, in memory and in files.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "draw/annotations.h"
#include "draw/marks.h"
#include "library/library.h"
#include "render/picture.h"
#include "render/provenance.h"
#include "render/render.h"

namespace raio::core::library {

std::unique_ptr<Film> copy_of(const Film& film) {
  auto copy = std::make_unique<Film>(film.width(), film.height(), film.bound(), film.tile_side(),
                                     film.layout().channels());
  parallel_for(film.tiles(), [&](size_t t) {
    if (const TileSamples tile = film.copy(t); !tile.samples.empty()) copy->add(t, tile);
  });
  return copy;
}

}  // namespace raio::core::library

namespace raio::inline v1 {

using namespace core;           // NOLINT(google-build-using-namespace)
using namespace core::library;  // NOLINT(google-build-using-namespace)

Film::Film(std::unique_ptr<Data> data) : data_(std::move(data)) {}
Film::Film(const Film& other) {
  guarded_work(other.data_->threads, [&] {
    const auto& [part, shards, threads, name, scale, annotations] = *other.data_;
    data_ = std::make_unique<Data>(
        Data{{part.header, copy_of(*part.film)}, shards, threads, name, scale, annotations});
  });
}
Film& Film::operator=(const Film& other) { return *this = Film(other); }
Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;
Film::~Film() = default;

namespace {

RenderOptions options_of(const Part& part) {
  auto options = options_from(part.header.settings, false);
  if (!options) fail(options.error());
  return *std::move(options);
}

// A part that was read or decoded.
std::unique_ptr<Film::Data> taken(std::expected<Part, core::Error> part, const std::string& name) {
  if (!part) fail(part.error());
  const uint32_t shards = part->header.shards;
  return std::make_unique<Film::Data>(Film::Data{std::move(*part), shards, 0, name});
}

Overlay overlay_of(const Annotations& wanted) {
  Marks marks{.bar_at_left = wanted.color_bar_at_left};
  if (const auto& bar = wanted.color_bar) {
    marks.color_bar = {bar->name, "", bar->least, bar->most};
    for (size_t i = 0; i < bar->colors.size(); i += 3)
      marks.color_bar->colors.emplace_back(bar->colors[i], bar->colors[i + 1], bar->colors[i + 2]);
  }
  for (const auto& [name, color] : wanted.legend) marks.legend.push_back({name, rgb(color)});
  if (const auto& bar = wanted.scale_bar) marks.scale_bar = {bar->pixels_per_unit, bar->unit};
  return [marks = std::move(marks)](Picture& picture, bool linear) {
    return draw_marks(picture, marks, linear);
  };
}

// The picture with what a file of this name can hold.
FinishedPicture picture_for(const Film::Data& film, const std::string& name) {
  auto finished = finished_picture(film.part, name, overlay_of(film.annotations));
  if (!finished) fail(finished.error());
  const auto format = image_format(name);
  if (format && *format != ImageFormat::exr && *format != ImageFormat::npz)
    finished->picture.layers.clear();
  return *std::move(finished);
}

}  // namespace

Film Film::read(const std::string& path) {
  return guarded_work(0, [&] { return Film(taken(read_part(path), path)); });
}

Film Film::from_bytes(std::string_view bytes) {
  return guarded_work(0, [&] { return Film(taken(decode_part(bytes), {})); });
}

std::string Film::to_bytes() const {
  return guarded_work(data_->threads,
                      [&] { return encode_part(data_->part.header, *data_->part.film); });
}

void Film::write(const std::string& path) const {
  guarded_work(data_->threads, [&] {
    const Part& part = data_->part;
    // A film that a time limit ended has samples_done in its settings, and may be written.
    if (!is_part_path(path) && setting(part.header.settings, "samples_done").empty())
      if (const std::string lacks = missing(); !lacks.empty())
        refuse(lacks + "; merge films that have them, continue the film, or write a part (.raio)");
    const auto write_finished = [&] {
      const FinishedPicture finished = picture_for(*data_, path);
      return write_image(finished.picture, path, finished.settings);
    };
    const auto done =
        is_part_path(path) ? write_part(path, part.header, *part.film) : write_finished();
    if (!done) fail(done.error());
  });
}

Film Film::merge(std::vector<Film> films) {
  if (films.empty()) refuse("there are no films to merge");
  return guarded_work(films.front().data_->threads, [&] {
    std::vector<NamedPart> parts;
    auto whole = std::make_unique<Data>();
    whole->threads = films.front().data_->threads;
    for (const Film& film : films) {
      Data& one = *film.data_;
      whole->shards = std::max(whole->shards, one.shards);
      parts.push_back({one.name.empty() ? fmt::format("film {}", parts.size() + 1) : one.name,
                       std::move(one.part)});
    }
    auto merged = merge_parts(parts);
    if (!merged) fail(merged.error());
    whole->part = std::move(*merged);
    return Film(std::move(whole));
  });
}

Film& Film::add(Film other) {
  guarded_work(data_->threads, [&] {
    const std::string& name = data_->name;
    NamedPart whole{name.empty() ? "this film" : name, std::move(data_->part)};
    const NamedPart more{other.data_->name.empty() ? "the other film" : other.data_->name,
                         std::move(other.data_->part)};
    const auto added = add_part(whole, more);
    data_->part = std::move(whole.part);
    if (!added) fail(added.error());
  });
  return *this;
}

bool Film::complete() const { return missing().empty(); }

std::string Film::missing() const { return missing_samples(data_->part, data_->shards); }

std::optional<std::vector<std::array<uint32_t, 2>>> Film::missing(uint32_t shard,
                                                                  uint32_t shards) const {
  if (shard >= shards) refuse(fmt::format("shard {} of {} does not exist", shard, shards));
  const auto missing = missing_samples(data_->part, shard, shards);
  if (!missing) return std::nullopt;
  std::vector<std::array<uint32_t, 2>> spans;
  for (const SampleSpan& s : missing->spans()) spans.push_back({s.first, s.end});
  return spans;
}

size_t Film::tiles() const { return data_->part.film->tiles(); }

std::array<uint32_t, 2> Film::samples() const {
  const SampleCounts counts = samples_of(data_->part);
  return {counts.fewest, counts.most};
}

Settings Film::settings() const {
  return guarded([&] {
    const PartHeader& header = data_->part.header;
    auto options = options_from(header.settings);
    if (!options) fail(options.error());
    Settings settings;
    Settings::Data& all = *settings.data_;
    all.options = *std::move(options);
    auto read = read_options_from(header.settings);
    if (!read) fail(read.error());
    all.read = *std::move(read);
    all.shard = header.shard, all.shards = header.shards, all.sample_range = header.samples;
    return settings;
  });
}

Film& Film::set(std::string_view name, std::string_view value) {
  guarded([&] {
    if (name != "exposure" && name != "tone")
      refuse(fmt::format(
          "a rendered film cannot change {}, only exposure and tone; render again to change "
          "others",
          name));
    const auto table = render_option_table();
    const OptionSpec& spec = *std::ranges::find(table, name, &OptionSpec::name);
    RenderOptions options = options_of(data_->part);
    if (const auto done = set_option(options, spec, value); !done) fail(done.error());
    if (const auto why = option_conflict(options)) fail(*why);
    set_setting(data_->part.header.settings, spec, options);
  });
  return *this;
}

Film& Film::set(std::string_view name, double value) { return set(name, fmt::format("{}", value)); }

double Film::pixels_per_unit() const { return data_->pixels_per_unit; }

Film& Film::annotate(Annotations wanted) {
  guarded([&] {
    if (const std::string why = drawing_problem(); !why.empty())
      throw Error(ErrorKind::no_resource, why);
    const RenderOptions options = options_of(data_->part);
    if ((wanted.color_bar || !wanted.legend.empty()) && options.view != View::picture)
      refuse("a view has its own colours, so no colour bar and no legend");
    if (!wanted.legend.empty() && !has_room_for_legend(width(), height(), options.dpi))
      refuse(
          fmt::format("a picture of {}x{} pixels has no room for a legend; make it larger, or dpi "
                      "smaller",
                      width(), height()));
    if (wanted.color_bar && wanted.color_bar->colors.size() != size_t(3) * kMapColors)
      refuse(fmt::format("a colour scale has {} colours of three numbers each; found {} numbers",
                         kMapColors, wanted.color_bar->colors.size()));
    if (wanted.scale_bar && !(wanted.scale_bar->pixels_per_unit > 0))
      refuse("the film was read or merged, so the size of a scene unit in it is unknown");
    data_->annotations = std::move(wanted);
  });
  return *this;
}

const Annotations& Film::annotations() const { return data_->annotations; }

int Film::width() const { return data_->part.film->width(); }
int Film::height() const { return data_->part.film->height(); }

std::vector<float> Film::rgba() const {
  return guarded_work(data_->threads, [&] {
    const auto finished = finished_picture(data_->part, "picture.npy");
    if (!finished) fail(finished.error());
    const auto& [image, alpha, layers, dpi] = finished->picture;
    std::vector<float> out;
    out.reserve(4 * image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) {
      const Rgb& c = image.pixels[i];
      out.insert(out.end(), {c.x, c.y, c.z, alpha.empty() ? 1.0f : alpha[i]});
    }
    return out;
  });
}

std::vector<uint8_t> Film::display() const {
  return guarded_work(data_->threads, [&] {
    const auto finished =
        finished_picture(data_->part, "picture.png", overlay_of(data_->annotations));
    if (!finished) fail(finished.error());
    const auto& [color, alpha, layers, dpi] = finished->picture;
    std::vector<uint8_t> out(4 * color.pixels.size());
    for_each_index(color.pixels.size(), [&](size_t i) {
      const float covered = alpha.empty() ? 1 : alpha[i];
      const Rgb c = covered > 0 ? color.pixels[i] / covered : Rgb();
      for (int k = 0; k < 3; ++k) out[4 * i + size_t(k)] = to_byte(c[k]);
      out[4 * i + 3] = to_byte(covered);
    });
    return out;
  });
}

std::string drawing_problem() {
  const auto can = check_drawing();
  return can ? "" : can.error();
}

std::string Film::encode(std::string_view format) const {
  return guarded_work(data_->threads, [&] {
    const std::string name = "picture" + std::string(format);
    const FinishedPicture finished = picture_for(*data_, name);
    auto bytes = encode_image(finished.picture, name, finished.settings);
    if (!bytes) fail(bytes.error());
    return *std::move(bytes);
  });
}

std::vector<std::string> Film::channels() const {
  return guarded([&] {
    const ChannelSet channels = options_of(data_->part).channels;
    std::vector<std::string> names;
    for (const ChannelSpec& spec : kChannels)
      if (channels.has(spec.channel)) names.emplace_back(spec.name);
    return names;
  });
}

namespace {

// The error names the available channels.
const ChannelSpec& channel_of(const Film& film, std::string_view name) {
  const std::vector<std::string> all = film.channels();
  const auto spec = std::ranges::find(kChannels, name, &ChannelSpec::name);
  if (spec == kChannels.end() || std::ranges::find(all, name) == all.end())
    refuse(fmt::format("the film has no channel '{}'; it has {}", name,
                       all.empty() ? "none" : fmt::format("{}", fmt::join(all, ", "))));
  return *spec;
}

}  // namespace

std::vector<float> Film::channel(std::string_view name, int* components) const {
  return guarded_work(data_->threads, [&] {
    const ChannelSpec& spec = channel_of(*this, name);
    if (spec.integer)
      refuse(fmt::format("channel '{}' has integers; read it with integers()", name));
    if (components) *components = int(spec.components.size());
    const auto values = std::get<core::Column<float>>(data_->part.film->resolve(spec.channel));
    return std::vector<float>(values.begin(), values.end());
  });
}

std::vector<uint32_t> Film::integers(std::string_view name) const {
  return guarded_work(data_->threads, [&] {
    const ChannelSpec& spec = channel_of(*this, name);
    if (!spec.integer) refuse(fmt::format("channel '{}' has floats; read it with channel()", name));
    const auto values = std::get<core::Column<uint32_t>>(data_->part.film->resolve(spec.channel));
    return std::vector<uint32_t>(values.begin(), values.end());
  });
}

uint64_t Film::nan_samples() const { return data_->part.film->faults().nans.count; }

}  // namespace raio::inline v1
